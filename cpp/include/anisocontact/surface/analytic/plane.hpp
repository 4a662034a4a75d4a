#pragma once
// Plane through a point; the coordinates are lengths along two orthonormal tangents.

#include "anisocontact/surface/foot.hpp"
#include "anisocontact/surface/frame.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = p + xi^1 t_1 + xi^2 t_2 with t_1 x t_2 = n.
class Plane {
 public:
  Plane() = default;
  explicit Plane(const Frame& frame) : frame_(frame) {}

  static Descriptor describe() {
    return {"plane",
            "Plane through a point; xi are lengths along two orthonormal tangents.",
            {{"point", Kind::vector, "length", "a point of the plane"},
             {"normal", Kind::vector, "1", "outward normal of the master", Bound::nonzero},
             {"tangent",
              Kind::vector,
              "1",
              "direction of the first coordinate, projected on the plane; any tangent if left out",
              Bound::any,
              false,
              {0.0, 0.0, 0.0}}}};
  }
  static Plane make(const Values& v) {
    return Plane(Frame::from(v.vector("point"), v.vector("normal"), v.vector("tangent"), "normal",
                             "tangent"));
  }

  Domain domain() const { return {}; }

  template <class S>
  Jet<S> jet(const S& u, const S& v) const {
    const Vec3<S> zero = constant<S>(Vec3<double>::Zero());
    return {frame_.to_global(Vec3<S>(u, v, S(0.0))),
            {constant<S>(frame_.axis(0)), constant<S>(frame_.axis(1))},
            {zero, zero, zero}};
  }

  /// Closest point in closed form.
  Foot closest(const Vec3<double>& x) const {
    const Vec3<double> y = frame_.to_local(x);
    return {{y[0], y[1]}, Status::interior};
  }

 private:
  Frame frame_;
};

}  // namespace anisocontact::surface
