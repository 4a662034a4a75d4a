#pragma once
// The implicit rules: slip normal to a second ellipse K, backward Euler in time.
//   T = (I + lambda S K)^-1 T_tr,   T . F T = N^2,   dxi_sl = -lambda K T,   lambda >= 0.

#include <cmath>
#include <limits>
#include <type_traits>

#include "anisocontact/law/slide.hpp"

namespace anisocontact::law {

/// Secular equation of an implicit rule: T(lambda) = (T_tr + lambda m)/D(lambda) with
/// m = adj(S K) T_tr and D = 1 + lambda tr(S K) + lambda^2 det(S K), exact for a 2 x 2 tensor.
template <class S>
struct Secular {
  Covector<S> trial, m;
  S tr, det_m;    // of S K
  S q0, q1, q2;   // |T_tr + lambda m|_F^2 = q0 + 2 q1 lambda + q2 lambda^2

  Secular() = default;
  Secular(const SlideProblem<S>& p, const CoContra<S>& sk)
      : trial(p.trial), tr(trace(sk)), det_m(det(sk)) {
    // adj(M) T = tr(M) T - M T for a 2 x 2 tensor, which keeps the index placement
    m = tr * trial - sk * trial;
    const Vector<S> ft = p.friction * trial;
    q0 = dot(trial, ft);
    q1 = dot(m, ft);
    q2 = dot(m, p.friction * m);
  }

  S denominator(const S& l) const { return S(1.0) + l * (tr + l * det_m); }
  Covector<S> traction(const S& l) const { return (S(1.0) / denominator(l)) * (trial + l * m); }

  /// N D / |T_tr + lambda m|_F - 1: zero at the solution, nearly linear in lambda.
  S residual(const S& l, const S& pressure) const {
    using std::sqrt;
    return pressure * denominator(l) / sqrt(q0 + l * (S(2.0) * q1 + l * q2)) - S(1.0);
  }
};

/// Smallest lambda >= 0 with |T(lambda)|_F = N: Newton on the reciprocal of the norm, which from
/// lambda = 0 is monotone where K = F, kept inside a bracket where it is not.
struct Root {
  double lambda{0.0};
  double slope{1.0};
  bool converged{false};
};

inline Root solve(const Secular<double>& s, double pressure) noexcept {
  constexpr int most = 60;
  constexpr double tolerance = 4e-15;  // a few roundings of the norm
  Root r;
  double low = 0.0, high = std::numeric_limits<double>::infinity(), previous = 2.0;
  for (int k = 0; k < most; ++k) {
    const double d = 1.0 + r.lambda * (s.tr + r.lambda * s.det_m);
    const double p = s.q0 + r.lambda * (2.0 * s.q1 + r.lambda * s.q2);
    const double scaled = pressure / std::sqrt(p);
    const double f = scaled * d - 1.0;
    r.slope = scaled * ((s.tr + 2.0 * r.lambda * s.det_m) - d * (s.q1 + r.lambda * s.q2) / p);
    // converged, or as near as rounding lets it come
    if (std::abs(f) <= tolerance || (std::abs(f) < 1e-13 && std::abs(f) >= previous)) {
      r.converged = r.slope > 0.0;
      return r;
    }
    previous = std::abs(f);
    (f < 0.0 ? low : high) = r.lambda;
    double next = r.lambda - f / r.slope;
    if (!(next > low && next < high))
      next = std::isinf(high) ? 2.0 * low + 1.0 / s.tr : 0.5 * (low + high);
    r.lambda = next;
  }
  return r;
}

/// An implicit rule; `Derived` gives the slip ellipse by `conjugate(problem)`, K^ij.
template <class Derived>
class Normality {
 public:
  template <class S>
  SlideResult<S> slide(const SlideProblem<S>& p) const noexcept {
    const ContraContra<S> k = self().conjugate(p);
    const Secular<S> secular(p, p.stiffness * k);
    const Root root = solve(plain(secular), value(p.pressure));
    S lambda(root.lambda);
    // one Newton step in S carries the exact derivative of the root; in doubles it changes nothing
    if constexpr (!std::is_same_v<S, double>)
      lambda -= secular.residual(lambda, p.pressure) / S(root.slope);
    SlideResult<S> r;
    r.traction = secular.traction(lambda);
    r.stored = r.traction;
    r.slip = -lambda * (k * r.traction);
    r.converged = root.converged;
    return r;
  }

  /// dT = [A^-1 - w (x) A^-T n/(n.w)] dT_tr + N w/(n.w) dN with A = I + lambda S K,
  /// w = A^-1 S K T, n = F T; for K = F the tangent of the associated rule.
  SlideTangent tangent(const SlideProblem<double>& p, const SlideResult<double>& r) const noexcept {
    const ContraContra<double> k = self().conjugate(p);
    const Vector<double> kt = k * r.traction;
    const Vector<double> n = p.friction * r.traction;
    const double lambda = -dot_same(r.slip, kt) / dot_same(kt, kt);
    const CoContra<double> a_inv =
        inverse_mixed(unit<double, Place::co>() + lambda * (p.stiffness * k));
    const Covector<double> w = a_inv * (p.stiffness * kt);
    const double scale = 1.0 / dot(w, n);
    SlideTangent t;
    t.d_trial = a_inv - scale * outer(w, transpose(a_inv) * n);
    t.d_pressure = (p.pressure * scale) * w;
    return t;
  }

 private:
  const Derived& self() const { return static_cast<const Derived&>(*this); }

  /// The secular equation in plain numbers.
  template <class S>
  static Secular<double> plain(const Secular<S>& s) {
    if constexpr (std::is_same_v<S, double>) {
      return s;
    } else {
      Secular<double> r;
      r.tr = s.tr.v, r.det_m = s.det_m.v;
      r.q0 = s.q0.v, r.q1 = s.q1.v, r.q2 = s.q2.v;
      return r;
    }
  }
  /// Component sum of two parallel vectors: lambda is their ratio in any basis.
  static double dot_same(const Vector<double>& a, const Vector<double>& b) {
    return a[0] * b[0] + a[1] * b[1];
  }
  static CoContra<double> inverse_mixed(const CoContra<double>& m) {
    return (1.0 / det(m)) * (trace(m) * unit<double, Place::co>() - m);
  }
};

}  // namespace anisocontact::law
