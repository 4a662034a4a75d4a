#pragma once
// Ellipsoid; the coordinates are the angles of the sphere it is the affine image of.

#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = (a cos beta cos alpha, b cos beta sin alpha, c sin beta), poles at beta = +-pi/2.
class Ellipsoid {
 public:
  Ellipsoid() = default;
  Ellipsoid(const Frame& frame, const Vec3<double>& semi_axes)
      : frame_(frame), semi_axes_(semi_axes) {}

  static Descriptor describe() {
    return {"ellipsoid",
            "Ellipsoid; xi are longitude and latitude of the sphere it is the affine image of.",
            {{"centre", Kind::vector, "length", "centre"},
             {"semi_axes", Kind::vector, "length",
              "semi-axes along start, across both, and along axis", Bound::positive},
             pole_parameter(),
             start_parameter(),
             inside_parameter()}};
  }
  static Ellipsoid make(const Values& v) {
    const auto& e = v.vector("semi_axes");
    return {placed(v, "centre"), {e[0], e[1], e[2]}};
  }

  Domain domain() const { return {{-pi, -0.5 * pi}, {pi, 0.5 * pi}, {true, false}}; }

  template <class S>
  Jet<S> jet(const S& alpha, const S& beta) const {
    using std::cos, std::sin;
    const S ca = cos(alpha), sa = sin(alpha), cb = cos(beta), sb = sin(beta), zero(0.0);
    const auto scaled = [&](const S& x, const S& y, const S& z) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(semi_axes_[0] * x, semi_axes_[1] * y, semi_axes_[2] * z));
    };
    const Vec3<S> outward = scaled(ca * cb, sa * cb, sb);
    return {constant<S>(frame_.origin()) + outward,
            {scaled(-sa * cb, ca * cb, zero), scaled(-ca * sb, -sa * sb, cb)},
            {scaled(-ca * cb, -sa * cb, zero), scaled(sa * sb, -ca * sb, zero), -outward}};
  }

  const Frame& frame() const { return frame_; }
  const Vec3<double>& semi_axes() const { return semi_axes_; }

 private:
  Frame frame_;
  Vec3<double> semi_axes_{Vec3<double>::Ones()};
};

}  // namespace anisocontact::surface
