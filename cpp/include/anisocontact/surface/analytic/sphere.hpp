#pragma once
// Sphere; the coordinates are longitude and latitude.

#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = R (cos beta cos alpha, cos beta sin alpha, sin beta), poles at beta = +-pi/2.
class Sphere {
 public:
  Sphere() = default;
  Sphere(const Frame& frame, double radius) : frame_(frame), radius_(radius) {}

  static Descriptor describe() {
    return {"sphere",
            "Sphere; xi are longitude and latitude.",
            {{"centre", Kind::vector, "length", "centre"},
             {"radius", Kind::scalar, "length", "radius", Bound::positive},
             pole_parameter(),
             start_parameter(),
             inside_parameter()}};
  }
  static Sphere make(const Values& v) { return {placed(v, "centre"), v.scalar("radius")}; }

  Domain domain() const { return {{-pi, -0.5 * pi}, {pi, 0.5 * pi}, {true, false}}; }

  template <class S>
  Jet<S> jet(const S& alpha, const S& beta) const {
    using std::cos, std::sin;
    const S ca = cos(alpha), sa = sin(alpha);
    const S cb = radius_ * cos(beta), sb = radius_ * sin(beta);
    const S zero(0.0);
    const auto meridian = [&](const S& out, const S& up) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(out * ca, out * sa, up));
    };
    const auto parallel = [&](const S& along) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(-along * sa, along * ca, zero));
    };
    const Vec3<S> outward = meridian(cb, sb);
    return {constant<S>(frame_.origin()) + outward,
            {parallel(cb), meridian(-sb, cb)},
            {meridian(-cb, zero), parallel(-sb), -outward}};
  }

  /// Closest point in closed form; at the centre the one where both angles are zero.
  Foot closest(const Vec3<double>& x) const {
    const Polar p(frame_, x);
    const double distance = std::sqrt(p.radius * p.radius + p.height * p.height);
    if (distance <= p.unresolved) return {{0.0, 0.0}, Status::ambiguous};
    Foot foot = polar_foot(p.angle, std::atan2(p.height, p.radius));
    if (p.vanishes(distance, radius_)) foot.status = Status::ambiguous;
    return foot;
  }

 private:
  Frame frame_;
  double radius_{1.0};
};

}  // namespace anisocontact::surface
