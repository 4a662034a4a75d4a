#pragma once
// The scalar equation of the implicit rules: the smallest lambda >= 0 at which
//   T(lambda) = (I + lambda S K)^-1 T_tr = (T_tr + lambda m)/D,   m = adj(S K) T_tr,
//   D = 1 + lambda tr(S K) + lambda^2 det(S K)     (exact for a 2 x 2 tensor)
// meets the yield ellipse, |T|_F = N.

#include <algorithm>
#include <cmath>
#include <limits>

#include "anisocontact/law/slide.hpp"

namespace anisocontact::law {

/// Coefficients of D and of p(lambda) = |T_tr + lambda m|_F^2 = q0 + 2 q1 lambda + q2 lambda^2.
template <class S>
struct Secular {
  Covector<S> m;
  S tr, det_sk;
  S q0, q1, q2;

  static Secular of(const SlideProblem<S>& p, const ContraContra<S>& k) {
    const CoContra<S> sk = p.stiffness * k;
    const Covector<S> m = adjugate(sk) * p.trial;
    const Vector<S> ft = p.friction * p.trial;
    return {m,
            trace(sk),
            is_strip(p) ? S(0.0) : det(p.stiffness) * det(k),
            dot(p.trial, ft),
            dot(m, ft),
            dot(m, p.friction * m)};
  }

  /// h = N D/|T_tr + lambda m|_F - 1, zero at the solution and nearly linear in lambda.
  S residual(const S& l, const S& pressure) const {
    using std::sqrt;
    const S d = S(1.0) + l * (tr + l * det_sk);
    return pressure * d / sqrt(q0 + l * (S(2.0) * q1 + l * q2)) - S(1.0);
  }
};

/// Where T(lambda) first meets the ellipse.
struct Root {
  double lambda{0.0};
  double slope{1.0};  ///< dh/dlambda
  bool converged{false};
};

/// Finds the smallest root. With P = N^2 D^2 - p = a0 + a1 l + ... + a4 l^4, a0 < 0 <= a3, a4:
/// by Descartes' rule P has one positive root, unless a2 < 0 < a1, when it may have three. P is
/// then concave up to its inflection, where Newton on P from the left cannot pass the first root;
/// where it finds none there, exactly one root lies beyond the inflection. For K = F there is
/// always one root alone. In the strip (det S = 0) there may be none: T(lambda) then tends to m/tr
/// outside the ellipse, and lambda is infinite.
class SmallestRoot {
 public:
  SmallestRoot(const Secular<double>& s, double pressure) noexcept
      : tr_(s.tr),
        det_(s.det_sk),
        q0_(s.q0),
        q1_(s.q1),
        q2_(s.q2),
        // below this ratio the direction of T changes no more, and D would overflow
        n_(std::max(pressure, 1e-60 * std::sqrt(s.q0))) {}

  Root find() const noexcept {
    const double n2 = n_ * n_;
    const double a1 = n2 * tr_ - q1_;
    const double a2 = n2 * (tr_ * tr_ + 2.0 * det_) - q2_;
    double low = 0.0;
    if (a2 < 0.0 && a1 > 0.0) {
      // 1/2 P'' = 6 a4 l^2 + 3 a3 l + a2 with a4 = (N det)^2, a3 = 2 N^2 tr det
      const double b = 3.0 * n2 * tr_ * det_;
      const double inflection = -a2 / (b + std::sqrt(b * b - 6.0 * n2 * det_ * det_ * a2));
      const Root r = in_concave_part(inflection);
      if (r.converged) return r;
      low = inflection;
    }
    if (det_ == 0.0 && (a2 < 0.0 || (a2 == 0.0 && a1 <= 0.0)))
      return {std::numeric_limits<double>::infinity(), 1.0, true};
    return beyond(low);
  }

 private:
  struct Point {
    double h, slope, p, dp;  // h, dh/dl, p, dp/dl
  };
  static constexpr int most_ = 200;

  Point at(double l) const noexcept {
    const double d = 1.0 + l * (tr_ + l * det_);
    const double p = q0_ + l * (2.0 * q1_ + l * q2_);
    const double half_dp = q1_ + l * q2_;
    const double scaled = n_ / std::sqrt(p);
    return {scaled * d - 1.0, scaled * ((tr_ + 2.0 * l * det_) - d * half_dp / p), p,
            2.0 * half_dp};
  }

  /// Zero up to a few roundings, or as near as they let it come.
  static bool is_root(double h, double previous) noexcept {
    return std::abs(h) <= 4e-15 || (std::abs(h) < 1e-13 && std::abs(h) >= previous);
  }

  /// Newton on P = p h (h + 2), monotone from lambda = 0.
  Root in_concave_part(double inflection) const noexcept {
    Root r;
    double previous = 2.0;
    for (int k = 0; k < most_; ++k) {
      const Point x = at(r.lambda);
      r.slope = x.slope;
      if (is_root(x.h, previous)) {
        r.converged = r.slope > 0.0;
        return r;
      }
      const double slope = x.dp * x.h * (x.h + 2.0) + 2.0 * x.p * (x.h + 1.0) * x.slope;
      if (!(slope > 0.0)) return r;
      r.lambda -= x.p * x.h * (x.h + 2.0) / slope;
      if (!(r.lambda < inflection)) return r;
      previous = std::abs(x.h);
    }
    return r;
  }

  /// Newton on h, kept inside a bracket, where there is one root above `low`.
  Root beyond(double low) const noexcept {
    Root r{low};
    double high = std::numeric_limits<double>::infinity(), previous = 2.0;
    for (int k = 0; k < most_; ++k) {
      const Point x = at(r.lambda);
      r.slope = x.slope;
      if (is_root(x.h, previous)) {
        r.converged = r.slope > 0.0;
        return r;
      }
      previous = std::abs(x.h);
      (x.h < 0.0 ? low : high) = r.lambda;
      double next = r.lambda - x.h / x.slope;
      if (!(next > low && next < high)) next = between(low, high);
      r.lambda = next;
    }
    return r;
  }

  /// A point inside the bracket: by its powers of two where it is wide.
  double between(double low, double high) const noexcept {
    if (std::isinf(high)) return 8.0 * low + 1.0 / tr_;
    const double least = std::max(low, 1e-3 / tr_);
    return high > 4.0 * least ? std::sqrt(least) * std::sqrt(high) : 0.5 * (low + high);
  }

  double tr_, det_, q0_, q1_, q2_, n_;
};

}  // namespace anisocontact::law
