#pragma once
// The least distance of a point to a part of a facet or of a patch by safeguarded Newton steps.

#include <cmath>
#include <limits>

#include "anisocontact/projection/local.hpp"

namespace anisocontact::projection {

/// Where the next step goes: the minimum of the model over the part. Where the model has none, its
/// Hessian H is replaced by |H|; along a side on which the step stays, H itself is good enough.
inline std::array<double, 2> step_target(const Quadratic& q, bool triangle, bool& exact) noexcept {
  exact = q.positive();
  if (exact) return minimum(q, triangle);
  auto target = minimum(q.definite(), triangle);
  for (std::size_t side = 0; side < (triangle ? 3U : 4U); ++side) {
    if (outside(triangle, side, q.at) != 0.0 || outside(triangle, side, target) != 0.0) continue;
    target = minimum_on_side(q, triangle, side);
    exact = true;
    break;
  }
  return target;
}

struct Minimum {
  std::array<double, 2> s{};
  double f{0.0};
  bool converged{false};
};

/// Minimum of f over a part of a facet, a square or a triangle: each step goes to the minimum of the
/// model over the part, or back from there until f falls.
template <class Facet>
Minimum minimise(const Facet& facet, const Part& part, std::array<double, 2> s) noexcept {
  constexpr int most_steps = 60, most_halvings = 30;
  constexpr double quadratic_end = 1e-9, linear_end = 1e-13, loose_end = 1e-6, rounding = 1e-12;
  const bool triangle = facet.triangular();
  Local l = facet.at(part.at(s));
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < most_steps; ++step) {
    bool exact = false;
    const Quadratic q = l.model(part, s);
    const auto target = step_target(q, triangle, exact);
    const std::array<double, 2> d{target[0] - s[0], target[1] - s[1]};
    const double size = std::max(std::abs(d[0]), std::abs(d[1]));
    const double slope = q.g[0] * d[0] + q.g[1] * d[1];
    // where f no longer tells points apart, steps that stop shrinking are at rounding
    const bool blurred = -slope <= rounding * l.f;
    if (blurred && size >= last) return {s, l.f, size < loose_end};
    Local next = facet.at(part.at(target));
    if (size <= (exact ? quadratic_end : linear_end)) return {target, next.f, true};
    double length = 1.0;
    std::array<double, 2> to = target;
    for (int k = 0; !blurred && next.f > l.f + 1e-4 * length * slope && k < most_halvings; ++k) {
      length *= 0.5;
      to = {s[0] + length * d[0], s[1] + length * d[1]};
      next = facet.at(part.at(to));
    }
    if (!blurred && next.f >= l.f) return {s, l.f, size < loose_end};
    s = to;
    l = next;
    last = length < 1.0 ? std::numeric_limits<double>::infinity() : size;
  }
  return {s, l.f, last < loose_end};
}

}  // namespace anisocontact::projection
