#pragma once
// One nappe of a circular cone; the coordinates are the angle about the axis and the length along
// the generators.

#include <algorithm>

#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = s (sin theta cos alpha, sin theta sin alpha, cos theta) about the apex, s >= 0.
class Cone {
 public:
  Cone() = default;
  Cone(const Frame& frame, double angle)
      : frame_(frame), sin_(std::sin(angle)), cos_(std::cos(angle)) {}

  static Descriptor describe() {
    return {"cone",
            "Circular cone from its apex on; xi are the angle about the axis and the length from "
            "the apex along the generators.",
            {{"apex", Kind::vector, "length", "apex"},
             axis_parameter("direction in which the cone opens"),
             {"angle", Kind::scalar, "angle",
              "between axis and generators, less than a right angle", Bound::positive},
             start_parameter(),
             inside_parameter()}};
  }
  static Cone make(const Values& v) {
    if (!(v.scalar("angle") < 0.5 * pi))
      throw std::invalid_argument("angle must be less than a right angle");
    return {placed(v, "apex"), v.scalar("angle")};
  }

  Domain domain() const { return {{-pi, 0.0}, {pi, Domain::infinity}, {true, false}}; }

  template <class S>
  Jet<S> jet(const S& alpha, const S& s) const {
    using std::cos, std::sin;
    const S c = sin_ * cos(alpha), t = sin_ * sin(alpha), zero(0.0);
    const Vec3<S> generator = frame_.rotate(Vec3<S>(c, t, S(cos_)));
    const Vec3<S> around = frame_.rotate(Vec3<S>(-t, c, zero));
    const Vec3<S> outward = frame_.rotate(Vec3<S>(c, t, zero));
    return {constant<S>(frame_.origin()) + s * generator,
            {s * around, generator},
            {-s * outward, around, constant<S>(Vec3<double>::Zero())}};
  }

  /// Closest point in closed form: on the generator on the side of x, or the apex, which counts as
  /// an edge of no length.
  Foot closest(const Vec3<double>& x) const {
    const Polar p(frame_, x);
    const double s = p.radius * sin_ + p.height * cos_;
    const double cap = std::max(
        {polar_cap * std::sqrt(p.radius * p.radius + p.height * p.height), p.unresolved, least});
    if (s > cap) {
      const bool on_axis = p.vanishes(p.radius, s * sin_);
      return {{p.angle, s}, on_axis ? Status::ambiguous : Status::interior};
    }
    return {{p.angle, cap}, Status::singular, {p.radius <= p.unresolved, true}};
  }

 private:
  /// Length from an apex at the origin to itself; its square is still a number.
  static constexpr double least = 1e-150;
  Frame frame_;
  double sin_{std::numbers::sqrt2 / 2}, cos_{std::numbers::sqrt2 / 2};
};

}  // namespace anisocontact::surface
