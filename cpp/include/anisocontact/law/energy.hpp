#pragma once
// Elastic energy and viscous dissipation of the linear models, per area.

#include "anisocontact/law/linear_model.hpp"
#include "anisocontact/law/normal.hpp"

namespace anisocontact::law {

struct Energies {
  double elastic{0.0};
  double viscous{0.0};  ///< dissipated in the step
};

namespace detail {

using Pair = std::array<double, 2>;

inline Pair apply(const AxesMatrix& m, const Pair& u) {
  return {m[0][0] * u[0] + m[0][1] * u[1], m[1][0] * u[0] + m[1][1] * u[1]};
}
inline double inner(const Pair& u, const Pair& v) { return u[0] * v[0] + u[1] * v[1]; }

/// m^-1 u; of a rank-one or zero m its pseudo-inverse on the diagonal, where a zero stiffness
/// stores nothing.
inline Pair solve(const AxesMatrix& m, const Pair& u) {
  const double d = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  if (d != 0.0)
    return {(m[1][1] * u[0] - m[0][1] * u[1]) / d, (m[0][0] * u[1] - m[1][0] * u[0]) / d};
  return {m[0][0] != 0.0 ? u[0] / m[0][0] : 0.0, m[1][1] != 0.0 ? u[1] / m[1][1] : 0.0};
}

/// K = -A^-1 C, the stiffness at rest.
inline AxesMatrix at_rest(const LinearModel& m) {
  const Pair c0 = solve(m.a, {m.c[0][0], m.c[1][0]}), c1 = solve(m.a, {m.c[0][1], m.c[1][1]});
  return {{{-c0[0], -c1[0]}, {-c0[1], -c1[1]}}};
}

}  // namespace detail

/// Energy 1/2 x.K x + 1/2 t_1.K_1^-1 t_1 of a spring K beside Maxwell elements K_1 = -B - K that
/// carry t_1 = t + K x and lose t_1.K_1^-1 A t_1 per time; of Kelvin-Voigt (w = 0) 1/2 x.(-C) x
/// and the loss v.(-B) v.
inline Energies energies(const LinearModel& m, const AxesComponents<double>& axes,
                         const Covector<double>& stored, const Vector<double>& elastic,
                         const Vector<double>& increment, double dt) {
  using namespace detail;
  const auto& lower = axes.lower;
  const auto dual = reciprocal(lower, axes.upper);
  const Pair x{dot(lower[0], elastic), dot(lower[1], elastic)};
  if (m.w == 0.0) {
    const Pair v{dot(lower[0], increment) / dt, dot(lower[1], increment) / dt};
    return {-0.5 * inner(x, apply(m.c, x)), -dt * inner(v, apply(m.b, v))};
  }
  const AxesMatrix k = at_rest(m);
  AxesMatrix k1;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) k1[i][j] = -m.b[i][j] - k[i][j];
  const Pair t{dot(stored, dual[0]), dot(stored, dual[1])};
  const Pair kx = apply(k, x);
  const Pair t1{t[0] + kx[0], t[1] + kx[1]};
  return {0.5 * inner(x, kx) + 0.5 * inner(t1, solve(k1, t1)),
          dt * inner(t1, solve(k1, apply(m.a, t1)))};
}

/// The same for the normal law, whose force is n = -N and whose spring is the penetration.
inline Energies energies(const NormalModel& m, double gap, double increment, double pressure,
                         double dt) {
  if (m.w == 0.0) return {-0.5 * m.c / m.a * gap * gap, -m.b / m.a * increment * increment / dt};
  const double k = m.a != 0.0 ? -m.c / m.a : 0.0;
  const double k1 = -m.b - k;
  const double n1 = pressure + k * gap;
  const double viscous = k1 > 0.0 ? dt * m.a * n1 * n1 / k1 : 0.0;
  return {0.5 * k * gap * gap + (k1 > 0.0 ? 0.5 * n1 * n1 / k1 : 0.0), viscous};
}

}  // namespace anisocontact::law
