#pragma once
// The smallest value of a quadratic function over the reference square or triangle.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anisocontact/surface/facet_shapes.hpp"

namespace anisocontact::projection {

/// g_i d^i + 1/2 H_ij d^i d^j with d counted from the point `at`.
struct Quadratic {
  std::array<double, 2> at;
  std::array<double, 2> g;
  double h11, h12, h22;

  double operator()(const std::array<double, 2>& s) const {
    const double a = s[0] - at[0], b = s[1] - at[1];
    return a * (g[0] + 0.5 * h11 * a + h12 * b) + b * (g[1] + 0.5 * h22 * b);
  }
  bool positive() const { return h11 > 0.0 && h11 * h22 - h12 * h12 > singular * h11 * h22; }

  /// With |H| in place of H, by the theorem of Cayley and Hamilton on H^2, and a floor under its
  /// eigenvalues.
  Quadratic definite() const {
    const double m11 = h11 * h11 + h12 * h12, m12 = h12 * (h11 + h22), m22 = h22 * h22 + h12 * h12;
    const double root = std::abs(h11 * h22 - h12 * h12), scale = std::sqrt(m11 + m22 + 2.0 * root);
    if (!(scale > 0.0)) return {at, g, 1.0, 0.0, 1.0};
    const double floor = least_eigenvalue * scale;
    return {at, g, (m11 + root) / scale + floor, m12 / scale, (m22 + root) / scale + floor};
  }

 private:
  static constexpr double least_eigenvalue = 1e-6;
  /// Relative determinant at which a Hessian counts as singular: rounding.
  static constexpr double singular = 1e-14;
};

/// How far a point is outside a side (positive: outside).
inline double outside(bool triangular, std::size_t side, const std::array<double, 2>& s) {
  if (triangular) return side == 0 ? s[0] + s[1] - 1.0 : -s[side - 1];
  constexpr std::array<std::size_t, 4> which{1, 0, 0, 1};
  return side < 2 ? -s[which[side]] : s[which[side]] - 1.0;
}

/// Smallest value on a side.
inline std::array<double, 2> minimum_on_side(const Quadratic& q, bool triangular,
                                             std::size_t side) {
  const auto reference = triangular ? surface::Topology::tri3 : surface::Topology::quad4;
  const auto [first, second] = surface::side_vertices(reference, side);
  const auto a = surface::vertex_coordinates(first), b = surface::vertex_coordinates(second);
  const std::array<double, 2> e{b[0] - a[0], b[1] - a[1]};
  const double d0 = a[0] - q.at[0], d1 = a[1] - q.at[1];
  const double slope =
      e[0] * (q.g[0] + q.h11 * d0 + q.h12 * d1) + e[1] * (q.g[1] + q.h12 * d0 + q.h22 * d1);
  const double curvature = e[0] * (q.h11 * e[0] + 2.0 * q.h12 * e[1]) + e[1] * q.h22 * e[1];
  const double t = curvature > 0.0 ? std::clamp(-slope / curvature, 0.0, 1.0)
                                   : (slope + 0.5 * curvature < 0.0 ? 1.0 : 0.0);
  return {a[0] + t * e[0], a[1] + t * e[1]};
}

/// Minimum over the reference triangle or square. Where the unconstrained minimum is outside, the
/// minimum lies on a side that it violates.
inline std::array<double, 2> minimum(const Quadratic& q, bool triangular) noexcept {
  const std::size_t sides = triangular ? 3 : 4;
  const bool regular = q.positive();
  std::array<double, 2> s{};
  if (regular) {
    const double inv = 1.0 / (q.h11 * q.h22 - q.h12 * q.h12);
    s = {q.at[0] + inv * (q.h12 * q.g[1] - q.h22 * q.g[0]),
         q.at[1] + inv * (q.h12 * q.g[0] - q.h11 * q.g[1])};
  }
  std::array<double, 2> best = s;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t side = 0; side < sides; ++side) {
    if (regular && outside(triangular, side, s) <= 0.0) continue;
    const auto c = minimum_on_side(q, triangular, side);
    if (const double f = q(c); f < least) {
      least = f;
      best = c;
    }
  }
  return best;
}

}  // namespace anisocontact::projection
