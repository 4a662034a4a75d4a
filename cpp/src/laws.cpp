// Adhesion and friction of the core in a contact frame, with the slopes of the tangential force. The
// laws are compiled here and nowhere else.

#include "anisocontact/kernel/core_law.hpp"

#include <cmath>

namespace anisocontact {

namespace kernel {

namespace {

/// Unit vector whose angle is variable i of S, if S has variables.
template <class S, Place P = Place::contra>
Tangent1<S, P> turning(const Flat& e, [[maybe_unused]] std::size_t i) {
  Tangent1<S, P> u{{S(e[0]), S(e[1])}};
  if constexpr (!std::is_same_v<S, double>) {
    u[0].d[i] = -e[1];
    u[1].d[i] = e[0];
  }
  return u;
}

template <class S, Place P = Place::contra>
std::array<Tangent1<S, P>, 2> turning(const std::array<Flat, 2>& e, std::size_t first) {
  return {turning<S, P>(e[0], first), turning<S, P>(e[1], first + 1)};
}

/// a_ij, or a^ij, of the frame.
template <class S, Place P>
Tangent2<S, P, P> flat_metric() {
  return {{{{S(1.0), S(0.0)}, {S(0.0), S(1.0)}}}};
}

/// Adhesion as it is at a point, where a penalty may be stiffer.
law::LinearModel adhesion_at(const InterfaceLaw& l, const PointState& state) {
  law::LinearModel m = law::linear_model(l.adhesion);
  if (state.stiffer[1] == 0.0) return m;
  for (auto* rate : {&m.b, &m.c})
    for (auto& row : *rate)
      for (double& x : row) x *= 1.0 + state.stiffer[1];
  return m;
}

/// The trial force and what it is made of.
struct FrameTrial {
  law::LinearModel model;
  law::AxesComponents<double> axes;  ///< of the tensors
  law::LinearTensors<double> tensors;
  law::Trial<double> trial;
};

law::AxesComponents<double> frame_axes(const std::array<Flat, 2>& e) {
  return {turning<double, Place::co>(e, 0), turning<double, Place::contra>(e, 0)};
}

/// The slip that the trial force counts: that of the step, or all since the start.
Vector<double> counted(const ContactFrame& in) {
  const Vector<double> increment{in.increment};
  return in.total ? Vector<double>{in.elastic} + increment : increment;
}

FrameTrial frame_trial(const law::LinearModel& model, const ContactFrame& in) {
  const auto axes = frame_axes(in.rate_axes);
  const auto tensors = law::pull_back(model, axes);
  const Covector<double> stored{in.stored};
  const Vector<double> elastic{in.elastic}, slip = counted(in);
  return {model, axes, tensors,
          in.connection ? law::trial(tensors, *in.connection, stored, elastic, slip, in.dt)
                        : law::trial(tensors, stored, elastic, slip, in.dt)};
}

/// Derivatives of the trial force and of its stiffness by the angles of the axes of adhesion.
struct TrialSlopes {
  std::array<Covector<double>, 2> traction;
  std::array<CoCo<double>, 2> stiffness;
};

/// Of m_ij e_i (x) e_j by the angle of e_k, with e_k' its derivative.
CoCo<double> turned(const law::AxesMatrix& m, std::size_t k,
                    const std::array<Covector<double>, 2>& e, const Covector<double>& de) {
  const Covector<double> right = m[k][0] * e[0] + m[k][1] * e[1],
                         left = m[0][k] * e[0] + m[1][k] * e[1];
  return outer(de, right) + outer(left, de);
}

/// Of a_ij e_i (x) e^j; the reciprocal axes change by d e^j = -(e^j . e_k') e^k.
CoContra<double> turned_mixed(const law::AxesMatrix& m, std::size_t k,
                              const law::AxesComponents<double>& axes, const Covector<double>& de) {
  const auto dual = law::reciprocal(axes.lower, axes.upper);
  const Vector<double> right = m[k][0] * dual[0] + m[k][1] * dual[1];
  const double d0 = dot(de, dual[0]), d1 = dot(de, dual[1]);
  const Covector<double> left =
      (m[0][0] * d0 + m[0][1] * d1) * axes.lower[0] + (m[1][0] * d0 + m[1][1] * d1) * axes.lower[1];
  return outer(de, right) - outer(left, dual[k]);
}

/// By (w + dt A) T_tr = w T_n + Q dxi + dt C dxi_el,n and (w + dt A) S = -Q with Q = B + dt C.
TrialSlopes trial_slopes(const ContactFrame& in, const FrameTrial& t) {
  const law::LinearModel& m = t.model;
  const Vector<double> increment = counted(in), elastic{in.elastic};
  law::AxesMatrix q;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) q[i][j] = m.b[i][j] + in.dt * m.c[i][j];
  TrialSlopes s;
  for (std::size_t k = 0; k < 2; ++k) {
    const Flat& e = in.rate_axes[k];
    const Covector<double> de{{-e[1], e[0]}};
    const CoCo<double> dq = turned(q, k, t.axes.lower, de);
    Covector<double> force = dq * increment;
    if (m.c != law::AxesMatrix{})
      force = force + in.dt * (turned(m.c, k, t.axes.lower, de) * elastic);
    CoCo<double> stiffness = dq;
    if (t.tensors.relaxes) {
      const CoContra<double> da = in.dt * turned_mixed(m.a, k, t.axes, de);
      force = force - da * t.trial.traction;
      stiffness = stiffness + da * t.trial.stiffness;
    }
    s.traction[k] = t.trial.response * force;
    s.stiffness[k] = -(t.trial.response * stiffness);
  }
  return s;
}

/// Unit vectors at fixed angles.
template <class S>
std::array<Vector<S>, 2> fixed(const std::array<Flat, 2>& e) {
  return {constant<S>(Vector<double>{e[0]}), constant<S>(Vector<double>{e[1]})};
}

/// Axes of the second surface, the first ones where it has no field.
template <class S>
std::array<Vector<S>, 2> second_axes(const InterfaceLaw& l, const ContactFrame& in) {
  return fixed<S>(l.friction_directions_second.field ? in.second_axes : in.friction_axes);
}

/// Friction tensor and axes.
template <class S>
void put_friction(const InterfaceLaw& l, const std::array<Vector<S>, 2>& axes,
                  const std::array<Vector<S>, 2>& second, law::SlideProblem<S>& p) {
  p.axes = axes;
  p.a_co = flat_metric<S, Place::co>();
  p.friction = law::friction_tensor(l.friction, flat_metric<S, Place::contra>(), p.axes, second);
}

/// Slopes of the force on the yield ellipse by the angles of all axes; returns those by the trial
/// force and N. N is the only way in which a rule sees the normal law, the trial force the only one
/// in which it sees history and motion.
template <std::size_t Angles>
std::array<Flat, 3> slide_slopes(const InterfaceLaw& l, const ContactFrame& in,
                                 const TrialSlopes& t, const law::SlideProblem<double>& p,
                                 const law::SlideResult<double>& solved, Reaction& r) {
  using S = Dual<2 + Angles>;  // two angles of adhesion, angles of friction
  law::SlideProblem<S> d;
  const auto axes = turning<S>(in.friction_axes, 2);
  put_friction(l, axes, Angles > 2 ? turning<S>(in.second_axes, Angles) : axes, d);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      d.stiffness(i, j) = S(p.stiffness(i, j));
      for (std::size_t k = 0; k < 2; ++k) d.stiffness(i, j).d[k] = t.stiffness[k](i, j);
    }
  return std::visit(
      [&](const auto& rule) {
        const law::SlideTangent by = rule.tangent(p, solved);
        const auto change = rule.tensor_tangent(p, solved, by, d);
        for (std::size_t k = 0; k < 2; ++k) r.slope(Slope::adhesion, k) = change[k].c;
        for (std::size_t k = 0; k < Angles; ++k) r.slope(Slope::friction, k) = change[2 + k].c;
        const auto& m = by.d_trial;
        return std::array<Flat, 3>{Flat{m(0, 0), m(1, 0)}, Flat{m(0, 1), m(1, 1)}, by.d_pressure.c};
      },
      l.rule);
}

/// Adds the slopes of the trial force, times those of the force by it.
void add_trial_slopes(const ContactFrame& in, const FrameTrial& t, const TrialSlopes& d,
                      const std::array<Flat, 3>& by_force, Reaction& r) {
  const CoContra<double>& response = t.trial.response;
  CoCo<double> by_elastic = in.dt * (response * t.tensors.c);
  if (in.total) by_elastic = by_elastic - t.trial.stiffness;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t a = 0; a < 2; ++a) {
      const double f = by_force[i][a];
      for (std::size_t j = 0; j < 2; ++j) {
        r.slope(Slope::increment, j)[a] -= f * t.trial.stiffness(i, j);
        r.slope(Slope::stored, j)[a] += f * t.tensors.w * response(i, j);
        r.slope(Slope::elastic, j)[a] += f * by_elastic(i, j);
        r.slope(Slope::adhesion, j)[a] += f * d.traction[j][i];
      }
    }
}

/// What changes of the stiffness, `d`, make of the force of a point that slips, at fixed trial force.
template <std::size_t N>
law::TensorTangent<N> by_stiffness(const InterfaceLaw& l, const ContactFrame& in,
                                   const law::SlideProblem<double>& p,
                                   const law::SlideResult<double>& solved,
                                   const std::array<CoCo<double>, N>& change) {
  using S = Dual<N>;
  law::SlideProblem<S> d;
  put_friction(l, fixed<S>(in.friction_axes), second_axes<S>(l, in), d);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      d.stiffness(i, j) = S(p.stiffness(i, j));
      for (std::size_t k = 0; k < N; ++k) d.stiffness(i, j).d[k] = change[k](i, j);
    }
  return std::visit(
      [&](const auto& rule) { return rule.tensor_tangent(p, solved, rule.tangent(p, solved), d); },
      l.rule);
}

/// A change of the trial force as one of the force.
Covector<double> by_trial(const std::array<Flat, 3>& by_force, const Covector<double>& trial) {
  return {{by_force[0][0] * trial[0] + by_force[1][0] * trial[1],
           by_force[0][1] * trial[0] + by_force[1][1] * trial[1]}};
}

/// Change of the force with the time that the law acts, of a point that came into contact.
Covector<double> by_time(const InterfaceLaw& l, const ContactFrame& in, const FrameTrial& t,
                         const law::SlideProblem<double>& p, const law::SlideResult<double>& solved,
                         const std::array<Flat, 3>& by_force, bool slips) {
  const CoContra<double>& response = t.trial.response;
  const CoCo<double>& stiffness = t.trial.stiffness;
  const Covector<double> trial =
      response * (t.tensors.c * Vector<double>{in.increment} - t.tensors.a * t.trial.traction);
  const Covector<double> out = by_trial(by_force, trial);
  if (!slips) return out;
  const CoCo<double> change = -(response * (t.tensors.c + t.tensors.a * stiffness));
  return out + by_stiffness<1>(l, in, p, solved, {change})[0];
}

/// By (w G + dt A) T_tr = ... and (w G + dt A) S = ... each entry of G, row after row.
void put_connection_slopes(const InterfaceLaw& l, const ContactFrame& in, const FrameTrial& t,
                           const law::SlideProblem<double>& p,
                           const law::SlideResult<double>& solved,
                           const std::array<Flat, 3>& by_force, bool slips, Reaction& r) {
  const CoContra<double> response = t.tensors.w * t.trial.response;
  std::array<CoCo<double>, 4> stiffness;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t i = k / 2, m = k % 2;
    const Covector<double> column{{response(0, i), response(1, i)}};
    stiffness[k] =
        -outer(column, Covector<double>{{t.trial.stiffness(m, 0), t.trial.stiffness(m, 1)}});
    r.slope(Slope::connection, k) = by_trial(by_force, -t.trial.traction[m] * column).c;
  }
  if (!slips) return;
  const auto change = by_stiffness<4>(l, in, p, solved, stiffness);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t a = 0; a < 2; ++a) r.slope(Slope::connection, k)[a] += change[k][a];
}

/// Slopes of the force that was `solved`; `time` is that in contact by the gap, `whole` the increment
/// of the whole step.
void put_slopes(const InterfaceLaw& l, const ContactFrame& in, const FrameTrial& t,
                const law::SlideProblem<double>& p, const law::SlideResult<double>& solved,
                const Dual<1>& time, const Flat& whole, Reaction& r) {
  const TrialSlopes by_angle = trial_slopes(in, t);
  const bool slips = r.status == Contact::slip;
  std::array<Flat, 3> by_force{Flat{1.0, 0.0}, Flat{0.0, 1.0}, Flat{0.0, 0.0}};
  if (law::frictionless(l.friction)) {
    by_force = {};
  } else if (slips) {
    by_force = l.friction_directions_second.field ? slide_slopes<4>(l, in, by_angle, p, solved, r)
                                                  : slide_slopes<2>(l, in, by_angle, p, solved, r);
    if (in.connection) put_connection_slopes(l, in, t, p, solved, by_force, true, r);
  } else if (in.connection) {
    put_connection_slopes(l, in, t, p, solved, by_force, false, r);
  }
  add_trial_slopes(in, t, by_angle, by_force, r);
  Covector<double> later{};
  if (time.d[0] != 0.0 && t.tensors.in_time && !law::frictionless(l.friction))
    later = by_time(l, in, t, p, solved, by_force, slips);
  for (std::size_t a = 0; a < 2; ++a) {
    double& by_gap = r.slope(Slope::gap, 0)[a];
    by_gap = by_force[2][a] * in.d_pressure + later[a] * time.d[0];
    for (std::size_t j = 0; j < 2; ++j) {
      by_gap += r.slope(Slope::increment, j)[a] * whole[j] * in.fraction.d[0];
      r.slope(Slope::increment, j)[a] *= in.fraction.v;
    }
  }
}

/// Whether forces and slopes are numbers; in the rounding of an ellipse that is thin they may be none.
bool is_finite(const Reaction& r) noexcept {
  double sum = r.traction[0] + r.traction[1];
  for (const Flat& slope : r.d) sum += slope[0] + slope[1];
  return std::isfinite(sum);
}

/// Writes what the law answers to `r`, which is new.
template <bool tangent>
void react(const InterfaceLaw& l, const PointState& state, ContactFrame in, Reaction& r) noexcept {
  Dual<1> time(in.dt);
  const Flat whole = in.increment;
  if (!remembers(state)) {
    time = time_in_contact(in.fraction, in.dt);
    in.dt = time.v;
  }
  for (double& x : in.increment) x *= in.fraction.v;
  const FrameTrial t = frame_trial(adhesion_at(l, state), in);
  law::SlideProblem<double> p;
  put_friction(l, fixed<double>(in.friction_axes), second_axes<double>(l, in), p);
  p.stiffness = t.trial.stiffness;
  p.trial = t.trial.traction;
  p.increment = {in.increment};
  p.elastic = Vector<double>{in.elastic} + p.increment;
  p.pressure = in.pressure;
  const auto solved = tangential(l, p, r.status);
  if (!solved.converged) {
    r.failure = Failure::law;
    return;
  }
  const Vector<double> slip = in.real * solved.slip, increment = in.real * p.increment;
  const Vector<double> elastic = in.real * (p.elastic - solved.slip);
  const auto energies = law::energies(t.model, frame_axes(in.adhesion_axes), solved.stored, elastic,
                                      increment - slip, in.dt);
  r.traction = solved.traction.c;
  r.stored = solved.stored.c;
  r.elastic = elastic.c;
  r.slip = slip.c;
  r.increment = increment.c;
  r.dissipation = -dot(solved.traction, slip);
  r.viscous = energies.viscous;
  r.energy = energies.elastic;
  if constexpr (tangent) put_slopes(l, in, t, p, solved, time, whole, r);
  if (is_finite(r)) return;
  const Contact status = r.status;
  r = {};
  r.status = status;
  r.failure = Failure::law;
}

}  // namespace

Reaction CoreLaw::evaluate(const PointState& state, const ContactFrame& in,
                           bool tangent) const noexcept {
  Reaction r;
  with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
    if (tangent)
      react<true>(law_, state, in, r);
    else
      react<false>(law_, state, in, r);
  });
  return r;
}

}  // namespace kernel

}  // namespace anisocontact
