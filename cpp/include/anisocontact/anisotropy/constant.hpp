#pragma once
// Constant direction with an angle: the spectral representation.

#include "anisocontact/anisotropy/turned_line.hpp"

namespace anisocontact::anisotropy {

/// First axis: `vector` projected on the tangent plane, turned by `angle` about the normal
/// [Konyukhov Schweizerhof 2006, eq. (42), (43)].
class Constant {
 public:
  Constant() = default;
  Constant(const Vec3<double>& vector, double angle) : vector_(vector), turn_(angle) {}

  static Descriptor describe() {
    return {"constant",
            "One direction in space, projected on the surface and turned about its normal.",
            {{"vector", Kind::vector, "1", "direction of the first axis before it is turned",
              Bound::nonzero},
             Turn::parameter()}};
  }
  static Constant make(const Values& v) {
    const auto& d = v.vector("vector");
    return {Vec3<double>(d[0], d[1], d[2]), v.scalar("angle")};
  }

  template <class S>
  TurnedLine<S> line(const Vec3<S>&) const {
    return {constant<S>(vector_), {turn_, turn_.and_quarter()}};
  }
  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    return axes_along(g, line(g.jet.position));
  }

 private:
  Vec3<double> vector_{Vec3<double>::UnitX()};
  Turn turn_;
};

static_assert(Field<Constant>);

}  // namespace anisocontact::anisotropy
