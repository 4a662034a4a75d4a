#pragma once
// Closest point of an ellipsoid: one equation in one unknown.

#include <cmath>

#include "anisocontact/surface/analytic/ellipsoid.hpp"

namespace anisocontact::projection {

/// The equation sum_i (e_i y_i / (t + e_i^2 - 1))^2 = 1, t >= 0, for the point y of the first octant
/// in units of the least semi-axis, so that all e_i >= 1. The terms are the cosines w_i of the foot
/// rho_i = e_i w_i.
struct SecularEquation {
  Vec3<double> scaled;  ///< e_i y_i
  Vec3<double> excess;  ///< e_i^2 - 1, zero for the least

  Vec3<double> cosines(double t) const noexcept {
    Vec3<double> w;
    for (Eigen::Index i = 0; i < 3; ++i)
      w[i] = scaled[i] == 0.0 ? 0.0 : scaled[i] / (t + excess[i]);
    return w;
  }

  /// Root by Newton's method on 1/|w(t)| = 1, which is concave and nearly linear: from a t on the
  /// left the iterates rise to the root and never pass it. Zero where there is no root.
  double root() const noexcept {
    double t = 0.0;
    for (Eigen::Index i = 0; i < 3; ++i) t = std::max(t, scaled[i] - excess[i]);
    if (t == 0.0 && !(cosines(0.0).squaredNorm() > 1.0)) return 0.0;
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      const Vec3<double> w = cosines(t);
      const double norm2 = w.squaredNorm();
      double slope = 0.0;  // -d(norm2)/dt / 2
      for (Eigen::Index i = 0; i < 3; ++i)
        if (w[i] != 0.0) slope += w[i] * w[i] / (t + excess[i]);
      const double step = norm2 * (std::sqrt(norm2) - 1.0) / slope;
      if (!(step > resolution * t)) break;
      t += step;
    }
    return t;
  }

 private:
  /// It takes about six; the bound is for inputs beyond the range of numbers.
  static constexpr int most_iterations = 100;
  static constexpr double resolution = 4.0 * std::numeric_limits<double>::epsilon();
};

/// Where the least coordinate is zero and there is no root, the foot is one of two (or, with equal
/// semi-axes, of a circle): the one on the positive side of the first of the least semi-axes.
inline surface::Foot closest_point(const surface::Ellipsoid& s, const Vec3<double>& x,
                                   const std::array<double, 2>*) noexcept {
  const Vec3<double>& e = s.semi_axes();
  Eigen::Index least = 0;
  const double unit = e.minCoeff(&least);
  const double unresolved = s.frame().rounding(x);
  Vec3<double> y = s.frame().to_local(x);
  for (Eigen::Index i = 0; i < 3; ++i)
    if (std::abs(y[i]) <= unresolved) y[i] = 0.0;
  SecularEquation q;
  for (Eigen::Index i = 0; i < 3; ++i) {
    q.scaled[i] = e[i] / unit * std::abs(y[i]) / unit;
    q.excess[i] = (e[i] - unit) * (e[i] + unit) / (unit * unit);
  }
  const double t = q.root();
  Vec3<double> w = q.cosines(t);
  if (t == 0.0) w[least] = std::sqrt(std::max(1.0 - w.squaredNorm(), 0.0));
  for (Eigen::Index i = 0; i < 3; ++i) w[i] = std::copysign(w[i], y[i] == 0.0 ? 1.0 : y[i]);
  surface::Foot foot =
      surface::polar_foot(std::atan2(w[1], w[0]), std::atan2(w[2], std::hypot(w[0], w[1])));
  if (t <= surface::focal_limit) foot.status = surface::Status::ambiguous;
  return foot;
}

}  // namespace anisocontact::projection
