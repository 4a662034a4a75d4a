#pragma once
// One slave point against an analytic surface: projection -> kinematics -> law -> traction on the
// slave and its exact derivative with respect to the position of the slave.

#include "anisocontact/kernel/interface.hpp"
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

/// Pure update of one point; with S = Dual<3> the tangent comes along.
template <class S>
PointResult update(const Interface& itf, const PointState& state, const Vec3<double>& x,
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
      react(itf.law, state, k, [&](const auto& field) { return axes_of(field, k.now, k.xi); });
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
