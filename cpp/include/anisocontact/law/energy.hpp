#pragma once
// Elastic energy and viscous dissipation of the linear models, per area.

#include <limits>

#include "anisocontact/law/linear_model.hpp"
#include "anisocontact/law/normal.hpp"

namespace anisocontact::law {

struct Energies {
  double elastic{0.0};
  double viscous{0.0};  ///< dissipated in the step
};

/// Energy 1/2 x.K x + 1/2 t_1.K_1^-1 t_1 of a spring K beside Maxwell elements K_1 = -B - K that
/// carry t_1 = t + K x and lose t_1.K_1^-1 A t_1 per time; of Kelvin-Voigt (w = 0) 1/2 x.(-C) x
/// and the loss v.(-B) v. Not a number of a model that stores none.
inline Energies energies(const LinearModel& m, const AxesComponents<double>& axes,
                         const Covector<double>& stored, const Vector<double>& elastic,
                         const Vector<double>& increment, double dt) {
  using namespace detail;
  if (!m.stores) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    return {none, none};
  }
  const auto& lower = axes.lower;
  const auto dual = reciprocal(lower, axes.upper);
  const Pair x{dot(lower[0], elastic), dot(lower[1], elastic)};
  if (m.w == 0.0) {
    const Pair v{dot(lower[0], increment) / dt, dot(lower[1], increment) / dt};
    return {-0.5 * inner(x, apply(m.c, x)), -dt * inner(v, apply(m.b, v))};
  }
  const AxesMatrix k = stiffness_at_rest(m).value_or(AxesMatrix{});
  const AxesMatrix k1 = combined(-1.0, m.b, -1.0, k);
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
