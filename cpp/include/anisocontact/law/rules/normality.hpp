#pragma once
// Return mapping of the implicit rules: slip normal to a second ellipse K, backward Euler in time.
//   T = (I + lambda S K)^-1 T_tr,   T . F T = N^2,   dxi_sl = -lambda K T,   lambda >= 0.

#include <cmath>
#include <type_traits>

#include "anisocontact/law/rules/secular.hpp"

namespace anisocontact::law {

/// An implicit rule; `Derived` gives the slip ellipse by `conjugate(problem)`, K^ij.
template <class Derived>
class Normality {
 public:
  template <class S>
  SlideResult<S> slide(const SlideProblem<S>& p) const noexcept {
    const ContraContra<S> k = self().conjugate(p);
    const auto secular = Secular<S>::of(p, k);
    const Secular<double> numbers = plain(secular);
    const SmallestRoot finder(numbers, value(p.pressure));
    const Root root = finder.find();
    SlideResult<S> r;
    r.converged = root.converged;
    r.multiplier = S(root.lambda);
    if (std::isinf(root.lambda)) {
      r.traction = on_ellipse(p, secular.m);
      r.slip = slip_from_force(p, r.traction - p.trial);
    } else {
      // one Newton step in S carries the exact derivative of the root; in doubles it changes nothing
      if constexpr (!std::is_same_v<S, double>)
        r.multiplier -= secular.residual(r.multiplier, p.pressure) / S(finder.slope(root.lambda));
      r.traction = on_ellipse(p, p.trial + r.multiplier * secular.m);
      r.slip = -r.multiplier * (k * r.traction);
    }
    r.stored = r.traction;
    return r;
  }

  /// dT = [A^-1 - w (x) A^-T n/(n.w)] dT_tr + w/(n.w) dN with A = I + lambda S K,
  /// w = A^-1 S K T/N, n = F T/N; for K = F the tangent of the associated rule.
  SlideTangent tangent(const SlideProblem<double>& p, const SlideResult<double>& r) const noexcept {
    const ContraContra<double> k = self().conjugate(p);
    const CoContra<double> sk = p.stiffness * k;
    const Covector<double> t = (1.0 / p.pressure) * r.traction;
    const Vector<double> n = p.friction * t;
    if (std::isinf(r.multiplier)) return tangent_of_limit(p, t, adjugate(sk), n);
    const CoContra<double> a = unit<double, Place::co>() + r.multiplier * sk;
    const CoContra<double> a_inv = (1.0 / det(a)) * adjugate(a);
    const Covector<double> w = a_inv * (sk * t);
    const Covector<double> d_pressure = (1.0 / dot(w, n)) * w;
    return {a_inv - outer(d_pressure, transpose(a_inv) * n), d_pressure};
  }

  /// d(S K) acts as a trial force -lambda d(S K) T, dF as a pressure; where lambda is infinite,
  /// T = N m/|m|_F with m = adj(S K) T_tr.
  template <std::size_t N>
  TensorTangent<N> tensor_tangent(const SlideProblem<double>& p, const SlideResult<double>& r,
                                  const SlideTangent& t,
                                  const SlideProblem<Dual<N>>& d) const noexcept {
    const CoContra<Dual<N>> sk = d.stiffness * self().conjugate(d);
    const bool limit = std::isinf(r.multiplier);
    TensorTangent<N> out;
    for (std::size_t k = 0; k < N; ++k) {
      const CoContra<double> d_sk = derivative(sk, k);
      const ContraContra<double> df = derivative(d.friction, k);
      out[k] = equivalent_pressure(df, r.traction, p.pressure) * t.d_pressure;
      out[k] = out[k] + (limit ? of_limit(p, r.traction, value(sk), adjugate(d_sk) * p.trial)
                               : t.d_trial * (-r.multiplier * (d_sk * r.traction)));
    }
    return out;
  }

 private:
  const Derived& self() const { return static_cast<const Derived&>(*this); }

  /// The force on the yield ellipse in the direction u.
  template <class S>
  static Covector<S> on_ellipse(const SlideProblem<S>& p, const Covector<S>& u) {
    return p.pressure * ((S(1.0) / friction_norm(p.friction, u)) * u);
  }

  /// Of T = N t, t = m/|m|_F with m = adj(S K) T_tr.
  static SlideTangent tangent_of_limit(const SlideProblem<double>& p, const Covector<double>& t,
                                       const CoContra<double>& adjugate_sk,
                                       const Vector<double>& n) {
    const double scale = p.pressure / friction_norm(p.friction, adjugate_sk * p.trial);
    return {scale * ((unit<double, Place::co>() - outer(t, n)) * adjugate_sk), t};
  }

  /// Of T = N m/|m|_F by m.
  static Covector<double> of_limit(const SlideProblem<double>& p, const Covector<double>& traction,
                                   const CoContra<double>& sk, const Covector<double>& dm) {
    const double scale = p.pressure / friction_norm(p.friction, adjugate(sk) * p.trial);
    const Covector<double> t = (1.0 / p.pressure) * traction;
    return scale * (dm - dot(dm, p.friction * t) * t);
  }

  /// The secular equation in plain numbers.
  template <class S>
  static Secular<double> plain(const Secular<S>& s) {
    if constexpr (std::is_same_v<S, double>)
      return s;
    else
      return {value(s.friction), value(s.trial), value(s.m), value(s.tr), value(s.det_sk)};
  }
};

}  // namespace anisocontact::law
