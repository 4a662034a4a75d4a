#pragma once
// Tangential laws that are not in the core, at slave points that meet facets. They are asked in two
// steps: what such a law sees is told for all points, in its axes e_1, e_2 = n x e_1; what it has
// answered then stands where the laws of the core would react, so that forces and tangent come from
// it as from them.

#include "anisocontact/kernel/facet_pair.hpp"

namespace anisocontact::kernel {

/// What a law sees of a point, in its axes; nothing where the point does not touch.
struct Told {
  double gap{0.0}, pressure{0.0};
  Flat increment{}, stored{}, elastic{};
};

/// What a law has answered, in its axes. Derivatives are rows: d T_1, then d T_2.
struct Answered {
  Flat traction, stored, slip;
  std::array<Flat, 2> by_increment, by_stored, by_elastic;
  Flat by_pressure;
  double dissipation, energy;
};

namespace detail {

inline Flat times(const std::array<Flat, 2>& m, const Flat& v) {
  return {m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]};
}
inline Flat plus(const Flat& a, const Flat& b) { return {a[0] + b[0], a[1] + b[1]}; }
inline Flat scaled(double k, const Flat& v) { return {k * v[0], k * v[1]}; }
/// A quarter of a turn about n.
inline Flat quarter(const Flat& v) { return {-v[1], v[0]}; }

/// The axes of a law in the contact plane: the first one of the friction axes, and n x e_1; -n x e_1
/// where slave and master have swapped their parts, so that a law sees both sides the same way.
struct FramedAxes {
  Flat e;
  double side;

  FramedAxes(const FrameInput& in, bool mirrored)
      : e(in.friction_axes[0]), side(mirrored ? -1.0 : 1.0) {}
  Flat in_axes(const Flat& v) const {
    return {e[0] * v[0] + e[1] * v[1], side * (e[0] * v[1] - e[1] * v[0])};
  }
  Flat in_plane(const Flat& v) const {
    const double second = side * v[1];
    return {e[0] * v[0] - e[1] * second, e[1] * v[0] + e[0] * second};
  }
};

/// The part of a step that a point spent in contact, by the gap.
inline Dual<1> part_in_contact(const PointState& state, double gap) {
  return remembers(state) ? Dual<1>(1.0) : contact_fraction(state, Dual<1>::variable(gap, 0));
}

inline Told told(const PointState& state, const FrameInput& in, const FramedAxes& axes) {
  const double part = part_in_contact(state, in.gap).v;
  return {in.gap, in.pressure, axes.in_axes(scaled(part, in.increment)), axes.in_axes(in.stored),
          axes.in_axes(in.elastic)};
}

/// Trial state with vectors by their components in the contact plane.
inline PointState answered_state(const law::NormalModel& normal, const PointState& old,
                                 const FrameInput& in, const FramedAxes& axes, const Told& seen,
                                 const Answered& a) {
  PointState s = lasting(old);
  s.traction = axes.in_plane(a.traction);
  s.stored = axes.in_plane(a.stored);
  s.slip = axes.in_plane(a.slip);
  s.elastic = axes.in_plane(plus(plus(seen.elastic, seen.increment), scaled(-1.0, a.slip)));
  s.gap = in.gap;
  s.pressure = in.pressure;
  s.slip_accumulated += std::hypot(a.slip[0], a.slip[1]);
  s.dissipation += a.dissipation;
  s.energy_adhesion = a.energy;
  const auto e = normal_energies(normal, old, s.gap, s.pressure, in.dt);
  s.energy_normal = e.elastic;
  s.dissipation_viscous += e.viscous;
  s.status = static_cast<std::int64_t>(a.slip == Flat{} ? Contact::stick : Contact::slip);
  return s;
}

/// Slopes in the contact plane from those in the axes of the law, which turn by an angle of their
/// own: vectors then change in the axes by minus a quarter of a turn, the force in the plane by one.
inline void put_answered_slopes(const PointState& state, const FrameInput& in,
                                const FramedAxes& axes, const Told& seen, const Answered& a,
                                FrameReaction& r) {
  const auto put = [&](Slope s, const std::array<Flat, 2>& by) {
    for (std::size_t j = 0; j < 2; ++j)
      r.slope(s, j) =
          axes.in_plane(times(by, axes.in_axes({j == 0 ? 1.0 : 0.0, j == 0 ? 0.0 : 1.0})));
  };
  put(Slope::increment, a.by_increment);
  put(Slope::stored, a.by_stored);
  put(Slope::elastic, a.by_elastic);
  const Flat turned = plus(
      times(a.by_increment, quarter(seen.increment)),
      plus(times(a.by_stored, quarter(seen.stored)), times(a.by_elastic, quarter(seen.elastic))));
  r.slope(Slope::friction, 0) =
      plus(quarter(axes.in_plane(a.traction)), axes.in_plane(scaled(-axes.side, turned)));
  const Dual<1> part = part_in_contact(state, in.gap);
  Flat& by_gap = r.slope(Slope::gap, 0);
  by_gap = scaled(in.d_pressure, axes.in_plane(a.by_pressure));
  for (std::size_t j = 0; j < 2; ++j) {
    Flat& by = r.slope(Slope::increment, j);
    by_gap = plus(by_gap, scaled(in.increment[j] * part.d[0], by));
    by = scaled(part.v, by);
  }
}

}  // namespace detail

/// Writes down what a law sees, and answers nothing.
struct TellingReaction {
  Told* to;
  bool mirrored;

  template <bool tangent>
  FrameReaction at(const InterfaceLaw&, const PointState& state,
                   const FrameInput& in) const noexcept {
    *to = detail::told(state, in, detail::FramedAxes(in, mirrored));
    return {};
  }
};

/// Says what a law has answered.
struct AnsweredReaction {
  const Answered& answer;
  bool mirrored;

  template <bool tangent>
  FrameReaction at(const InterfaceLaw& law, const PointState& state,
                   const FrameInput& in) const noexcept {
    const detail::FramedAxes axes(in, mirrored);
    const Told seen = detail::told(state, in, axes);
    FrameReaction r;
    r.traction = axes.in_plane(answer.traction);
    r.increment = axes.in_plane(seen.increment);
    r.state = detail::answered_state(law::normal_model(law.normal), state, in, axes, seen, answer);
    if constexpr (tangent) detail::put_answered_slopes(state, in, axes, seen, answer, r);
    return r;
  }
};

}  // namespace anisocontact::kernel
