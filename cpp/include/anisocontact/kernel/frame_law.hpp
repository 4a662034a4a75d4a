#pragma once
// The law of an interface in an orthonormal frame t_1, t_2, n of the contact plane, with the slopes
// of the tangential force by every number that it depends on. Whoever knows how these numbers
// change with positions has the exact tangent by the chain rule.
//
// The frame is one that does not spin about n (dt_1 . t_2 = 0), so that a tangent vector v has
// d(v_a) = t_a . dv, and an axis changes by its angle d alpha = (n x e) . de.

#include "anisocontact/kernel/interface.hpp"

namespace anisocontact::kernel {

/// Components along t_1, t_2.
using Flat = std::array<double, 2>;

/// Numbers that the tangential force depends on. Pairs are components of vectors along t_1, t_2, or
/// the angles of the two axes of a field.
enum class Slope : std::size_t {
  gap = 0,
  increment = 1,
  stored = 3,
  elastic = 5,
  adhesion = 7,
  friction = 9,
  second = 11
};
inline constexpr std::size_t slopes = 13;

/// History, motion and axes at a point that is in contact.
struct FrameInput {
  double gap, dt;
  double pressure, d_pressure;        ///< N and dN/dg
  Flat stored, elastic;               ///< committed, turned to here
  Flat increment;                     ///< of the slip over the whole step
  std::array<Flat, 2> adhesion_axes;  ///< unit vectors
  std::array<Flat, 2> friction_axes, second_axes;
};

struct FrameReaction {
  Flat traction{};
  std::array<Flat, slopes> d{};  ///< by input: d T_1, d T_2
  PointState state{};            ///< vectors by their components along t_1, t_2
  Flat increment{};              ///< of the slip while in contact
  Failure failure{Failure::none};

  const Flat& slope(Slope s, std::size_t k) const { return d[static_cast<std::size_t>(s) + k]; }
  Flat& slope(Slope s, std::size_t k) { return d[static_cast<std::size_t>(s) + k]; }
};

/// Whether a point was in contact and has a history.
inline bool remembers(const PointState& s) {
  return s.status != static_cast<std::int64_t>(Contact::open);
}

namespace detail {

/// N and dN/dg.
inline Dual<1> pressure_of(const InterfaceLaw& l, const PointState& state, double gap, double dt) {
  return law::pressure(law::normal_model(l.normal), Dual<1>::variable(gap, 0), state.gap,
                       state.pressure, dt, state.multiplier);
}

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

/// The trial force; in S = Dual<2> with the angles of the axes of adhesion.
template <class S>
struct FrameTrial {
  law::AxesComponents<S> axes;
  law::Trial<S> trial;
  CoCo<double> c;  ///< of the linear model
};

template <class S>
FrameTrial<S> frame_trial(const InterfaceLaw& l, const FrameInput& in, const Flat& increment) {
  const law::AxesComponents<S> axes{turning<S, Place::co>(in.adhesion_axes, 0),
                                    turning<S, Place::contra>(in.adhesion_axes, 0)};
  const auto tensors = law::pull_back(law::linear_model(l.adhesion), axes);
  const auto trial = law::trial(tensors, constant<S>(Covector<double>{in.stored}),
                                constant<S>(Vector<double>{in.elastic}),
                                constant<S>(Vector<double>{increment}), in.dt);
  return {axes, trial, value(tensors.c)};
}

/// Friction tensor and axes; in S with variables their angles are those from `first` on.
template <class S>
void put_friction(const InterfaceLaw& l, const FrameInput& in, std::size_t first,
                  law::SlideProblem<S>& p) {
  p.axes = turning<S>(in.friction_axes, first);
  const auto second =
      l.friction_directions_second.field ? turning<S>(in.second_axes, first + 2) : p.axes;
  p.a_co = flat_metric<S, Place::co>();
  p.friction = law::friction_tensor(l.friction, flat_metric<S, Place::contra>(), p.axes, second);
}

/// Slopes of the force on the yield ellipse by the angles of all axes; returns those by the trial
/// force and N. N is the only way in which a rule sees the normal law, the trial force the only one
/// in which it sees history and motion.
template <std::size_t Angles>
std::array<Flat, 3> slide_slopes(const InterfaceLaw& l, const FrameInput& in,
                                 const FrameTrial<Dual<2>>& t, const law::SlideProblem<double>& p,
                                 const law::SlideResult<double>& solved, FrameReaction& r) {
  using S = Dual<2 + Angles>;  // two angles of adhesion, angles of friction
  law::SlideProblem<S> d;
  put_friction(l, in, 2, d);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      d.stiffness(i, j) = S(p.stiffness(i, j));
      for (std::size_t k = 0; k < 2; ++k) d.stiffness(i, j).d[k] = t.trial.stiffness(i, j).d[k];
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
inline void add_trial_slopes(const FrameTrial<Dual<2>>& t, double w, double dt,
                             const std::array<Flat, 3>& by_force, FrameReaction& r) {
  const auto& stiffness = t.trial.stiffness;
  const CoContra<double> response = value(t.trial.response);
  const CoCo<double> by_elastic = dt * (response * t.c);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t a = 0; a < 2; ++a) {
      const double f = by_force[i][a];
      for (std::size_t j = 0; j < 2; ++j) {
        r.slope(Slope::increment, j)[a] -= f * stiffness(i, j).v;
        r.slope(Slope::stored, j)[a] += f * w * response(i, j);
        r.slope(Slope::elastic, j)[a] += f * by_elastic(i, j);
        r.slope(Slope::adhesion, j)[a] += f * t.trial.traction[i].d[j];
      }
    }
}

}  // namespace detail

/// Force and trial state; with `tangent` also the slopes.
template <bool tangent>
FrameReaction react_in_frame(const InterfaceLaw& l, const PointState& state,
                             FrameInput in) noexcept {
  using S = std::conditional_t<tangent, Dual<2>, double>;
  FrameReaction r;
  Dual<1> share(1.0);
  const Flat whole = in.increment;
  if (!remembers(state)) {
    share = contact_fraction(state, Dual<1>::variable(in.gap, 0));
    for (double& x : in.increment) x *= share.v;
  }
  const auto t = detail::frame_trial<S>(l, in, in.increment);
  law::SlideProblem<double> p;
  detail::put_friction(l, in, 0, p);
  p.stiffness = value(t.trial.stiffness);
  p.trial = value(t.trial.traction);
  p.increment = {in.increment};
  p.elastic = Vector<double>{in.elastic} + p.increment;
  p.pressure = in.pressure;
  Contact status{};
  const auto solved = tangential(l, p, status);
  if (!solved.converged) {
    r.failure = Failure::law;
    return r;
  }
  r.traction = solved.traction.c;
  r.increment = in.increment;
  r.state = advanced(l, state,
                     {solved.traction,
                      solved.stored,
                      p.elastic,
                      p.increment,
                      solved.slip,
                      p.a_co,
                      {value(t.axes.lower), value(t.axes.upper)},
                      in.gap,
                      in.pressure,
                      in.dt,
                      status});
  if constexpr (tangent) {
    std::array<Flat, 3> by_force{Flat{1.0, 0.0}, Flat{0.0, 1.0}, Flat{0.0, 0.0}};
    if (status == Contact::slip)
      by_force = l.friction_directions_second.field
                     ? detail::slide_slopes<4>(l, in, t, p, solved, r)
                     : detail::slide_slopes<2>(l, in, t, p, solved, r);
    detail::add_trial_slopes(t, law::linear_model(l.adhesion).w, in.dt, by_force, r);
    for (std::size_t a = 0; a < 2; ++a) {
      double& by_gap = r.slope(Slope::gap, 0)[a];
      by_gap = by_force[2][a] * in.d_pressure;
      for (std::size_t j = 0; j < 2; ++j) {
        by_gap += r.slope(Slope::increment, j)[a] * whole[j] * share.d[0];
        r.slope(Slope::increment, j)[a] *= share.v;
      }
    }
  }
  return r;
}

}  // namespace anisocontact::kernel
