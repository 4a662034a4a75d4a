#pragma once
// Closest point projection onto one facet: inside it, on its sides or at its vertices.
//
// The squared distance f(xi) = |rho(xi) - x|^2 is a polynomial. Where its Bernstein coefficients
// certify that it has a single minimum, Newton's method finds it; elsewhere the facet is halved,
// parts whose smallest coefficient exceeds the best value are dropped, and the rest is halved again.
// So the minimum is the global one, also far away and on strongly curved facets.

#include <cmath>
#include <cstdint>
#include <limits>

#include "anisocontact/projection/minimise.hpp"
#include "anisocontact/projection/relative_facet.hpp"
#include "anisocontact/projection/squared_distance.hpp"
#include "anisocontact/surface/facet.hpp"

namespace anisocontact::projection {

using surface::FacetKind;

/// Where on a facet the closest point is. `interior`: x - rho is normal to the facet, also where
/// the point happens to be on a side; `edge`: normal to a side alone; `vertex`: to none.
enum class Feature : std::int8_t { interior = 0, edge = 1, vertex = 2 };

/// `nothing`: no point nearer than the limit; `failed`: no convergence (degenerate facet).
enum class Search : std::int8_t { found = 0, nothing = 1, failed = 2 };

struct FacetPoint {
  std::array<double, 2> xi{};  ///< in the coordinates of the facet
  Vec3<double> position{Vec3<double>::Zero()};
  Vec3<double> cross{Vec3<double>::Zero()};  ///< rho_1 x rho_2
  double distance2{std::numeric_limits<double>::infinity()};
  Feature feature{Feature::interior};
  std::int8_t entity{-1};    ///< side or vertex of the feature, in the numbers of the mesh
  std::uint8_t boundary{0};  ///< bit k: the point is on side k, whatever the feature
  Search search{Search::nothing};
};

namespace facet_detail {

/// Relative tolerance of "x - rho is normal to a tangent": far above the rounding of a projection,
/// far below any angle or length that matters.
inline constexpr double normal_tolerance = 1e-10;

/// Best of the minima found so far.
struct Best {
  std::array<double, 2> xi{};
  double f;  ///< |r|^2 / 2, or the limit
  Search search{Search::nothing};

  void take(const Minimum& m, const Part& part) noexcept {
    if (m.converged && m.f < f) *this = {part.at(m.s), m.f, Search::found};
  }
};

/// The parts of a facet on which the least f can be, each to its minimum.
template <class Polynomial>
void branch_and_bound(const RelativeFacet& facet, const Polynomial& whole, double slack,
                      Best& best) noexcept {
  constexpr std::size_t most_waiting = 64, most_parts = 10000, many_parts = 100;
  // parts that could only win by this much are dropped where a minimum is known, or where parts
  // around a flat one pile up
  constexpr double drop = 1e-9, coarse_drop = 1e-6;
  std::array<Polynomial, most_waiting> waiting;
  std::size_t count = 0;
  bool doubt = false;
  waiting[count++] = whole;
  for (std::size_t parts = 0; count > 0; ++parts) {
    Polynomial p = waiting[--count];
    const bool many = parts >= many_parts;
    const double share = best.search == Search::found || many ? drop : 0.0;
    // around a pole, a side that is a point, all parts are as near to within rounding
    if (p.lower() + (many ? slack : -slack) >= 2.0 * best.f * (1.0 - share)) continue;
    const bool last = parts >= most_parts || count + 2 > most_waiting;
    if (last || p.single()) {
      const Minimum m = minimise(facet, p.part, p.lowest());
      best.take(m, p.part);
      doubt = doubt || (last && p.lower() + slack < 2.0 * best.f * (1.0 - coarse_drop));
      if (last || m.converged) continue;
    }
    Polynomial q = p.halve();
    if (p.lower() < q.lower()) std::swap(p, q);
    waiting[count++] = p;
    waiting[count++] = q;
  }
  if (doubt) best.search = Search::failed;
  if (best.search != Search::found) return;
  const Minimum polished = minimise(facet, whole_facet, best.xi);
  if (polished.converged && polished.f <= best.f * (1.0 + drop)) {
    best.xi = polished.s;
    best.f = polished.f;
  }
}

/// Least f = |r|^2 / 2 over a facet of more than three nodes, where it is below the limit.
template <class Polynomial>
Best global_minimum(const RelativeFacet& facet, const Polynomial& whole, double limit,
                    const std::array<double, 2>* start) noexcept {
  constexpr double rounding = 1e-14;
  const double slack = rounding * *std::max_element(whole.c.begin(), whole.c.end());
  Best best{{}, limit};
  if (whole.lower() - slack >= 2.0 * limit) return best;
  const Minimum m = minimise(facet, whole.part, start ? *start : whole.lowest());
  best.take(m, whole.part);
  if (!m.converged || !whole.single()) branch_and_bound(facet, whole, slack, best);
  return best;
}

/// Sides on which coordinates of the reference facet are.
inline std::uint8_t sides_at(bool triangular, const std::array<double, 2>& s) noexcept {
  constexpr double on = 1e-14;  // rounding of u + v = 1
  unsigned bits = 0;
  for (std::size_t side = 0; side < (triangular ? 3U : 4U); ++side)
    if (outside(triangular, side, s) >= -on) bits |= 1U << side;
  return static_cast<std::uint8_t>(bits);
}

/// |r . t| = 0 within the tolerance, for a tangent t.
inline bool is_normal(const Vec3<double>& r, const Vec3<double>& t) noexcept {
  const double length = t.norm();
  return std::abs(r.dot(t)) <= normal_tolerance * length * (length + r.norm());
}

/// Feature and entity of a point from the sides it is on and from what x - rho is normal to.
inline void classify(Topology t, const Local& l, FacetPoint& p) noexcept {
  p.feature = Feature::interior;
  p.entity = -1;
  if (p.boundary == 0 || (is_normal(l.r, l.r1) && is_normal(l.r, l.r2))) return;
  std::array<std::size_t, 4> on{};
  std::size_t count = 0;
  for (std::size_t side = 0; side < surface::side_count(t); ++side)
    if (p.boundary >> side & 1U) on[count++] = side;
  for (std::size_t k = 0; k < count; ++k) {
    const auto d = surface::side_direction({t, false}, on[k]);
    if (count == 1 || is_normal(l.r, d[0] * l.r1 + d[1] * l.r2)) {
      p.feature = Feature::edge;
      p.entity = static_cast<std::int8_t>(on[k]);
      return;
    }
  }
  const auto a = surface::side_vertices(t, on[0]), b = surface::side_vertices(t, on[1]);
  p.feature = Feature::vertex;
  p.entity = static_cast<std::int8_t>(a[0] == b[0] || a[0] == b[1] ? a[0] : a[1]);
}

inline Best search(const RelativeFacet& facet, double limit,
                   const std::array<double, 2>* start) noexcept {
  const auto& p = facet.controls;
  switch (facet.topology) {
    case Topology::tri3: {  // f is quadratic
      const std::array<double, 2> s{0.0, 0.0};
      return {minimum(facet.at(s).model(whole_facet, s), true), 0.0, Search::found};
    }
    case Topology::tri6:
      return global_minimum(facet, triangle_distance(p), limit, start);
    case Topology::quad4:
      return global_minimum(facet, square_distance<1>(p), limit, start);
    case Topology::quad8:
    case Topology::quad9:
      break;
  }
  return global_minimum(facet, square_distance<2>(p), limit, start);
}

}  // namespace facet_detail

/// Closest point of a facet to x.
///
/// `limit2`: only a point with a smaller squared distance is of interest. `start`: coordinates of the
/// facet to start from, those of an earlier projection; the result does not depend on them.
inline FacetPoint closest_point(const FacetKind& kind, const FacetNodes& nodes,
                                const Vec3<double>& x,
                                double limit2 = std::numeric_limits<double>::infinity(),
                                const std::array<double, 2>* start = nullptr) noexcept {
  FacetPoint p;
  std::array<double, 2> from{};
  if (start) from = surface::exchanged(kind, *start);
  const RelativeFacet facet(kind.topology, nodes, x);
  const auto m = facet_detail::search(facet, 0.5 * limit2, start ? &from : nullptr);
  p.search = m.search;
  if (m.search != Search::found) return p;
  const Local l = facet.at(m.xi);
  p.distance2 = 2.0 * l.f;
  if (!(p.distance2 < limit2)) {
    p.search = Search::nothing;
    return p;
  }
  p.xi = surface::exchanged(kind, m.xi);
  p.position = x + l.r;
  p.cross = kind.flip ? l.r2.cross(l.r1) : l.r1.cross(l.r2);
  p.boundary = facet_detail::sides_at(facet.triangular(), m.xi);
  facet_detail::classify(kind.topology, l, p);
  return p;
}

}  // namespace anisocontact::projection
