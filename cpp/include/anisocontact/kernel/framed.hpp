#pragma once
// Kinematics of a point in an orthonormal frame of the tangent plane, for laws that are not in the
// core: values and exact derivatives with respect to the position of the slave; of the slip also
// with respect to the tangents of the slave, whose turn it follows.

#include "anisocontact/kernel/point.hpp"

namespace anisocontact::kernel {

/// Frame e_1, e_2, n and what a law needs in it; every quantity carries d/dx.
struct Framed {
  std::array<Vec3<Dual<3>>, 3> frame;
  std::array<Dual<3>, 2> increment{};  ///< slip increment
  std::array<Dual<6>, 2> by_slave{};   ///< the same by the tangents of the slave, if it is known
  std::array<Dual<3>, 2> stored{};     ///< committed elastic force, turned to here
  std::array<Dual<3>, 2> elastic{};    ///< committed elastic slip, turned to here
  Dual<3> gap{0.0};
  Dual<3> pressure{0.0};
  Vector<double> xi{};
  double spin{0.0};  ///< turn of the slave
  double turn{0.0};  ///< the largest angle by which normal or slave have turned
  std::array<Vec3<double>, 2> own{Vec3<double>::Zero(), Vec3<double>::Zero()};  ///< its tangents
  Failure failure{Failure::none};
};

namespace detail {

/// History and slip of `transport`.
template <class S>
Transported<S> slip_step(const PointState& state, const Kinematics<S>& k) {
  return history<S>(AnyEvolution{Transport{}}, state, k, {});
}

/// The slip increment by the tangents of the slave, all else at rest.
inline std::array<Dual<6>, 2> slip_by_slave(const surface::AnySurface& surface,
                                            const PointState& state,
                                            const projection::Projection& p, const Vec3<double>& x,
                                            const Framed& f, double dt) {
  using S = Dual<6>;
  auto k = kinematics<S>(surface, state, p, constant<S>(x), dt);
  for (std::size_t i = 0; i < 6; ++i)
    k.own[i / 3][static_cast<Eigen::Index>(i % 3)] =
        S::variable(f.own[i / 3][static_cast<Eigen::Index>(i % 3)], i);
  const Vec3<S> slip = k.now.spatial(slip_step(state, k).increment);
  return {slip.dot(constant<S>(value(f.frame[0]))), slip.dot(constant<S>(value(f.frame[1])))};
}

/// Turns of the slave and of the normal since the committed state.
inline void put_turns(const PointState& state, const Kinematics<Dual<3>>& k, Framed& f) {
  f.spin = value(relative_spin(state, k));
  const Vec3<double> change = value(k.now.normal) - value(k.before.normal);
  f.turn = std::max(2.0 * std::asin(std::min(0.5 * change.norm(), 1.0)), std::abs(f.spin));
}

}  // namespace detail

/// Projection, pressure and transported history of one point. `own` is the slave there; without it
/// the slip does not turn with the slave.
inline Framed framed(const surface::AnySurface& surface, const law::NormalModel& normal,
                     const std::optional<anisotropy::AnyField>& directions,
                     const PointState& committed, const Vec3<double>& x, const Carrier* own,
                     double dt) noexcept {
  using S = Dual<3>;
  Framed out;
  PointState state = committed;
  if (own == nullptr) state.slave = {};
  const auto p = projection::closest_point(surface, x, &state.xi);
  if (p.status == projection::Status::failed) {
    out.failure = Failure::projection;
    return out;
  }
  auto k = kinematics<S>(surface, state, p, seeded<S>(x), dt);
  if (own != nullptr) {
    out.own = own->now.d1;
    k.own = {constant<S>(out.own[0]), constant<S>(out.own[1])};
  }
  const auto axes = axes_of(directions, k.now, k.xi);
  if (!axes.valid) {
    out.failure = Failure::direction;
    return out;
  }
  out.frame = {axes.e[0], k.now.normal.cross(axes.e[0]), k.now.normal};
  const auto t = detail::slip_step(state, k);
  const Vec3<S> increment = k.now.spatial(t.increment), stored = k.now.spatial(t.stored),
                elastic = k.now.spatial(t.elastic);
  for (std::size_t i = 0; i < 2; ++i) {
    out.increment[i] = increment.dot(out.frame[i]);
    out.stored[i] = stored.dot(out.frame[i]);
    out.elastic[i] = elastic.dot(out.frame[i]);
  }
  out.gap = k.gap;
  out.pressure = normal_pressure(normal, state, k.gap, dt);
  out.xi = value(k.xi);
  if (has_pair(state.slave)) out.by_slave = detail::slip_by_slave(surface, state, p, x, out, dt);
  if (remembers(state)) detail::put_turns(state, k, out);
  return out;
}

/// Committed state from what a law returned in the frame.
struct FramedResult {
  std::array<double, 2> traction, stored, slip;
  double dissipation, energy;
  Contact status;
};

inline PointState commit(const law::NormalModel& normal, const PointState& old, const Framed& f,
                         const surface::Geometry<double>& g, const FramedResult& r, double dt) {
  PointState s = lasting(old);
  s.xi = f.xi.c;
  s.gap = f.gap.v;
  s.origin = s.xi;
  if (r.status == Contact::open) return s;
  const auto spatial = [&](const std::array<double, 2>& u) -> Vec3<double> {
    return u[0] * value(f.frame[0]) + u[1] * value(f.frame[1]);
  };
  const bool begins = old.status == static_cast<std::int64_t>(Contact::open);
  const Vector<double> increment = g.project_contra(spatial({f.increment[0].v, f.increment[1].v}));
  s.origin = begins ? (Vector<double>{s.xi} - increment).c : old.origin;
  s.traction = g.project_co(spatial(r.traction)).c;
  s.stored = g.project_co(spatial(r.stored)).c;
  s.slip = g.project_contra(spatial(r.slip)).c;
  const std::array<double, 2> elastic{f.elastic[0].v + f.increment[0].v - r.slip[0],
                                      f.elastic[1].v + f.increment[1].v - r.slip[1]};
  s.elastic = g.project_contra(spatial(elastic)).c;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto kept = g.project_contra(f.own[i]);
    s.slave[2 * i] = kept[0];
    s.slave[2 * i + 1] = kept[1];
  }
  s.spin = f.spin;
  s.turn = f.turn;
  s.pressure = f.pressure.v;
  s.slip_accumulated += std::hypot(r.slip[0], r.slip[1]);
  s.dissipation += r.dissipation;
  s.energy_adhesion = r.energy;
  const auto e = normal_energies(normal, old, s.gap, s.pressure, dt);
  s.energy_normal = e.elastic;
  s.dissipation_viscous += e.viscous;
  s.status = static_cast<std::int64_t>(r.status);
  return s;
}

}  // namespace anisocontact::kernel
