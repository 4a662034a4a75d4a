#pragma once
// The law of an interface at one point: kinematics in, traction and trial state out.

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

/// Axes of a field; without one, along the first coordinate line.
template <class S>
anisotropy::Axes<S> axes_of(const std::optional<anisotropy::AnyField>& field,
                            const surface::Geometry<S>& g, const Vector<S>& xi) {
  if (field) return anisotropy::axes(*field, g, xi);
  return anisotropy::axes_from(g, g.jet.d1[0], anisotropy::Turn{});
}

/// N, T and the trial state.
template <class S>
struct Reaction {
  S pressure{0.0};
  Covector<S> traction{};
  anisotropy::Axes<S> adhesion_axes{}, friction_axes{};
  PointState state{};
  Failure failure{Failure::none};
};

/// Part of a step that a point spent in contact: 1 where it was in contact before, else what is
/// left after the gap closed, the motion taken as straight; nothing where a multiplier holds it at
/// no gap, the limit of a stiff law.
template <class S>
S contact_fraction(const PointState& state, const S& gap) {
  if (state.status != static_cast<std::int64_t>(Contact::open) || !(state.gap > 0.0)) return S(1.0);
  if (!(value(gap) < 0.0)) return S(0.0);
  return gap / (gap - S(state.gap));
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
  if (m.w == 0.0) return law::pressure(m, gap, state.gap, state.pressure, dt, state.multiplier);
  const S time = time_in_contact(contact_fraction(state, gap), dt);
  return law::pressure(m, gap, state.gap, state.pressure, time, state.multiplier);
}

/// Elastic energy and viscous loss of the normal law in a step that ends at a gap.
inline law::Energies normal_energies(const law::NormalModel& m, const PointState& old, double gap,
                                     double pressure, double dt) {
  const double time = m.w == 0.0 ? dt : time_in_contact(contact_fraction(old, gap), dt);
  return law::energies(m, gap, gap - std::min(old.gap, 0.0), pressure, time);
}

/// State of a point that is not in contact: no force, no history but its path.
template <class S>
PointState opened(const PointState& old, const Kinematics<S>& k) {
  PointState s = lasting(old);
  s.xi = {value(k.xi[0]), value(k.xi[1])};
  s.origin = s.xi;
  s.gap = value(k.gap);
  return s;
}

/// History and increment as the law needs them; a point that comes into contact has no history.
template <class S>
Transported<S> history(const AnyEvolution& evolution, const PointState& state,
                       const Kinematics<S>& k, const CoCo<S>& adhesion) {
  Transported<S> t =
      std::visit([&](const auto& e) { return e.apply(state, k, adhesion); }, evolution);
  if (state.status == static_cast<std::int64_t>(Contact::open)) {
    t.stored = {};
    t.elastic = {};
    t.increment = contact_fraction(state, k.gap) * t.increment;
  }
  return t;
}

/// Time that adhesion acts: the whole step where the point was in contact.
template <class S>
S time_of_law(const PointState& state, const Kinematics<S>& k) {
  if (state.status != static_cast<std::int64_t>(Contact::open)) return S(k.dt);
  return time_in_contact(contact_fraction(state, k.gap), k.dt);
}

/// Axes of the tensors of a step. A law in rates takes those halfway from the committed axes, turned
/// with the normal, to those of now; one that follows at once those of now.
template <class S>
std::array<Vec3<S>, 2> axes_of_rate(const AnyEvolution& evolution, const law::LinearModel& model,
                                    const PointState& state, const Kinematics<S>& k,
                                    const std::array<Vec3<S>, 2>& now) {
  using std::sqrt;
  if (model.w == 0.0 || !has_pair(state.axes) || !looks_back(evolution)) return now;
  std::array<Vec3<S>, 2> mean = kept_pair(state.axes, k);
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3<S> old = (S(1.0) / sqrt(mean[i].dot(mean[i]))) * mean[i];
    const Vec3<S> sum = now[i] + (value(old.dot(now[i])) < 0.0 ? Vec3<S>(-old) : old);
    mean[i] = (S(1.0) / sqrt(sum.dot(sum))) * sum;
  }
  return mean;
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

/// The law solved at a point, in plain numbers and in any basis.
struct Solved {
  Covector<double> traction, stored;
  Vector<double> elastic;  ///< elastic slip if the whole increment were elastic
  Vector<double> increment, slip;
  CoCo<double> a_co;  ///< metric of the basis
  law::AxesComponents<double> adhesion_axes;
  double gap, pressure, dt;
  double time;  ///< in contact
  Contact status;
};

/// Trial state after the law has been solved, its components in the basis of `r`; the coordinates
/// are the caller's.
inline PointState advanced(const InterfaceLaw& l, const PointState& old, const Solved& r) {
  PointState s = lasting(old);
  const Vector<double> elastic = r.elastic - r.slip;
  s.traction = r.traction.c;
  s.stored = r.stored.c;
  s.elastic = elastic.c;
  s.slip = r.slip.c;
  s.gap = r.gap;
  s.pressure = r.pressure;
  s.slip_accumulated += std::sqrt(dot(r.slip, r.a_co * r.slip));
  s.dissipation -= dot(r.traction, r.slip);
  const auto tangential = law::energies(law::linear_model(l.adhesion), r.adhesion_axes, r.stored,
                                        elastic, r.increment - r.slip, r.time);
  const auto normal = normal_energies(law::normal_model(l.normal), old, s.gap, s.pressure, r.dt);
  s.energy_adhesion = tangential.elastic;
  s.energy_normal = normal.elastic;
  s.dissipation_viscous += tangential.viscous + normal.viscous;
  s.status = static_cast<std::int64_t>(r.status);
  return s;
}

/// Where the contact began: now, or as the history says.
inline std::array<double, 2> origin(const PointState& old, const std::array<double, 2>& xi,
                                    const Vector<double>& increment) {
  const bool begins = old.status == static_cast<std::int64_t>(Contact::open);
  return begins ? (Vector<double>{xi} - increment).c : old.origin;
}

/// The whole law at a point in the basis of the surface; `axes_at(directions)` gives the axes of a
/// direction field there.
template <class S, class AxesAt>
Reaction<S> react(const InterfaceLaw& l, const PointState& state, const Kinematics<S>& k,
                  const AxesAt& axes_at) {
  Reaction<S> r;
  r.pressure = normal_pressure(law::normal_model(l.normal), state, k.gap, k.dt);
  if (!(value(r.pressure) > 0.0)) {
    r.state = opened(state, k);
    return r;
  }
  r.adhesion_axes = axes_at(l.adhesion_directions);
  r.friction_axes = axes_at(l.friction_directions);
  const auto second =
      l.friction_directions_second.field ? axes_at(l.friction_directions_second) : r.friction_axes;
  if (!r.adhesion_axes.valid || !r.friction_axes.valid || !second.valid) {
    r.failure = Failure::direction;
    return r;
  }
  const auto adhesion = law::AxesComponents<S>::of(k.now, r.adhesion_axes.e);
  const auto& model = law::linear_model(l.adhesion);
  const auto halfway = law::AxesComponents<S>::of(
      k.now, axes_of_rate(l.evolution, model, state, k, r.adhesion_axes.e));
  const auto tensors = law::pull_back(model, halfway);
  const Transported<S> t = history(l.evolution, state, k, tensors.b);
  const S time = time_of_law(state, k);
  const auto trial = law::trial(tensors, t.connection, t.stored, t.elastic, t.increment, time);
  const auto axes = k.now.project_contra(r.friction_axes.e);
  const auto friction =
      law::friction_tensor(l.friction, k.now.a_contra, axes, k.now.project_contra(second.e));
  const law::SlideProblem<S> p{
      trial.stiffness,         friction,    k.now.a_co, axes, trial.traction,
      t.elastic + t.increment, t.increment, r.pressure};
  Contact status{};
  const auto solved = tangential(l, p, status);
  if (!solved.converged) {
    r.failure = Failure::law;
    return r;
  }
  r.traction = solved.traction;
  r.state = advanced(l, state,
                     {value(solved.traction),
                      value(solved.stored),
                      value(p.elastic),
                      value(t.increment),
                      value(solved.slip),
                      value(k.now.a_co),
                      {value(adhesion.lower), value(adhesion.upper)},
                      value(k.gap),
                      value(r.pressure),
                      k.dt,
                      value(time),
                      status});
  r.state.xi = value(k.xi).c;
  r.state.origin = origin(state, r.state.xi, value(t.increment));
  return r;
}

}  // namespace anisocontact::kernel
