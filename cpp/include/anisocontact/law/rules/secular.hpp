#pragma once
// The scalar equation of the implicit rules: the smallest lambda >= 0 at which
//   T(lambda) = (I + lambda S K)^-1 T_tr = u/D,   u = T_tr + lambda m,   m = adj(S K) T_tr,
//   D = 1 + lambda tr(S K) + lambda^2 det(S K)     (exact for a 2 x 2 tensor)
// meets the yield ellipse, |T|_F = N.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anisocontact/law/slide.hpp"

namespace anisocontact::law {

template <class S>
struct Secular {
  ContraContra<S> friction;
  Covector<S> trial, m;
  S tr, det_sk;

  static Secular of(const SlideProblem<S>& p, const ContraContra<S>& k) {
    const CoContra<S> sk = p.stiffness * k;
    return {p.friction, p.trial, adjugate(sk) * p.trial, trace(sk),
            is_strip(p) ? S(0.0) : det(p.stiffness) * det(k)};
  }

  /// h = N D/|u|_F - 1, zero at the solution and nearly linear in lambda.
  S residual(const S& l, const S& pressure) const {
    const S d = S(1.0) + l * (tr + l * det_sk);
    return pressure * d / friction_norm(friction, trial + l * m) - S(1.0);
  }
};

/// Where T(lambda) first meets the ellipse.
struct Root {
  double lambda{0.0};
  bool converged{false};
};

/// Finds the smallest root. With P = N^2 D^2 - |u|_F^2 = a0 + a1 l + ... + a4 l^4, a0 < 0 <= a3, a4:
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
        norm_(s.friction),
        trial_(norm_.reduce(s.trial)),
        m_(norm_.reduce(s.m)),
        q0_(norm_.product(trial_, trial_)),
        q1_(norm_.product(trial_, m_)),
        q2_(norm_.product(m_, m_)),
        // below this ratio the direction of T changes no more, and D would overflow
        n_(std::max(pressure, 1e-60 * std::sqrt(q0_))) {}

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
      return {std::numeric_limits<double>::infinity(), true};
    return beyond(low);
  }

  /// dh/dlambda.
  double slope(double lambda) const noexcept {
    const Point x = at(lambda);
    return x.slope / x.size;
  }

 private:
  /// h and its derivatives, all times |u|_F, the size; and half of d(ln |u|_F^2)/dlambda.
  struct Point {
    double h, slope, bend, size, turn;
  };
  using Pair = std::array<double, 2>;

  /// |T|_F^2 = w_0 (T_0 + r T_1)^2 + w_1 T_1^2, the factors of Cholesky: as smooth in lambda as
  /// rounding allows, whatever the condition of F.
  struct Norm {
    double r;
    Pair w;

    explicit Norm(const ContraContra<double>& f)
        : r(f(0, 1) / f(0, 0)), w{f(0, 0), det(f) / f(0, 0)} {}
    Pair reduce(const Covector<double>& t) const { return {t[0] + r * t[1], t[1]}; }
    double product(const Pair& a, const Pair& b) const {
      return w[0] * a[0] * b[0] + w[1] * a[1] * b[1];
    }
  };
  static constexpr int most_ = 200;

  Point at(double l) const noexcept {
    const double d = 1.0 + l * (tr_ + l * det_);
    // from u, not as a quadratic in lambda: that would lose the digits of (N/|T_tr|)^2
    const Pair u{trial_[0] + l * m_[0], trial_[1] + l * m_[1]};
    const double p = norm_.product(u, u), size = std::sqrt(p), inverse = 1.0 / p;
    const double dd = tr_ + 2.0 * l * det_, turn = norm_.product(u, m_) * inverse;
    const double bend = 2.0 * (det_ - dd * turn) + d * (3.0 * turn * turn - q2_ * inverse);
    return {n_ * d - size, n_ * (dd - d * turn), n_ * bend, size, turn};
  }

  /// Zero up to a few roundings; or no longer falling and within the rounding of u.
  bool is_root(double l, const Point& x, double previous) const noexcept {
    if (std::abs(x.h) <= 4e-15 * x.size) return true;
    constexpr double rounding2 = 1e-29;
    return std::abs(x.h) >= previous * x.size && x.h * x.h <= rounding2 * (q0_ + l * l * q2_);
  }

  /// Newton on P = |u|_F^2 h (h + 2), monotone from lambda = 0.
  Root in_concave_part(double inflection) const noexcept {
    Root r;
    double previous = 2.0;
    for (int k = 0; k < most_; ++k) {
      const Point x = at(r.lambda);
      if (is_root(r.lambda, x, previous)) {
        r.converged = x.slope > 0.0;
        return r;
      }
      const double value = x.h * (x.h + 2.0 * x.size);
      const double slope = 2.0 * (x.turn * value + (x.h + x.size) * x.slope);
      if (!(slope > 0.0)) return r;
      r.lambda -= value / slope;
      if (!(r.lambda < inflection)) return r;
      previous = std::abs(x.h) / x.size;
    }
    return r;
  }

  /// Halley's step on h, that is, to the zero of a hyperbola with the derivatives of h; Newton's
  /// where h bends too much for that.
  static double stepped(double l, const Point& x) noexcept {
    const double square = x.slope * x.slope, below = 2.0 * square - x.h * x.bend;
    return l - (below > square ? 2.0 * x.h * x.slope / below : x.h / x.slope);
  }

  /// Whether a step of Halley, which leaves the cube of the error, ends at the root but for rounding.
  static bool ends(const Point& x) noexcept {
    constexpr double enough = 1e-6;
    const double square = x.slope * x.slope;
    return std::abs(x.h) * (square + std::abs(x.bend) * x.size) <= enough * square * x.size;
  }

  /// Halley on h, kept inside a bracket, where there is one root above `low`.
  Root beyond(double low) const noexcept {
    Root r{low};
    double high = std::numeric_limits<double>::infinity(), previous = 2.0;
    for (int k = 0; k < most_; ++k) {
      const Point x = at(r.lambda);
      if (is_root(r.lambda, x, previous)) {
        r.converged = x.slope > 0.0;
        return r;
      }
      previous = std::abs(x.h) / x.size;
      (x.h < 0.0 ? low : high) = r.lambda;
      const double next = stepped(r.lambda, x);
      const bool inside = next > low && next < high;
      r.lambda = inside ? next : between(low, high);
      if (inside && x.slope > 0.0 && ends(x)) {
        r.converged = true;
        return r;
      }
    }
    return r;
  }

  /// A point inside the bracket: in the middle of the powers of two where it is wide.
  double between(double low, double high) const noexcept {
    if (std::isinf(high)) return 8.0 * low + 1.0 / tr_;
    const double least = std::max(low, 1e-3 / tr_);
    return high > 4.0 * least ? std::sqrt(least) * std::sqrt(high) : 0.5 * (low + high);
  }

  double tr_, det_;
  Norm norm_;
  Pair trial_, m_;
  double q0_, q1_, q2_, n_;
};

}  // namespace anisocontact::law
