#pragma once
// One slave point against an analytic surface: projection -> kinematics -> law -> traction on the
// slave and its exact derivative with respect to the position of the slave.
//
// With transported history the law is solved in a frame of the tangent plane and differentiated by
// the chain rule; the forms that keep components in the basis of the surface take dual numbers.

#include "anisocontact/kernel/forms.hpp"
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
  std::array<Eigen::Matrix3d, 2> d_slave_tangents{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};
  Vec3<double> normal{Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> adhesion_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> friction_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  PointState state{};
  Failure failure{Failure::none};
};

/// The slave position in the scalar type of the update, seeded where derivatives are wanted.
template <class S>
Vec3<S> seeded(const Vec3<double>& x) {
  if constexpr (std::is_same_v<S, double>)
    return x;
  else
    return {S::variable(x[0], 0), S::variable(x[1], 1), S::variable(x[2], 2)};
}

/// xi^3 at a foot from r = x - rho. Beyond an edge there is no surface for the point to meet,
/// whatever side of the tangent plane it is on: its distance, which is positive.
template <class S>
S contact_gap(const projection::Projection& p, const Vec3<S>& r, const Vec3<S>& normal) {
  using std::sqrt;
  const bool beyond =
      p.status == projection::Status::edge || p.status == projection::Status::corner;
  return beyond ? sqrt(r.dot(r)) : r.dot(normal);
}

/// Kinematics of a projected point.
template <class S>
Kinematics<S> kinematics(const surface::AnySurface& surface, const PointState& state,
                         const projection::Projection& p, const Vec3<S>& x, double dt) {
  Kinematics<S> k;
  const auto here = surface::geometry(surface::jet(surface, p.xi[0], p.xi[1]));
  if constexpr (std::is_same_v<S, double>) {
    k.xi = {p.xi};
    k.now = here;
  } else {
    k.xi = projection::linearised(here, p, x);
    k.now = surface::geometry(surface::jet(surface, k.xi[0], k.xi[1]));
  }
  k.before = surface::constant_geometry<S>(
      surface::geometry(surface::jet(surface, state.xi[0], state.xi[1])));
  k.domain = surface::domain(surface);
  k.gap = contact_gap<S>(p, x - k.now.jet.position, k.now.normal) - S(state.offset);
  k.dt = dt;
  return k;
}

/// Update in the basis of the surface, for every form of the evolution; with S = Dual<3> the tangent
/// comes along. All directions are those of the master.
template <class S>
PointResult update_in_basis(const Interface& itf, const PointState& state, const Vec3<double>& x,
                            double dt) noexcept {
  PointResult out;
  out.state = state;
  const auto p = projection::closest_point(itf.surface, x, &state.xi);
  if (p.status == projection::Status::failed) {
    out.failure = Failure::projection;
    return out;
  }
  const auto k = kinematics<S>(itf.surface, state, p, seeded<S>(x), dt);
  out.normal = value(k.now.normal);
  const auto r =
      react(itf.law, state, k, [&](const Directions& d) { return axes_of(d.field, k.now, k.xi); });
  out.failure = r.failure;
  if (r.failure != Failure::none) return out;
  out.state = r.state;
  for (std::size_t i = 0; i < 2; ++i) {
    out.adhesion_axes[i] = value(r.adhesion_axes.e[i]);
    out.friction_axes[i] = value(r.friction_axes.e[i]);
  }
  const Vec3<S> t = r.pressure * k.now.normal + k.now.spatial(r.traction);
  out.traction = value(t);
  if constexpr (!std::is_same_v<S, double>)
    for (Eigen::Index i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) out.tangent(i, static_cast<Eigen::Index>(j)) = t[i].d[j];
  return out;
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
  Vec3<double> d = f.by[index(Input::slave)];
  for (std::size_t j = 0; j < 2; ++j)
    d += (f.xi[j] - here.h_mixed(0, j) * turn[0] - here.h_mixed(1, j) * turn[1]) * dxi[j];
  return d;
}

}  // namespace detail

/// Update with the history transported, in a frame of the tangent plane. `own` is the slave at the
/// point; without it, all directions are those of the master.
template <bool tangent>
PointResult update_in_plane(const Interface& itf, const PointState& state, const Vec3<double>& x,
                            const Carrier* own, double dt) noexcept {
  PointResult out;
  out.state = state;
  const auto foot = projection::closest_point(itf.surface, x, &state.xi);
  const auto fail = [&](Failure why) {
    out.failure = why;
    return out;
  };
  if (foot.status == projection::Status::failed) return fail(Failure::projection);
  const auto here = surface::curved_plane(surface::jet(itf.surface, foot.xi[0], foot.xi[1]));
  ContactPlane plane{{}, here.normal, here.jet.d1, x - here.jet.position};
  const double gap = contact_gap<double>(foot, plane.apart, plane.n) - state.offset;
  out.normal = plane.n;
  const Dual<1> pressure = detail::pressure_of(itf.law, state, gap, dt);
  if (!(pressure.v > 0.0)) {
    out.state = lasting(state);
    out.state.xi = out.state.origin = foot.xi;
    out.state.gap = gap;
    return out;
  }
  PlaneAxis start;
  if (!detail::put_axis<Dual<2>>(here.jet, plane.n, {{Dual<2>(1.0), Dual<2>(0.0)}}, start))
    return fail(Failure::direction);
  plane.t = {start.e, plane.n.cross(start.e)};
  const auto axes_at = [&](const Directions& d) {
    return detail::axes_at<tangent>(d, here, foot.xi, own, start);
  };
  const LawAxes axes = law_axes(itf.law, axes_at);
  if (!axes.valid()) return fail(Failure::direction);
  const auto before = surface::tangent_plane(surface::jet(itf.surface, state.xi[0], state.xi[1]));
  const CommittedPoint committed(plane, before, here.jet.position, state, own,
                                 looks_back(itf.law.evolution));
  const FrameInput in = frame_input(itf.law, gap, dt, pressure, &committed, axes, plane);
  const FrameReaction r = react_in_frame<tangent>(itf.law, state, in);
  if (r.failure != Failure::none) return fail(r.failure);
  put_axes(axes, out.adhesion_axes, out.friction_axes);
  out.state = in_basis(r, state, foot.xi, plane, here, &committed, companions(itf.law, own, axes));
  out.traction = pressure.v * plane.n + plane.spatial(r.traction);
  if constexpr (tangent) {
    std::array<Form, 2> friction;
    put_friction_forms(itf.law, r, axes, plane, &committed, friction);
    const auto forms = traction_forms(friction, r, in, plane);
    const auto dxi = projection::coordinate_gradient(here, foot, x);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<double>& direction = i < 2 ? plane.t[i] : plane.n;
      out.tangent += direction * detail::expanded(forms[i], plane, here, dxi).transpose();
      for (std::size_t j = 0; j < 2; ++j)
        out.d_slave_tangents[j] += direction * forms[i].by[slave_input(j)].transpose();
    }
  }
  return out;
}

/// Pure update of one point.
template <bool tangent>
PointResult update(const Interface& itf, const PointState& state, const Vec3<double>& x,
                   const Carrier* own, double dt) noexcept {
  if (in_vectors(itf.law.evolution)) return update_in_plane<tangent>(itf, state, x, own, dt);
  return update_in_basis<std::conditional_t<tangent, Dual<3>, double>>(itf, state, x, dt);
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
  s.gap = contact_gap<double>(p, x - g.jet.position, g.normal);
  return s;
}

}  // namespace anisocontact::kernel
