#pragma once
// Circular cylinder without ends; the coordinates are the angle about the axis and the length
// along it.

#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = (R cos alpha, R sin alpha, z) in the frame of the axis
/// [Konyukhov Schweizerhof 2006, eq. (64)].
class Cylinder {
 public:
  Cylinder() = default;
  Cylinder(const Frame& frame, double radius) : frame_(frame), radius_(radius) {}

  static Descriptor describe() {
    return {
        "cylinder",
        "Circular cylinder without ends; xi are the angle about the axis and the length along it.",
        {{"point", Kind::vector, "length", "a point of the axis, where the length is zero"},
         axis_parameter("direction of the axis"),
         {"radius", Kind::scalar, "length", "radius", Bound::positive},
         start_parameter(),
         inside_parameter()}};
  }
  static Cylinder make(const Values& v) { return {placed(v, "point"), v.scalar("radius")}; }

  Domain domain() const {
    return {{-pi, -Domain::infinity}, {pi, Domain::infinity}, {true, false}};
  }

  template <class S>
  Jet<S> jet(const S& alpha, const S& z) const {
    using std::cos, std::sin;
    const Vec3<S> zero = constant<S>(Vec3<double>::Zero());
    const S c = radius_ * cos(alpha), s = radius_ * sin(alpha);
    const Vec3<S> outward = frame_.rotate(Vec3<S>(c, s, S(0.0)));
    const Vec3<S> axial = constant<S>(frame_.axis(2));
    return {constant<S>(frame_.origin()) + outward + z * axial,
            {frame_.rotate(Vec3<S>(-s, c, S(0.0))), axial},
            {-outward, zero, zero}};
  }

  /// Closest point in closed form; on the axis the one where the angle is zero.
  Foot closest(const Vec3<double>& x) const {
    const Polar p(frame_, x);
    const bool on_axis = p.vanishes(p.radius, radius_);
    return {{p.angle, p.height}, on_axis ? Status::ambiguous : Status::interior};
  }

 private:
  Frame frame_;
  double radius_{1.0};
};

}  // namespace anisocontact::surface
