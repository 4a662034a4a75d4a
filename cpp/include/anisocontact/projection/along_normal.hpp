#pragma once
// Where a line meets a patch of a surface: P (x - rho(xi)) = 0, P = I - n n, by Newton's method.

#include <algorithm>
#include <array>
#include <cmath>

#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::projection {

/// Coordinates where a line meets a patch, and whether it meets it at all.
struct Meeting {
  std::array<double, 2> xi;
  bool met;
};

/// Follows the line through x along the unit vector n from coordinates on; `jet` is the patch there. A
/// line that runs almost along it, by less than `opposed` of its area, does not meet it.
template <class Jet>
Meeting along_normal(const Jet& jet, std::array<double, 2> xi, const Vec3<double>& x,
                     const Vec3<double>& n, double opposed) noexcept {
  constexpr int iterations = 12;
  constexpr double enough = 1e-14, farthest = 1e10;
  const auto across = [&](const Vec3<double>& v) -> Vec3<double> { return v - v.dot(n) * n; };
  for (int it = 0; it < iterations; ++it) {
    const surface::Jet<double> j = jet(xi);
    const Vec3<double> first = across(j.d1[0]), second = across(j.d1[1]),
                       rest = across(x - j.position);
    const double a = first.squaredNorm(), b = first.dot(second), c = second.squaredNorm();
    if (!(a * c - b * b > opposed * opposed * j.d1[0].cross(j.d1[1]).squaredNorm()))
      return {xi, false};
    const double p = a - j.d2[0].dot(rest), q = b - j.d2[1].dot(rest), r = c - j.d2[2].dot(rest),
                 u = first.dot(rest), v = second.dot(rest), size = p * r - q * q;
    const std::array<double, 2> step{(r * u - q * v) / size, (p * v - q * u) / size};
    const double most = std::max(std::abs(step[0]), std::abs(step[1]));
    if (!(most < farthest)) return {xi, false};
    for (std::size_t i = 0; i < 2; ++i) xi[i] += step[i];
    if (most <= enough) break;
  }
  return {xi, true};
}

}  // namespace anisocontact::projection
