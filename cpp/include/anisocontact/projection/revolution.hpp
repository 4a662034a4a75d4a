#pragma once
// Closest point of a surface of revolution: that of its profile in the half plane of the point.

#include "anisocontact/projection/nurbs.hpp"
#include "anisocontact/surface/analytic/revolution.hpp"

namespace anisocontact::projection {

inline surface::Foot closest_point(const surface::Revolution& s, const Vec3<double>& x,
                                   const std::array<double, 2>* guess) noexcept {
  const surface::Polar p(s.frame(), x);
  const Vec3<double> in_plane(p.radius, 0.0, p.height);
  const std::array<double, 2> near{guess ? (*guess)[1] : 0.0, s.middle};
  return s.foot(p, NurbsSearch(s.strip(), in_plane).run(guess ? &near : nullptr));
}

}  // namespace anisocontact::projection
