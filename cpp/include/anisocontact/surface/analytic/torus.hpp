#pragma once
// Ring torus; the coordinates are the angle about the axis and the angle about the tube.

#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = ((R + r cos beta) cos alpha, (R + r cos beta) sin alpha, r sin beta).
class Torus {
 public:
  Torus() = default;
  Torus(const Frame& frame, double radius, double tube)
      : frame_(frame), radius_(radius), tube_(tube) {}

  static Descriptor describe() {
    return {"torus",
            "Ring torus; xi are the angle about the axis and the angle about the tube.",
            {{"centre", Kind::vector, "length", "centre"},
             axis_parameter("direction of the axis"),
             {"radius", Kind::scalar, "length", "radius of the centre line of the tube",
              Bound::positive},
             {"tube", Kind::scalar, "length",
              "radius of the tube, less than that of its centre line", Bound::positive},
             start_parameter(),
             inside_parameter()}};
  }
  static Torus make(const Values& v) {
    if (!(v.scalar("tube") < v.scalar("radius")))
      throw std::invalid_argument("tube must be less than radius, or the surface meets itself");
    return {placed(v, "centre"), v.scalar("radius"), v.scalar("tube")};
  }

  Domain domain() const { return {{-pi, -pi}, {pi, pi}, {true, true}}; }

  template <class S>
  Jet<S> jet(const S& alpha, const S& beta) const {
    using std::cos, std::sin;
    const S ca = cos(alpha), sa = sin(alpha);
    const S cb = tube_ * cos(beta), sb = tube_ * sin(beta), ring = radius_ + cb, zero(0.0);
    const auto meridian = [&](const S& out, const S& up) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(out * ca, out * sa, up));
    };
    const auto parallel = [&](const S& along) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(-along * sa, along * ca, zero));
    };
    return {constant<S>(frame_.origin()) + meridian(ring, sb),
            {parallel(ring), meridian(-sb, cb)},
            {meridian(-ring, zero), parallel(-sb), meridian(-cb, -sb)}};
  }

  /// Closest point in closed form: that of the nearest circle of the tube. On the axis and on the
  /// centre line of the tube the angle that is free is zero.
  Foot closest(const Vec3<double>& x) const {
    const Polar p(frame_, x);
    const double out = p.radius - radius_;
    const double distance = std::sqrt(out * out + p.height * p.height);
    const double beta = distance <= p.unresolved ? 0.0 : std::atan2(p.height, out);
    const bool unique = !p.vanishes(p.radius, radius_) && !p.vanishes(distance, tube_);
    return {{p.angle, beta}, unique ? Status::interior : Status::ambiguous};
  }

 private:
  Frame frame_;
  double radius_{1.0}, tube_{0.5};
};

}  // namespace anisocontact::surface
