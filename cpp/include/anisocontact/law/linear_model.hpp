#pragma once
// Linear models of the interface inside the yield ellipse, integrated by backward Euler:
//   w dT/dt + A T = B v + C dxi_el                [Konyukhov Schweizerhof 2006, eq. (26)].
// w = 1 is the rate form; w = 0 with A = I gives T = B v + C dxi_el (Kelvin-Voigt).

#include <array>
#include <optional>

#include "anisocontact/anisotropy/field.hpp"
#include "anisocontact/law/axes_matrix.hpp"
#include "anisocontact/tensor/tangent.hpp"

namespace anisocontact::law {

/// w, A, B, C of a linear model: w dt_a/dt + A_ab t_b = B_ab (e_b . v) + C_ab (e_b . xi_el).
struct LinearModel {
  double w{1.0};
  AxesMatrix a{}, b{}, c{};
  bool stores{true};  ///< whether there is an energy that it stores
};

/// K with A K = R = -C, the stiffness at rest. A singular A leaves a choice: the smallest, none
/// where R is zero, else r (x) r/(q . r) of A = p (x) q and R = p (x) r. Empty where there is none.
inline std::optional<AxesMatrix> stiffness_at_rest(const LinearModel& m) {
  if (m.c == AxesMatrix{}) return AxesMatrix{};
  if (detail::determinant(m.a) != 0.0) {
    const detail::Pair first = detail::solve(m.a, {-m.c[0][0], -m.c[1][0]}),
                       second = detail::solve(m.a, {-m.c[0][1], -m.c[1][1]});
    return AxesMatrix{{{first[0], second[0]}, {first[1], second[1]}}};
  }
  const std::size_t i = detail::inner(m.a[0], m.a[0]) >= detail::inner(m.a[1], m.a[1]) ? 0 : 1;
  const detail::Pair r{-m.c[i][0], -m.c[i][1]};
  const double scale = detail::inner(m.a[i], r);
  if (scale == 0.0) return std::nullopt;
  return AxesMatrix{
      {{r[0] * r[0] / scale, r[0] * r[1] / scale}, {r[1] * r[0] / scale, r[1] * r[1] / scale}}};
}

/// The same tensors in the convective basis of the surface.
template <class S>
struct LinearTensors {
  double w;
  bool relaxes;  ///< whether A is not zero
  bool in_time;  ///< whether the force depends on the time of a step: A or C is not zero
  CoContra<S> a;
  CoCo<S> b, c;
};

/// Contravariant components of the axes reciprocal to e_1, e_2; e_1, e_2 themselves where these
/// are orthonormal.
template <class S>
std::array<Vector<S>, 2> reciprocal(const std::array<Covector<S>, 2>& lower,
                                    const std::array<Vector<S>, 2>& upper) {
  const S g11 = dot(lower[0], upper[0]), g12 = dot(lower[0], upper[1]),
          g22 = dot(lower[1], upper[1]);
  const S inv = S(1.0) / (g11 * g22 - g12 * g12);
  return {inv * (g22 * upper[0] - g12 * upper[1]), inv * (g11 * upper[1] - g12 * upper[0])};
}

/// The axes of a model in the basis of the surface: e_a . rho_i and e_a . rho^i.
template <class S>
struct AxesComponents {
  std::array<Covector<S>, 2> lower;
  std::array<Vector<S>, 2> upper;

  static AxesComponents of(const surface::Geometry<S>& g, const std::array<Vec3<S>, 2>& e) {
    AxesComponents c{{g.project_co(e[0]), g.project_co(e[1])}, {}};
    c.upper = {g.a_contra * c.lower[0], g.a_contra * c.lower[1]};
    return c;
  }
};

template <class S>
LinearTensors<S> pull_back(const LinearModel& m, const AxesComponents<S>& axes) {
  const bool relaxes = m.a != AxesMatrix{};
  LinearTensors<S> t{m.w, relaxes, relaxes || m.c != AxesMatrix{}, {}, {}, {}};
  const auto& lower = axes.lower;
  const auto dual =
      relaxes ? reciprocal(lower, axes.upper) : std::array<Vector<S>, 2>{};  // of A alone
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      if (m.a[i][j] != 0.0) t.a = t.a + m.a[i][j] * outer(lower[i], dual[j]);
      if (m.b[i][j] != 0.0) t.b = t.b + m.b[i][j] * outer(lower[i], lower[j]);
      if (m.c[i][j] != 0.0) t.c = t.c + m.c[i][j] * outer(lower[i], lower[j]);
    }
  return t;
}

/// Trial state: the trial force and the stiffness with which slip relieves it.
template <class S>
struct Trial {
  Covector<S> traction;  ///< T_tr
  CoCo<S> stiffness;     ///< T = T_tr + stiffness dxi_sl; dT_tr = -stiffness d(dxi)
  CoContra<S> response;  ///< (w G + dt A)^-1: dT_tr = response (w dT_n + dt C dxi_el,n)
};

namespace detail {

template <class S, class Time>
Trial<S> trial(const LinearTensors<S>& m, const CoContra<S>& response, const Covector<S>& stored,
               const Vector<S>& elastic, const Vector<S>& increment, const Time& dt) {
  const CoCo<S> dc = dt * m.c, right = m.b + dc;
  const Covector<S> rhs = m.w * stored + right * increment + dc * elastic;
  return {response * rhs, -(response * right), response};
}

}  // namespace detail

/// Backward Euler: (w G + dt A) T = w T_n + (B + dt C)(dxi - dxi_sl) + dt C dxi_el,n, where G
/// carries the connection of the covariant form and is the unit tensor in the transported form.
template <class S, class Time>
Trial<S> trial(const LinearTensors<S>& m, const CoContra<S>& g, const Covector<S>& stored,
               const Vector<S>& elastic, const Vector<S>& increment, const Time& dt) {
  const CoContra<S> left = m.w * g + dt * m.a;
  const CoContra<S> inverse = (S(1.0) / det(left)) * (trace(left) * unit<S, Place::co>() - left);
  return detail::trial(m, inverse, stored, elastic, increment, dt);
}

/// The same for G = 1; without relaxation nothing is to be inverted.
template <class S>
Trial<S> trial(const LinearTensors<S>& m, const Covector<S>& stored, const Vector<S>& elastic,
               const Vector<S>& increment, double dt) {
  const CoContra<S> one = unit<S, Place::co>();
  if (m.relaxes) return trial(m, one, stored, elastic, increment, dt);
  return detail::trial(m, (1.0 / m.w) * one, stored, elastic, increment, dt);
}

}  // namespace anisocontact::law
