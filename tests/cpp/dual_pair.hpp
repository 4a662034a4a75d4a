#pragma once
// The update of a slave point against a facet in dual numbers of everything that moves: slow, and
// written without the derivatives by hand of kernel/facet_pair.hpp, which it is there to check.

#include "anisocontact/kernel/facet_pair.hpp"
#include "dual_law.hpp"

namespace anisocontact::oracle {

using namespace kernel;

inline constexpr std::size_t variables = 3 * inputs;
using S = Dual<variables>;
using Vec = Vec3<S>;

/// Traction and coordinates with all derivatives, and the trial state.
struct Result {
  Vec traction;
  std::array<S, 2> xi;
  std::array<Vec, 2> couple;
  PointState state;
  Failure failure{Failure::none};
};

inline Vec seed(const Vec3<double>& v, std::size_t input) {
  return {S::variable(v[0], 3 * input), S::variable(v[1], 3 * input + 1),
          S::variable(v[2], 3 * input + 2)};
}

/// A jet that moves at fixed coordinates, and with the coordinates.
inline surface::Jet<S> moving(const surface::Jet<double>& j, const Vec& r,
                              const std::array<Vec, 2>& ri, const std::array<S, 2>& dxi) {
  surface::Jet<S> out;
  out.position = r + dxi[0] * constant<S>(j.d1[0]) + dxi[1] * constant<S>(j.d1[1]);
  for (std::size_t i = 0; i < 2; ++i)
    out.d1[i] = ri[i] + dxi[0] * constant<S>(j.second(i, 0)) + dxi[1] * constant<S>(j.second(i, 1));
  for (std::size_t i = 0; i < 3; ++i) out.d2[i] = constant<S>(j.d2[i]);
  return out;
}

inline surface::Jet<S> at_rest(const surface::Jet<double>& j, const std::array<S, 2>& dxi) {
  return moving(j, constant<S>(j.position), {constant<S>(j.d1[0]), constant<S>(j.d1[1])}, dxi);
}

/// d xi of an interior projection; the value of (x - rho) . rho_i is zero up to the tolerance of the
/// projection: derivatives alone.
inline std::array<S, 2> interior_shift(const PairPoint& p, const Vec& x, const Vec& r,
                                       const std::array<Vec, 2>& ri) {
  const auto g = surface::geometry(p.master.now);
  const Vec apart = x - r;
  const double gap = value(apart).dot(g.normal);
  const ContraContra<double> inv = inverse(g.a_co - gap * g.h_co);
  const S f0 = apart.dot(ri[0]), f1 = apart.dot(ri[1]);
  std::array<S, 2> dxi;
  for (std::size_t i = 0; i < 2; ++i)
    dxi[i] = S(inv(i, 0)) * (f0 - S(f0.v)) + S(inv(i, 1)) * (f1 - S(f1.v));
  return dxi;
}

/// d xi along an edge of direction e: one equation, (x - rho) . rho_,e = 0.
inline std::array<S, 2> edge_shift(const PairPoint& p, const Vec& x, const Vec& r,
                                   const std::array<Vec, 2>& ri) {
  const auto& e = p.edge;
  const auto& j = p.master.now;
  const Vec re = S(e[0]) * ri[0] + S(e[1]) * ri[1];
  const Vec3<double> ree = e[0] * e[0] * j.second(0, 0) + 2.0 * e[0] * e[1] * j.second(0, 1) +
                           e[1] * e[1] * j.second(1, 1);
  const Vec apart = x - r;
  const S f = apart.dot(re);
  const double slope = value(re).squaredNorm() - value(apart).dot(ree);
  const S s = S(1.0 / slope) * (f - S(f.v));
  return {S(e[0]) * s, S(e[1]) * s};
}

/// Geometry where the projection is on an edge or a vertex: n along x - rho, the first direction
/// along the edge.
inline surface::Geometry<S> ridge_geometry(const PairPoint& p, const surface::Jet<S>& j,
                                           const Vec& x) {
  const Vec apart = x - j.position;
  const auto outward = surface::tangent_plane(p.master.now).normal;
  const S length = sqrt(apart.dot(apart));
  const double sign = value(apart).dot(outward) < 0.0 ? -1.0 : 1.0;
  const Vec n = (S(sign) / length) * apart;
  const Vec along =
      p.feature == Feature::edge ? Vec(S(p.edge[0]) * j.d1[0] + S(p.edge[1]) * j.d1[1]) : j.d1[0];
  const Vec t = along - along.dot(n) * n;
  surface::Jet<S> ridge = j;
  ridge.d1 = {t, n.cross(t)};
  for (auto& second : ridge.d2) second = constant<S>(Vec3<double>::Zero());
  return surface::tangent_plane(ridge);
}

/// Axes of a field of the reference configuration, carried by a body whose jet is now `now`.
inline anisotropy::Axes<S> carried(const anisotropy::AnyField& field,
                                   surface::Geometry<S> reference, const Vector<S>& xi, double side,
                                   const surface::Jet<S>& now, const surface::Geometry<S>& g) {
  if (side < 0.0) reference.normal = -reference.normal;
  auto axes = anisotropy::axes(field, reference, xi);
  if (!axes.valid) return axes;
  for (auto& e : axes.e) {
    const Vector<S> c = reference.project_contra(e);
    const Vec pushed = c[0] * now.d1[0] + c[1] * now.d1[1];
    const Vec flat = pushed - pushed.dot(g.normal) * g.normal;
    e = (S(1.0) / sqrt(flat.dot(flat))) * flat;
  }
  return axes;
}

/// Kinematics of a point, with the jets that carry directions.
struct Seen {
  Motion<S> k;
  surface::Jet<S> master, own;
  surface::Geometry<S> facet;
  std::array<S, 2> dxi{};
};

inline Seen see(const PointState& state, const PairPoint& p, double dt) {
  Seen s;
  const auto& now = p.master.now;
  const Vec x = seed(p.slave, 0), r = seed(now.position, 1);
  const std::array<Vec, 2> ri{seed(now.d1[0], 2), seed(now.d1[1], 3)};
  if (p.feature == Feature::interior) s.dxi = interior_shift(p, x, r, ri);
  if (p.feature == Feature::edge) s.dxi = edge_shift(p, x, r, ri);
  s.master = moving(now, r, ri, s.dxi);
  s.facet = surface::tangent_plane(s.master);
  s.own = at_rest(p.own.now, {});
  s.own.d1 = {seed(p.own.now.d1[0], 7), seed(p.own.now.d1[1], 8)};
  s.k.now = p.feature == Feature::interior ? s.facet : ridge_geometry(p, s.master, x);
  s.k.xi = {{S(p.master.xi[0]) + s.dxi[0], S(p.master.xi[1]) + s.dxi[1]}};
  s.k.gap = (x - s.k.now.jet.position).dot(s.k.now.normal);
  s.k.dt = dt;
  s.k.own = s.own.d1;
  s.k.before = s.k.now;
  if (state.facet >= 0) {
    surface::Jet<S> before = at_rest(p.before, {});
    before.position = seed(p.before.position, 4);
    before.d1 = {seed(p.before.d1[0], 5), seed(p.before.d1[1], 6)};
    s.k.before = surface::tangent_plane(before);
  }
  return s;
}

inline anisotropy::Axes<S> axes_at(const Directions& d, const PairPoint& p, const Seen& s) {
  const auto& g = s.k.now;
  if (!d.field) return anisotropy::axes_from(g, g.jet.d1[0], anisotropy::Turn{});
  if (d.side == Side::master)
    return carried(*d.field, surface::tangent_plane(at_rest(p.master.reference, s.dxi)), s.k.xi,
                   1.0, s.master, g);
  const auto n = value(s.own.d1[0]).cross(value(s.own.d1[1]));
  return carried(*d.field, surface::tangent_plane(at_rest(p.own.reference, {})), {},
                 n.dot(value(g.normal)) < 0.0 ? -1.0 : 1.0, s.own, g);
}

/// m_j = c (T . rho^j) n_f - c^j T with x - rho = c^j rho_j + c n_f; c^j = 0 inside a facet.
inline std::array<Vec, 2> couple(const PairPoint& p, const Seen& s, const Vec& friction) {
  const Vec apart = seed(p.slave, 0) - s.facet.jet.position;
  const S above = apart.dot(s.facet.normal);
  std::array<Vec, 2> m;
  for (std::size_t j = 0; j < 2; ++j) {
    const Vec dual = s.facet.dual_basis(j);
    m[j] = above * friction.dot(dual) * s.facet.normal;
    if (p.feature != Feature::interior) m[j] -= apart.dot(dual) * friction;
  }
  return m;
}

/// The update, by the law in the basis of the facet or of the ridge.
inline Result update(const InterfaceLaw& law, const PointState& state, const PairPoint& p,
                     double dt) {
  const Seen s = see(state, p, dt);
  const auto reaction =
      react(law, state, s.k, [&](const Directions& d) { return axes_at(d, p, s); });
  const Vec friction = s.k.now.spatial(reaction.traction);
  Result out{reaction.pressure * s.k.now.normal + friction, s.dxi, couple(p, s, friction),
             reaction.state, reaction.failure};
  out.state.facet = p.facet;
  out.state.spin =
      state.status == 0 || !looks_back(law.evolution) ? 0.0 : value(relative_spin(state, s.k));
  if (p.feature == Feature::interior || reaction.state.status == 0) return out;
  // the history is kept in the basis of the facet, also where the law saw that of a ridge
  const auto g = surface::value(s.k.now), f = surface::value(s.facet);
  PointState& t = out.state;
  for (auto* c : {&t.traction, &t.stored}) *c = f.project_co(g.spatial(Covector<double>{*c})).c;
  for (auto* c : {&t.elastic, &t.slip}) *c = f.project_contra(g.spatial(Vector<double>{*c})).c;
  if (state.status == 0 || state.gap > 0.0) {
    const Vector<double> way = Vector<double>{t.xi} - Vector<double>{t.origin};
    t.origin = (Vector<double>{t.xi} - f.project_contra(g.spatial(way))).c;
  }
  return out;
}

}  // namespace anisocontact::oracle
