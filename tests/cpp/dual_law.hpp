#pragma once
// Evolution and law at a point in dual numbers, in the basis of a surface: the reference for what the
// core solves in a contact frame and differentiates by hand.

#include "anisocontact/kernel/half_turn.hpp"
#include "anisocontact/kernel/interface.hpp"

namespace anisocontact::oracle {

using namespace kernel;

/// Where a point is on the master.
template <class S>
struct Motion {
  surface::Geometry<S> now;
  surface::Geometry<S> before;  ///< at the committed coordinates, today's configuration
  Vector<S> xi;
  surface::Domain domain;
  S gap;
  double dt;
  std::array<Vec3<S>, 2> own{Vec3<S>::Zero(), Vec3<S>::Zero()};  ///< tangents of the slave
};

/// History in the current convective basis, and the slip increment.
template <class S>
struct Turned {
  Covector<S> stored;
  Vector<S> elastic;
  Vector<S> increment;
};

/// Turns a tangent vector of n_0 with the least rotation that takes n_0 to n
/// (parallel transport along the geodesic of the sphere of normals).
template <class S>
Vec3<S> turn_with_normal(const Vec3<S>& v, const Vec3<S>& n0, const Vec3<S>& n) {
  const S c = v.dot(n) / (S(1.0) + n0.dot(n));
  return v - c * (n0 + n);
}

/// Stored force and elastic slip turned with the normal.
template <class S>
Turned<S> turned_history(const PointState& state, const Motion<S>& k) {
  const auto turned = [&](const Vec3<S>& v) {
    return turn_with_normal<S>(v, k.before.normal, k.now.normal);
  };
  const auto stored = constant<S>(Covector<double>{state.stored});
  const auto elastic = constant<S>(Vector<double>{state.elastic});
  return {k.now.project_co(turned(k.before.spatial(stored))),
          k.now.project_contra(turned(k.before.spatial(elastic))),
          {}};
}

/// A pair of vectors of the committed tangent plane, kept by components and turned to here.
template <class S>
std::array<Vec3<S>, 2> kept_pair(const KeptPair& kept, const Motion<S>& k) {
  const auto turned = [&](double first, double second) {
    const Vector<S> c{{S(first), S(second)}};
    return turn_with_normal<S>(k.before.spatial(c), k.before.normal, k.now.normal);
  };
  return {turned(kept[0], kept[1]), turned(kept[2], kept[3])};
}

/// The turn about the normal of what takes the slave from its committed tangents and normal to those
/// of now, F = t_i s^i + m m_0: the angle at which a rotation about the normal is nearest to it.
template <class S>
S relative_spin(const PointState& state, const Motion<S>& k) {
  using std::atan2;
  using std::sqrt;
  if (!has_pair(state.slave)) return S(0.0);
  const Vec3<S>& n = k.now.normal;
  auto old = kept_pair(state.slave, k);
  for (std::size_t i = 0; i < 2; ++i) old[i] += S(state.slave_rise[i]) * n;
  const Vec3<S> area = old[0].cross(old[1]), area_now = k.own[0].cross(k.own[1]);
  const Vec3<S> m0 = (S(1.0) / sqrt(area.dot(area))) * area;
  const Vec3<S> m = (S(1.0) / sqrt(area_now.dot(area_now))) * area_now;
  const S inverse = S(1.0) / area.dot(area);
  const std::array<Vec3<S>, 3> from{inverse * old[1].cross(area), inverse * area.cross(old[0]), m0};
  const std::array<Vec3<S>, 3> to{k.own[0], k.own[1], m};
  S sine{0.0}, cosine{0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    sine += from[i].cross(to[i]).dot(n);
    cosine += from[i].dot(to[i]) - from[i].dot(n) * to[i].dot(n);
  }
  return atan2(sine, cosine);
}

/// History and slip of `Transport`, or of `BackwardEuler`.
template <class S>
Turned<S> turned(const AnyEvolution& evolution, const PointState& state, const Motion<S>& k) {
  Turned<S> t = turned_history(state, k);
  const Vec3<S> d = k.now.jet.position - k.before.jet.position;
  if (!looks_back(evolution)) {
    t.increment = k.now.project_contra(d);
    return t;
  }
  const Vec3<S>&n0 = k.before.normal, &n = k.now.normal;
  const S c = n0.dot(n), rise = d.dot(n);
  const ArcOfNormals arc(value(c));
  const Vec3<S> nu = n0 - c * n;
  Vec3<S> u =
      d - rise * n - (lifted(c, arc.a, arc.da) * rise + lifted(c, arc.b, arc.db) * nu.dot(d)) * nu;
  const S spin = relative_spin(state, k);
  const HalfSpin half(std::sin(value(spin)), std::cos(value(spin)));
  u = lifted(spin, half.g, half.dg) * u + S(0.5) * spin * n.cross(u);
  t.increment = k.now.project_contra(u);
  return t;
}

/// Axes of a field; without one, along the first coordinate line.
template <class S>
anisotropy::Axes<S> axes_of(const std::optional<anisotropy::AnyField>& field,
                            const surface::Geometry<S>& g, const Vector<S>& xi) {
  if (field) return anisotropy::axes(*field, g, xi);
  return anisotropy::axes_from(g, g.jet.d1[0], anisotropy::Turn{});
}

/// N, T and the trial state.
template <class S>
struct Answer {
  S pressure{0.0};
  Covector<S> traction{};
  anisotropy::Axes<S> adhesion_axes{}, friction_axes{};
  PointState state{};
  Failure failure{Failure::none};
};

/// State of a point that is not in contact: no force, no history but its path.
template <class S>
PointState opened(const PointState& old, const Motion<S>& k) {
  PointState s = lasting(old);
  s.xi = {value(k.xi[0]), value(k.xi[1])};
  s.origin = s.xi;
  s.gap = value(k.gap);
  return s;
}

/// History and increment as the law needs them; a point that comes into contact has no history.
template <class S>
Turned<S> history(const InterfaceLaw& l, const PointState& state, const Motion<S>& k) {
  Turned<S> t = turned(l.evolution, state, k);
  if (state.status == static_cast<std::int64_t>(Contact::open)) {
    t.stored = {};
    t.elastic = {};
  }
  t.increment = contact_fraction(law::normal_model(l.normal), state, k.gap) * t.increment;
  return t;
}

/// Time that adhesion acts: the whole step where the point was in contact.
template <class S>
S time_of_law(const InterfaceLaw& l, const PointState& state, const Motion<S>& k) {
  if (state.status != static_cast<std::int64_t>(Contact::open)) return S(k.dt);
  return time_in_contact(contact_fraction(law::normal_model(l.normal), state, k.gap), k.dt);
}

/// Axes of the tensors of a step. A law in rates takes those halfway from the committed axes, turned
/// with the normal, to those of now; one that follows at once those of now.
template <class S>
std::array<Vec3<S>, 2> axes_of_rate(const AnyEvolution& evolution, const law::LinearModel& model,
                                    const PointState& state, const Motion<S>& k,
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
  const bool begins = !remembers(old) || old.gap > 0.0;
  return begins ? (Vector<double>{xi} - increment).c : old.origin;
}

/// The whole law at a point in the basis of the surface; `axes_at(directions)` gives the axes of a
/// direction field there.
template <class S, class AxesAt>
Answer<S> react(const InterfaceLaw& l, const PointState& state, const Motion<S>& k,
                const AxesAt& axes_at) {
  Answer<S> r;
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
  const Turned<S> t = history(l, state, k);
  const S time = time_of_law(l, state, k);
  const auto trial =
      law::trial(tensors, unit<S, Place::co>(), t.stored, t.elastic, t.increment, time);
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
  const double real = share_of_penetration(law::normal_model(l.normal), state, value(k.gap));
  r.state = advanced(l, state,
                     {value(solved.traction),
                      value(solved.stored),
                      real * value(p.elastic),
                      real * value(t.increment),
                      real * value(solved.slip),
                      value(k.now.a_co),
                      {value(adhesion.lower), value(adhesion.upper)},
                      value(k.gap),
                      value(r.pressure),
                      k.dt,
                      value(time),
                      status});
  r.state.xi = value(k.xi).c;
  r.state.origin = origin(state, r.state.xi, real * value(t.increment));
  return r;
}

}  // namespace anisocontact::oracle
