#pragma once
// One slave point against a facet of a deforming master: kinematics -> law -> traction, and its
// exact derivatives with respect to everything that moves.
//
// The facet enters through its position and first derivatives at fixed coordinates, rho, rho_1,
// rho_2, which are linear in its nodes; so do the committed point of the master and the tangents of
// the slave. The coordinates of the projection follow from these by the implicit function theorem.

#include "anisocontact/kernel/interface.hpp"

namespace anisocontact::kernel {

/// What a traction depends on, in groups of three components: the slave point, the facet now, and
/// the facet on which the history was committed.
enum class Input : std::size_t {
  slave = 0,
  position = 1,
  tangent_1 = 2,
  tangent_2 = 3,
  before_position = 4,
  before_tangent_1 = 5,
  before_tangent_2 = 6
};
inline constexpr std::size_t pair_inputs = 21;
using PairDual = Dual<pair_inputs>;

/// What the projection hit. On an edge the tangent plane is that of x - rho; its first direction is
/// along the edge.
enum class Feature : std::int64_t { interior = 0, edge = 1, vertex = 2, off = 3 };

/// Where a slave point is: jets of the facets in plain numbers.
struct PairPoint {
  Vec3<double> slave{Vec3<double>::Zero()};
  surface::Jet<double> now{};        ///< of the facet at the projection
  surface::Jet<double> before{};     ///< of the committed facet at the committed coordinates
  surface::Jet<double> reference{};  ///< of the facet at the projection, reference configuration
  std::array<double, 2> xi{};
  std::int64_t facet{-1};
  Feature feature{Feature::off};
  std::array<double, 2> edge{};  ///< direction of the edge in coordinates
  bool mirrored{false};          ///< whether directions turn about the inward normal
};

struct PairResult {
  Vec3<double> traction{Vec3<double>::Zero()};  ///< on the slave
  Eigen::Matrix<double, 3, pair_inputs> d_traction{Eigen::Matrix<double, 3, pair_inputs>::Zero()};
  Eigen::Matrix<double, 2, pair_inputs> d_xi{Eigen::Matrix<double, 2, pair_inputs>::Zero()};
  Vec3<double> normal{Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> adhesion_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> friction_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  PointState state{};
  Failure failure{Failure::none};
};

namespace detail {

inline Vec3<PairDual> seed(const Vec3<double>& v, Input group) {
  const std::size_t first = 3 * static_cast<std::size_t>(group);
  return {PairDual::variable(v[0], first), PairDual::variable(v[1], first + 1),
          PairDual::variable(v[2], first + 2)};
}

/// The facet with coordinates that follow the projection: rho_i and rho move with xi as well.
inline surface::Jet<PairDual> moving(const surface::Jet<double>& j, const Vec3<PairDual>& r,
                                     const std::array<Vec3<PairDual>, 2>& ri,
                                     const std::array<PairDual, 2>& dxi) {
  surface::Jet<PairDual> out;
  out.position = r + dxi[0] * constant<PairDual>(j.d1[0]) + dxi[1] * constant<PairDual>(j.d1[1]);
  for (std::size_t i = 0; i < 2; ++i)
    out.d1[i] = ri[i] + dxi[0] * constant<PairDual>(j.second(i, 0)) +
                dxi[1] * constant<PairDual>(j.second(i, 1));
  for (std::size_t i = 0; i < 3; ++i) out.d2[i] = constant<PairDual>(j.d2[i]);
  return out;
}

/// d xi of an interior projection: (a_ij - g h_ij) dxi^j = (dx - drho) . rho_i + g n . drho_i.
inline std::array<PairDual, 2> interior_shift(const PairPoint& p, const Vec3<PairDual>& x,
                                              const Vec3<PairDual>& r,
                                              const std::array<Vec3<PairDual>, 2>& ri) {
  const auto g = surface::geometry(p.now);
  const Vec3<PairDual> apart = x - r;
  const double gap = value(apart).dot(g.normal);
  const ContraContra<double> inv = inverse(g.a_co - gap * g.h_co);
  std::array<PairDual, 2> dxi;
  // the value of apart . rho_i is zero up to the tolerance of the projection: derivatives alone
  for (std::size_t i = 0; i < 2; ++i) {
    const PairDual f0 = apart.dot(ri[0]), f1 = apart.dot(ri[1]);
    dxi[i] =
        PairDual(inv(i, 0)) * (f0 - PairDual(f0.v)) + PairDual(inv(i, 1)) * (f1 - PairDual(f1.v));
  }
  return dxi;
}

/// d xi along an edge of direction e: one equation, (x - rho) . rho_,e = 0.
inline std::array<PairDual, 2> edge_shift(const PairPoint& p, const Vec3<PairDual>& x,
                                          const Vec3<PairDual>& r,
                                          const std::array<Vec3<PairDual>, 2>& ri) {
  const auto& e = p.edge;
  const Vec3<PairDual> re = PairDual(e[0]) * ri[0] + PairDual(e[1]) * ri[1];
  const Vec3<double> ree = e[0] * e[0] * p.now.second(0, 0) +
                           2.0 * e[0] * e[1] * p.now.second(0, 1) +
                           e[1] * e[1] * p.now.second(1, 1);
  const Vec3<PairDual> apart = x - r;
  const PairDual f = apart.dot(re);
  const double slope = value(re).squaredNorm() - value(apart).dot(ree);
  const PairDual s = PairDual(1.0 / slope) * (f - PairDual(f.v));
  return {PairDual(e[0]) * s, PairDual(e[1]) * s};
}

/// Geometry where the projection is on an edge or a vertex: n along x - rho, the first direction
/// along the edge.
inline surface::Geometry<PairDual> ridge_geometry(const PairPoint& p,
                                                  const surface::Jet<PairDual>& j,
                                                  const Vec3<PairDual>& x) {
  const Vec3<PairDual> apart = x - j.position;
  const auto outward = surface::tangent_plane(p.now).normal;
  const PairDual length = sqrt(apart.dot(apart));
  const double sign = value(apart).dot(outward) < 0.0 ? -1.0 : 1.0;
  const Vec3<PairDual> n = (PairDual(sign) / length) * apart;
  const Vec3<PairDual> along =
      p.feature == Feature::edge
          ? Vec3<PairDual>(PairDual(p.edge[0]) * j.d1[0] + PairDual(p.edge[1]) * j.d1[1])
          : j.d1[0];
  const Vec3<PairDual> t = along - along.dot(n) * n;
  surface::Jet<PairDual> ridge = j;
  ridge.d1 = {t, n.cross(t)};
  for (auto& second : ridge.d2) second = constant<PairDual>(Vec3<double>::Zero());
  return surface::tangent_plane(ridge);
}

/// Axes of a field given in the reference configuration and carried by the material: components in
/// the reference basis are kept, lengths normalised [Konyukhov Schweizerhof 2006, eq. (47)].
inline anisotropy::Axes<PairDual> carried(const std::optional<anisotropy::AnyField>& field,
                                          const PairPoint& p, const std::array<PairDual, 2>& dxi,
                                          const surface::Jet<PairDual>& now,
                                          const surface::Geometry<PairDual>& g) {
  if (!field) return anisotropy::axes_from(g, g.jet.d1[0], anisotropy::Turn{});
  const surface::Jet<double>& ref = p.reference;
  auto reference = surface::tangent_plane(
      moving(ref, constant<PairDual>(ref.position),
             {constant<PairDual>(ref.d1[0]), constant<PairDual>(ref.d1[1])}, dxi));
  if (p.mirrored) reference.normal = -reference.normal;
  const Vector<PairDual> xi{{PairDual(p.xi[0]) + dxi[0], PairDual(p.xi[1]) + dxi[1]}};
  auto axes = anisotropy::axes(*field, reference, xi);
  if (!axes.valid) return axes;
  for (auto& e : axes.e) {
    const Vector<PairDual> c = reference.project_contra(e);
    const Vec3<PairDual> pushed = c[0] * now.d1[0] + c[1] * now.d1[1];
    const Vec3<PairDual> flat = pushed - pushed.dot(g.normal) * g.normal;
    e = (PairDual(1.0) / sqrt(flat.dot(flat))) * flat;
  }
  return axes;
}

}  // namespace detail

/// Pure update of one slave point against a facet, with all derivatives.
inline PairResult update_pair(const InterfaceLaw& law, const PointState& state, const PairPoint& p,
                              double dt) noexcept {
  using S = PairDual;
  PairResult out;
  if (p.feature == Feature::off) {
    out.state = lasting(state);
    return out;
  }
  const Vec3<S> x = detail::seed(p.slave, Input::slave),
                r = detail::seed(p.now.position, Input::position);
  const std::array<Vec3<S>, 2> ri{detail::seed(p.now.d1[0], Input::tangent_1),
                                  detail::seed(p.now.d1[1], Input::tangent_2)};
  std::array<S, 2> dxi{};
  if (p.feature == Feature::interior) dxi = detail::interior_shift(p, x, r, ri);
  if (p.feature == Feature::edge) dxi = detail::edge_shift(p, x, r, ri);
  const auto jet = detail::moving(p.now, r, ri, dxi);
  Kinematics<S> k;
  const auto facet = surface::tangent_plane(jet);
  k.now = p.feature == Feature::interior ? facet : detail::ridge_geometry(p, jet, x);
  k.xi = {{S(p.xi[0]) + dxi[0], S(p.xi[1]) + dxi[1]}};
  k.gap = (x - k.now.jet.position).dot(k.now.normal) - S(state.offset);
  k.dt = dt;
  if (state.facet < 0) {
    k.before = k.now;
  } else {
    surface::Jet<S> before;
    before.position = detail::seed(p.before.position, Input::before_position);
    before.d1 = {detail::seed(p.before.d1[0], Input::before_tangent_1),
                 detail::seed(p.before.d1[1], Input::before_tangent_2)};
    for (std::size_t i = 0; i < 3; ++i) before.d2[i] = constant<S>(p.before.d2[i]);
    k.before = surface::tangent_plane(before);
  }
  const auto reaction = react(
      law, state, k, [&](const auto& field) { return detail::carried(field, p, dxi, jet, k.now); });
  out.failure = reaction.failure;
  out.normal = value(k.now.normal);
  out.state = reaction.failure == Failure::none ? reaction.state : state;
  out.state.facet = p.facet;
  // the history is kept in the basis of the facet, also where the law saw that of a ridge
  if (p.feature != Feature::interior && reaction.failure == Failure::none) {
    const auto g = surface::value(k.now), f = surface::value(facet);
    const auto lower = [&](std::array<double, 2>& c) {
      c = f.project_co(g.spatial(Covector<double>{c})).c;
    };
    const auto upper = [&](std::array<double, 2>& c) {
      c = f.project_contra(g.spatial(Vector<double>{c})).c;
    };
    lower(out.state.traction), lower(out.state.stored);
    upper(out.state.elastic), upper(out.state.slip);
  }
  const Vec3<S> t = reaction.pressure * k.now.normal + k.now.spatial(reaction.traction);
  out.traction = value(t);
  for (std::size_t c = 0; c < pair_inputs; ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    for (std::size_t i = 0; i < 3; ++i)
      out.d_traction(static_cast<Eigen::Index>(i), column) = t[static_cast<Eigen::Index>(i)].d[c];
    for (std::size_t i = 0; i < 2; ++i)
      out.d_xi(static_cast<Eigen::Index>(i), column) = dxi[i].d[c];
  }
  for (std::size_t i = 0; i < 2; ++i) {
    out.adhesion_axes[i] = value(reaction.adhesion_axes.e[i]);
    out.friction_axes[i] = value(reaction.friction_axes.e[i]);
  }
  return out;
}

}  // namespace anisocontact::kernel
