#pragma once
// One slave point against an analytic surface: projection -> kinematics -> law -> traction on the
// slave and its exact derivative with respect to the position of the slave.
//
// The law is solved in a frame of the tangent plane and differentiated by the chain rule.

#include "anisocontact/kernel/advance.hpp"
#include "anisocontact/kernel/coordinate_history.hpp"
#include "anisocontact/projection/closest_point.hpp"
#include "anisocontact/projection/linearisation.hpp"

namespace anisocontact::kernel {

/// Surface and law of an interface.
struct Interface {
  surface::AnySurface surface;
  InterfaceLaw law;
};

/// Result at a point; vectors in global components.
struct PointResult {
  Vec3<double> traction{Vec3<double>::Zero()};       ///< t = N n + T on the slave
  Eigen::Matrix3d tangent{Eigen::Matrix3d::Zero()};  ///< dt/dx
  Eigen::Matrix3d by_slip{Eigen::Matrix3d::Zero()};  ///< of the traction, see `slip_slopes`
  std::array<Eigen::Matrix3d, 2> d_slave_tangents{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};
  Vec3<double> normal{Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> adhesion_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> friction_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  PointState state{};
  Failure failure{Failure::none};
};

/// xi^3 at a foot from r = x - rho. Beyond an edge there is no surface for the point to meet,
/// whatever side of the tangent plane it is on: its distance, which is positive.
inline double contact_gap(const projection::Projection& p, const Vec3<double>& r,
                          const Vec3<double>& normal) {
  const bool beyond =
      p.status == projection::Status::edge || p.status == projection::Status::corner;
  return beyond ? std::sqrt(r.dot(r)) : r.dot(normal);
}

namespace detail {

/// Axes of a field of an analytic surface, and how they turn along its coordinates.
template <bool tangent>
PlaneAxes surface_axes(const anisotropy::AnyField& field, const surface::Geometry<double>& here,
                       const std::array<double, 2>& xi) {
  using S = std::conditional_t<tangent, Dual<2>, double>;
  const auto g = surface::tangent_plane(beside<S>(here.jet));
  const auto axes = anisotropy::axes(field, g, beside<S>(xi));
  PlaneAxes r;
  r.valid = axes.valid;
  for (std::size_t k = 0; k < 2; ++k) {
    r.axis[k].e = value(axes.e[k]);
    r.axis[k].mu = here.normal.cross(r.axis[k].e);
    if constexpr (tangent)
      for (std::size_t j = 0; j < 2; ++j)
        for (Eigen::Index i = 0; i < 3; ++i)
          r.axis[k].by_xi[j] += r.axis[k].mu[i] * axes.e[k][i].d[j];
  }
  return r;
}

/// Axes at a point of an analytic surface, or of the slave there.
template <bool tangent>
PlaneAxes axes_at(const Directions& d, const surface::Geometry<double>& here,
                  const std::array<double, 2>& xi, const Carrier* own, const PlaneAxis& start) {
  if (!d.field) return with_normal(start, here.normal);
  if (d.side == Side::master || own == nullptr) return surface_axes<tangent>(*d.field, here, xi);
  const ReferencePlane<double> reference(*own, orientation(*own, here.normal));
  return carried(*d.field, reference, here.normal, Side::slave);
}

/// Replaces what follows from the position of the slave on a surface at rest.
inline Vec3<double> expanded(const Form& f, const ContactPlane& p,
                             const surface::Geometry<double>& here,
                             const std::array<Vec3<double>, 2>& dxi) {
  const Covector<double> turn = here.project_co(p.spatial(f.turn));
  Vec3<double> d = f.by[index(Input::slave)].vector();
  for (std::size_t j = 0; j < 2; ++j)
    d += (f.xi[j] - here.h_mixed(0, j) * turn[0] - here.h_mixed(1, j) * turn[1]) * dxi[j];
  return d;
}

/// Writes dt/dx, and dt by the tangents of the slave.
inline void put_tangent(const std::array<Form, 3>& forms, const ContactPlane& plane,
                        const surface::Geometry<double>& here,
                        const std::array<Vec3<double>, 2>& dxi, PointResult& out) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3<double>& direction = i < 2 ? plane.t[i] : plane.n;
    out.tangent += direction * expanded(forms[i], plane, here, dxi).transpose();
    for (std::size_t j = 0; j < 2; ++j)
      out.d_slave_tangents[j] += direction * forms[i].by[slave_input(j)].vector().transpose();
  }
}

}  // namespace detail

/// Pure update of one point; `reacts` is the tangential law of the interface. `own` is the slave at
/// the point; without it, all directions are those of the master.
template <bool tangent>
PointResult update(const Interface& itf, const Law& reacts, const PointState& state,
                   const Vec3<double>& x, const Carrier* own, double dt) noexcept {
  PointResult out;
  out.state = state;
  const auto foot = projection::closest_point(itf.surface, x, &state.xi);
  const auto fail = [&](Failure why) {
    out.failure = why;
    out.state = state;
    return out;
  };
  if (foot.status == projection::Status::failed) return fail(Failure::projection);
  const auto here = surface::curved_plane(surface::jet(itf.surface, foot.xi[0], foot.xi[1]));
  ContactPlane plane{{}, here.normal, here.jet.d1, x - here.jet.position};
  const double gap = contact_gap(foot, plane.apart, plane.n) - state.offset;
  out.normal = plane.n;
  out.state = opened(state, foot.xi, gap, -1);
  const Dual<1> pressure = pressure_of(itf.law, state, gap, dt);
  if (!(pressure.v > 0.0)) return out;
  PlaneAxis start;
  if (!detail::put_axis<Dual<2>>(here.jet, plane.n, {{Dual<2>(1.0), Dual<2>(0.0)}}, start))
    return fail(Failure::direction);
  plane.t = {start.e, plane.n.cross(start.e)};
  const bool vectors = in_vectors(itf.law.evolution);
  if (!vectors) own = nullptr;
  const LawAxes axes = law_axes(itf.law, [&](const Directions& d) {
    return detail::axes_at<tangent>(d, here, foot.xi, own, start);
  });
  if (!axes.valid()) return fail(Failure::direction);
  std::optional<CommittedPoint> turned;
  std::optional<CoordinateHistory> kept;
  if (vectors)
    turned.emplace(plane,
                   surface::tangent_plane(surface::jet(itf.surface, state.xi[0], state.xi[1])),
                   here.jet.position, state, own, looks_back(itf.law.evolution));
  else
    kept.emplace(itf.law.evolution, itf.surface, state, foot.xi, gap, plane);
  const CommittedPoint* committed = turned ? &*turned : nullptr;
  ContactFrame in = contact_frame(itf.law, state, gap, dt, pressure, committed, axes, plane);
  if (kept) kept->put(in);
  const Reaction r = reacts.evaluate(state, in, tangent);
  if (r.failure != Failure::none) return fail(r.failure);
  put_axes(axes, out.adhesion_axes, out.friction_axes);
  advance(itf.law, state, in, r,
          {plane, here, committed, own, vectors ? moving_axes(itf.law, axes) : nullptr}, out.state);
  out.traction = pressure.v * plane.n + plane.spatial(r.traction);
  if constexpr (tangent) {
    std::array<Form, 2> friction;
    put_friction_forms(itf.law, r, axes, plane, committed, friction);
    if (kept) kept->add(r, plane, friction);
    detail::put_tangent(traction_forms(friction, r, in, plane), plane, here,
                        projection::coordinate_gradient(here, foot, x), out);
    out.by_slip = slip_slopes(r, out.tangent * plane.n, plane);
  }
  return out;
}

/// State of a point before the first step: projected, without force (101).
inline PointState initial_state(const surface::AnySurface& surface, const Vec3<double>& x,
                                Failure& failure) noexcept {
  PointState s;
  const auto p = projection::closest_point(surface, x);
  if (p.status == projection::Status::failed) {
    failure = Failure::projection;
    return s;
  }
  const auto g = surface::geometry(surface::jet(surface, p.xi[0], p.xi[1]));
  s.xi = s.origin = p.xi;
  s.gap = contact_gap(p, x - g.jet.position, g.normal);
  return s;
}

}  // namespace anisocontact::kernel
