#pragma once
// What a sliding rule, the return mapping of a trial force, is given and what it returns.
// Karush-Kuhn-Tucker conditions: Phi <= 0, lambda >= 0, lambda Phi = 0, Phi = sqrt(T . F T) - N.

#include <array>
#include <concepts>

#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/tensor/tangent.hpp"

namespace anisocontact::law {

/// A trial force outside the yield ellipse: find T on it with T = T_tr + S dxi_sl.
template <class S>
struct SlideProblem {
  CoCo<S> stiffness;              ///< S = -B, or its algorithmic counterpart in time
  ContraContra<S> friction;       ///< f^ij of T.FT = N^2
  CoCo<S> a_co;                   ///< metric
  std::array<Vector<S>, 2> axes;  ///< friction axes e_1, e_2
  Covector<S> trial;              ///< T_tr
  Vector<S> elastic;              ///< elastic slip if the whole increment were elastic
  Vector<S> increment;            ///< whole slip increment dxi
  S pressure;                     ///< N > 0
};

template <class S>
struct SlideResult {
  Covector<S> traction;  ///< T on the yield ellipse, acts in this step
  Covector<S> stored;    ///< elastic traction of the next trial; T but for the explicit rule
  Vector<S> slip;        ///< dxi_sl
  bool converged{true};
  S multiplier{0.0};  ///< lambda of an implicit rule; infinite where the strip cannot yield
};

/// Consistent tangent of T at fixed stiffness and friction tensors.
struct SlideTangent {
  CoContra<double> d_trial;     ///< dT_i / dT_tr,j
  Covector<double> d_pressure;  ///< dT_i / dN
};

/// Derivatives of T with the tensors and the axes, at fixed T_tr and N.
template <std::size_t N>
using TensorTangent = std::array<Covector<double>, N>;

/// A rule also differentiates T by N variables of which the tensors and axes of a problem depend,
/// given in dual numbers; T is a function of T_tr, N, tensors and axes alone.
template <class T>
concept SlidingRule =
    requires(const T& r, const SlideProblem<double>& p, const SlideProblem<Dual<3>>& d,
             const SlideResult<double>& s, const SlideTangent& t) {
      { r.slide(p) } noexcept -> std::same_as<SlideResult<double>>;
      { r.slide(d) } noexcept -> std::same_as<SlideResult<Dual<3>>>;
      { r.tangent(p, s) } noexcept -> std::same_as<SlideTangent>;
      { r.tensor_tangent(p, s, t, d) } noexcept -> std::same_as<TensorTangent<3>>;
      { T::describe() } -> std::same_as<Descriptor>;
    };

/// sqrt(T . F T), the norm of the yield function [Konyukhov Schweizerhof 2006, eq. (33)].
template <class S>
S friction_norm(const ContraContra<S>& friction, const Covector<S>& t) {
  using std::sqrt;
  return sqrt(dot(t, friction * t));
}

/// What a change of F in T.FT = N^2 amounts to: a change of N.
inline double equivalent_pressure(const ContraContra<double>& d_friction, const Covector<double>& t,
                                  double pressure) {
  return -0.5 * dot(t, d_friction * t) / pressure;
}

/// Whether S has rank one: the strip, where one of the adhesion stiffnesses is zero.
template <class S>
bool is_strip(const SlideProblem<S>& p) {
  constexpr double rank_limit = 1e-14;  // relative; rounding of a rank-one S is some 1e-16
  const double tr = value(contract(adjugate(p.a_co), p.stiffness));  // of S a^-1, times det a
  return value(det(p.stiffness)) * value(det(p.a_co)) <= rank_limit * tr * tr;
}

/// dxi_sl that a change of force T - T_tr stands for; in the strip the slip of least length (the
/// force then lies in the range of S), by the pseudo-inverse S^T/(S : S). S need not be symmetric.
template <class S>
Vector<S> slip_from_force(const SlideProblem<S>& p, const Covector<S>& change) {
  if (!is_strip(p)) return inverse(p.stiffness) * change;
  const ContraContra<S> a = inverse(p.a_co);
  const ContraContra<S> up = a * transpose(p.stiffness) * a;
  return (S(1.0) / contract(p.stiffness, transpose(up))) * (up * change);
}

}  // namespace anisocontact::law
