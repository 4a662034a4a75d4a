#pragma once
// Exact derivatives of the coordinates and the gap of a projected point with respect to the point.

#include <array>
#include <cmath>

#include "anisocontact/surface/foot.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::projection {

/// The larger eigenvalue of M = delta^i_j - xi^3 h^i_j, by magnitude.
inline double larger_eigenvalue(const ContraCo<double>& m) noexcept {
  const double half = 0.5 * trace(m);
  return std::abs(half) + std::sqrt(std::max(half * half - det(m), 0.0));
}

/// Whether x is a centre of curvature, as far as numbers tell.
inline bool is_focal(const ContraCo<double>& m) noexcept {
  return !(std::abs(det(m)) > surface::focal_limit * larger_eigenvalue(m));
}

/// Inverse of M = delta^i_j - xi^3 h^i_j. At a centre of curvature, where an eigenvalue vanishes,
/// the inverse on the other direction alone: M / lambda^2, since then M = lambda P.
inline ContraCo<double> guarded_inverse(const ContraCo<double>& m) noexcept {
  if (!is_focal(m)) return inverse(m);
  const double larger = larger_eigenvalue(m);
  if (larger > surface::focal_limit) return (1.0 / (larger * larger)) * m;
  return {};
}

/// d xi^i/dx at a foot, the implicit derivative of (x - rho(xi)) . rho_j = 0.
/// Free foot: (a_ij - xi^3 h_ij)^-1 rho_j. On an edge x - rho is not normal to the surface, and the
/// one free coordinate has rho_k / (a_kk - (x - rho) . rho_kk). In a corner: zero.
inline std::array<Vec3<double>, 2> coordinate_gradient(const surface::Geometry<double>& g,
                                                       const surface::Foot& foot,
                                                       const Vec3<double>& x) noexcept {
  std::array<Vec3<double>, 2> dxi{Vec3<double>::Zero(), Vec3<double>::Zero()};
  const Vec3<double> r = x - g.jet.position;
  if (!foot.fixed[0] && !foot.fixed[1]) {
    const double gap = r.dot(g.normal);
    const auto inv = guarded_inverse(unit<double, Place::contra>() - gap * g.h_mixed);
    const Vec3<double> dual[] = {g.dual_basis(0), g.dual_basis(1)};
    for (std::size_t i = 0; i < 2; ++i) dxi[i] = inv(i, 0) * dual[0] + inv(i, 1) * dual[1];
    return dxi;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    if (foot.fixed[k]) continue;
    const double a = g.a_co(k, k), slope = a - r.dot(g.jet.second(k, k));
    if (std::abs(slope) > surface::focal_limit * a) dxi[k] = g.jet.d1[k] / slope;
  }
  return dxi;
}

/// d xi^3/dx: the normal where x - rho is normal to the surface; else also the turn of the normal,
/// n_i = -h^j_i rho_j.
inline Vec3<double> gap_gradient(const surface::Geometry<double>& g, const surface::Foot& foot,
                                 const Vec3<double>& x,
                                 const std::array<Vec3<double>, 2>& dxi) noexcept {
  if (!foot.fixed[0] && !foot.fixed[1]) return g.normal;
  const Covector<double> r = g.project_co(x - g.jet.position);
  Vec3<double> d = g.normal;
  for (std::size_t i = 0; i < 2; ++i)
    d -= (g.h_mixed(0, i) * r[0] + g.h_mixed(1, i) * r[1]) * dxi[i];
  return d;
}

}  // namespace anisocontact::projection
