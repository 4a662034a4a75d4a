#pragma once
// 2 x 2 matrices of components along the axes of a direction field.

#include <algorithm>
#include <array>
#include <cmath>

namespace anisocontact::law {

/// Components along the axes e_a of the adhesion directions: T = t_a e_a, slip read as e_a . xi.
using AxesMatrix = std::array<std::array<double, 2>, 2>;

inline AxesMatrix diagonal(double a, double b) { return {{{a, 0.0}, {0.0, b}}}; }

namespace detail {

using Pair = std::array<double, 2>;

inline Pair apply(const AxesMatrix& m, const Pair& u) {
  return {m[0][0] * u[0] + m[0][1] * u[1], m[1][0] * u[0] + m[1][1] * u[1]};
}
inline double inner(const Pair& u, const Pair& v) { return u[0] * v[0] + u[1] * v[1]; }

inline AxesMatrix product(const AxesMatrix& m, const AxesMatrix& n) {
  AxesMatrix r{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) r[i][j] = m[i][0] * n[0][j] + m[i][1] * n[1][j];
  return r;
}

/// s m + t n.
inline AxesMatrix combined(double s, const AxesMatrix& m, double t, const AxesMatrix& n) {
  AxesMatrix r{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) r[i][j] = s * m[i][j] + t * n[i][j];
  return r;
}

inline double largest(const AxesMatrix& m) {
  return std::max({std::abs(m[0][0]), std::abs(m[0][1]), std::abs(m[1][0]), std::abs(m[1][1])});
}

/// det m; zero where it is no more than the rounding of its two products.
inline double determinant(const AxesMatrix& m) {
  constexpr double rounding = 1e-12;
  const double p = m[0][0] * m[1][1], q = m[0][1] * m[1][0];
  return std::abs(p - q) > rounding * (std::abs(p) + std::abs(q)) ? p - q : 0.0;
}

/// m^-1 u; of a singular m its pseudo-inverse, m^T/(m : m), as a zero stiffness stores nothing.
inline Pair solve(const AxesMatrix& m, const Pair& u) {
  if (const double d = determinant(m); d != 0.0)
    return {(m[1][1] * u[0] - m[0][1] * u[1]) / d, (m[0][0] * u[1] - m[1][0] * u[0]) / d};
  const double square = inner(m[0], m[0]) + inner(m[1], m[1]);
  if (square == 0.0) return {0.0, 0.0};
  return {(m[0][0] * u[0] + m[1][0] * u[1]) / square, (m[0][1] * u[0] + m[1][1] * u[1]) / square};
}

/// Smallest eigenvalue of the symmetric part.
inline double least_eigenvalue(const AxesMatrix& m) {
  return 0.5 * (m[0][0] + m[1][1] - std::hypot(m[0][0] - m[1][1], m[0][1] + m[1][0]));
}

/// Smallest real part of the eigenvalues.
inline double least_real_part(const AxesMatrix& m) {
  const double half = 0.5 * (m[0][0] - m[1][1]);
  return 0.5 * (m[0][0] + m[1][1]) - std::sqrt(std::max(half * half + m[0][1] * m[1][0], 0.0));
}

}  // namespace detail
}  // namespace anisocontact::law
