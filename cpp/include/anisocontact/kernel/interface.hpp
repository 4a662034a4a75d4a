#pragma once
// The laws of an interface, and what depends on the part of a step that a point spent in contact.

#include <algorithm>
#include <cmath>
#include <optional>

#include "anisocontact/anisotropy/registry.hpp"
#include "anisocontact/kernel/evolution.hpp"
#include "anisocontact/law/registry.hpp"
#include "anisocontact/surface/registry.hpp"

namespace anisocontact::kernel {

/// The body that carries a direction field, which it has since the reference configuration.
enum class Side { master, slave };

/// A direction field and whose it is; without a field tensors are isotropic, and any axes do.
struct Directions {
  std::optional<anisotropy::AnyField> field{};
  Side side{Side::master};
};

/// Normal law, adhesion and friction of an interface, with their directions.
struct InterfaceLaw {
  law::AnyNormalLaw normal;
  law::AnyAdhesion adhesion;
  Directions adhesion_directions;
  law::AnyFriction friction;
  Directions friction_directions;
  Directions friction_directions_second;  ///< of the second surface
  law::AnyRule rule;
  AnyEvolution evolution{};
};

/// Penetration that stands for a pressure: what it is but for a multiplier, which stands for that of
/// the penalty beside it.
template <class S>
S depth(const law::NormalModel& m, const PointState& state, const S& gap) {
  if (state.multiplier == 0.0) return -gap;
  return S(-state.multiplier / ((1.0 + state.stiffer[0]) * m.c)) - gap;
}

/// Part of a step that a point spent in contact: 1 where there was no gap before, else what is left
/// after it closed, the motion taken as straight. Where a multiplier holds a point at no gap, it is what
/// the penetration that stands for the pressure makes of the way of the gap, at most 1: times a stiffness
/// against slip like that of the penalty, N / g_n.
template <class S>
S contact_fraction(const law::NormalModel& m, const PointState& state, const S& gap) {
  if (!(state.gap > 0.0)) return S(1.0);
  const S deep = depth(m, state, gap), way = S(state.gap) - gap;
  if (!(value(deep) > 0.0)) return S(0.0);
  return value(deep) < value(way) ? deep / way : S(1.0);
}

/// Share of the slip in contact that is left where multipliers hold a point that was apart at no gap:
/// none, as in the limit of stiff penalties.
inline double share_of_penetration(const law::NormalModel& m, const PointState& state, double gap) {
  if (!(state.gap > 0.0) || state.multiplier == 0.0) return 1.0;
  const double deep = depth(m, state, gap);
  return deep > 0.0 ? std::clamp(-gap / deep, 0.0, 1.0) : 0.0;
}

/// Time that the law of a point acts in a step: from where the gap closed. Never nothing, so that
/// a rate keeps its sense.
template <class S>
S time_in_contact(const S& fraction, double dt) {
  constexpr double least = 1e-9;
  return value(fraction) > least ? fraction * S(dt) : S(least * dt);
}

/// N of a law with a rate of its own acts from where the gap closed; one that follows the rate of
/// the gap at once takes the mean rate of the step, for it would jump where the gap closes.
template <class S>
S normal_pressure(const law::NormalModel& m, const PointState& state, const S& gap, double dt) {
  if (m.w == 0.0) {
    const law::NormalModel here{m.w, m.a, m.b, (1.0 + state.stiffer[0]) * m.c};
    return law::pressure(here, gap, state.gap, state.pressure, dt, state.multiplier);
  }
  const S time = time_in_contact(contact_fraction(m, state, gap), dt);
  return law::pressure(m, gap, state.gap, state.pressure, time, state.multiplier);
}

/// N and dN/dg.
inline Dual<1> pressure_of(const InterfaceLaw& l, const PointState& state, double gap, double dt) {
  return normal_pressure(law::normal_model(l.normal), state, Dual<1>::variable(gap, 0), dt);
}

/// Elastic energy and viscous loss of the normal law in a step that ends at a gap.
inline law::Energies normal_energies(const law::NormalModel& m, const PointState& old, double gap,
                                     double pressure, double dt) {
  const double time = m.w == 0.0 ? dt : time_in_contact(contact_fraction(m, old, gap), dt);
  return law::energies(m, gap, gap - std::min(old.gap, 0.0), pressure, time);
}

/// Share of the limit by which a trial force may exceed it and still sticks: a point that has slipped
/// is on the limit, and while it does not move again rounding must not say whether it slips.
inline constexpr double on_limit = 1e-10;

/// Solves for T: the trial force where it is inside the ellipse, else what the rule makes of it.
/// Without friction there is none, whatever the adhesion, and all that would be elastic is slip.
template <class S>
law::SlideResult<S> tangential(const InterfaceLaw& l, const law::SlideProblem<S>& p,
                               Contact& status) {
  if (law::frictionless(l.friction)) {
    status = Contact::slip;
    return {{}, {}, p.elastic, true};
  }
  const S size = law::friction_norm(p.friction, p.trial);
  if (value(size) <= (1.0 + on_limit) * value(p.pressure)) {
    status = Contact::stick;
    return {p.trial, p.trial, {}, true};
  }
  status = Contact::slip;
  return std::visit([&](const auto& rule) { return rule.slide(p); }, l.rule);
}

}  // namespace anisocontact::kernel
