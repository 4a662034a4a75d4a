#pragma once
// Rates of the coordinates and the gap of a moving slave point on a moving master.

#include "anisocontact/projection/linearisation.hpp"

namespace anisocontact::projection {

struct ConvectiveVelocity {
  Vector<double> xi;
  double gap;
};

/// Rates at xi^3 = 0 of a relative velocity v_s - v; with a small relative displacement in its
/// place, the variation [Konyukhov Schweizerhof 2006, eq. (4), (5), (6)].
inline ConvectiveVelocity convective_velocity(const surface::Geometry<double>& g,
                                              const Vec3<double>& relative) noexcept {
  return {g.project_contra(relative), relative.dot(g.normal)};
}

/// Rates at any xi^3. The time derivative of r_s = rho + n xi^3 on rho_j, with the derivatives v_j
/// of the master's velocity along the coordinates in (dn/dt) . rho_j = -n . v_j:
/// (a_ij - xi^3 h_ij) dxi^i/dt = (v_s - v) . rho_j + xi^3 n . v_j.
inline ConvectiveVelocity convective_velocity(const surface::Geometry<double>& g, double gap,
                                              const Vec3<double>& relative,
                                              const std::array<Vec3<double>, 2>& v_j) noexcept {
  const Covector<double> turn{{gap * g.normal.dot(v_j[0]), gap * g.normal.dot(v_j[1])}};
  const auto inv = guarded_inverse(unit<double, Place::contra>() - gap * g.h_mixed);
  return {inv * (g.a_contra * (g.project_co(relative) + turn)), relative.dot(g.normal)};
}

}  // namespace anisocontact::projection
