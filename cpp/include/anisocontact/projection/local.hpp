#pragma once
// The squared distance of a point to a surface, around a point of the surface.

#include "anisocontact/projection/bernstein.hpp"
#include "anisocontact/projection/quadratic.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::projection {

/// r = rho - x with its first derivatives, and those of f = r.r/2 up to the second.
struct Local {
  Vec3<double> r, r1, r2;
  double f, g1, g2, h11, h12, h22;

  /// Second-order model of f over a part, around s.
  Quadratic model(const Part& part, const std::array<double, 2>& s) const noexcept {
    const auto& [a, b] = part.edge;
    const auto form = [&](const auto& p, const auto& q) {
      return p[0] * (h11 * q[0] + h12 * q[1]) + p[1] * (h12 * q[0] + h22 * q[1]);
    };
    return {s, {g1 * a[0] + g2 * a[1], g1 * b[0] + g2 * b[1]}, form(a, a), form(a, b), form(b, b)};
  }
};

inline Local local(const surface::Jet<double>& j, const Vec3<double>& x) noexcept {
  Local l;
  l.r = j.position - x;
  l.r1 = j.d1[0];
  l.r2 = j.d1[1];
  l.f = 0.5 * l.r.squaredNorm();
  l.g1 = l.r.dot(l.r1);
  l.g2 = l.r.dot(l.r2);
  l.h11 = l.r1.squaredNorm() + l.r.dot(j.d2[0]);
  l.h12 = l.r1.dot(l.r2) + l.r.dot(j.d2[1]);
  l.h22 = l.r2.squaredNorm() + l.r.dot(j.d2[2]);
  return l;
}

}  // namespace anisocontact::projection
