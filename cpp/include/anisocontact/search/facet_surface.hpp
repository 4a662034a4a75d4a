#pragma once
// A surface of facets that move, and the closest point on it.

#include <cmath>
#include <limits>
#include <optional>

#include "anisocontact/projection/facet_projection.hpp"
#include "anisocontact/search/connectivity.hpp"
#include "anisocontact/search/tree.hpp"

namespace anisocontact::search {

using projection::Feature;
using surface::FacetNodes;

/// `on`: the closest point counts. `off`: x lies beyond the border of the surface, or beyond a side
/// to an excluded facet. `beyond`: nothing within the largest distance. `failed`: coordinates that
/// are not finite, or a facet on which the projection did not converge.
enum class Status : std::int8_t { on = 0, off = 1, beyond = 2, failed = 3 };

/// Closest point of the surface to x. Where the status is `beyond` or `failed` there is none: facet
/// is -1 and the numbers are NaN.
struct FacetProjection {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::int32_t facet{-1};
  Status status{Status::beyond};
  Feature feature{Feature::interior};
  std::int8_t entity{-1};  ///< side or vertex of the facet, in the numbers of the mesh
  std::array<double, 2> xi{none, none};
  std::array<double, 2> edge{};  ///< direction of the side in coordinates, for an edge
  Vec3<double> position{none, none, none};
  Vec3<double> normal{none, none, none};
  double gap{none};  ///< (x - position) . normal
};

/// What is asked besides the point.
struct Query {
  std::int32_t hint{-1};   ///< facet of an earlier projection
  std::int32_t named{-1};  ///< facet that is named where several share the closest point
  std::optional<std::array<double, 2>> start{};           ///< coordinates on it
  double limit{std::numeric_limits<double>::infinity()};  ///< largest distance
  std::span<const std::int32_t> excluded{};  ///< facets that do not count, in ascending order

  bool excludes(std::int32_t f) const {
    return std::binary_search(excluded.begin(), excluded.end(), f);
  }
};

/// Queries are const and may run in any number of threads; `update` may not run beside them.
class FacetSurface {
 public:
  FacetSurface(std::vector<Vec3<double>> points, std::vector<FacetKind> kinds,
               std::vector<std::int32_t> nodes)
      : points_(std::move(points)),
        mesh_(points_.size(), std::move(kinds), std::move(nodes)),
        boxes_(bounds()),
        tree_(boxes_),
        cost_(tree_.cost()) {}

  /// Moves the points; the tree is refitted, or built anew where boxes overlap too much by now.
  void update(std::vector<Vec3<double>> points) {
    points_ = std::move(points);
    boxes_ = bounds();
    tree_.refit(boxes_);
    constexpr double worn = 2.0;
    if (finite_ && tree_.cost() > worn * cost_) {
      tree_ = Tree(boxes_);
      cost_ = tree_.cost();
    }
  }

  const Connectivity& mesh() const { return mesh_; }
  std::size_t points() const { return points_.size(); }
  std::size_t facets() const { return mesh_.facets(); }

  FacetNodes nodes(std::int32_t f) const noexcept {
    FacetNodes x;
    const auto n = mesh_.nodes(static_cast<std::size_t>(f));
    for (std::size_t i = 0; i < n.size(); ++i) x[i] = points_[static_cast<std::size_t>(n[i])];
    return x;
  }
  const FacetKind& kind(std::int32_t f) const noexcept {
    return mesh_.kind(static_cast<std::size_t>(f));
  }
  surface::Jet<double> jet(std::int32_t f, const std::array<double, 2>& xi) const noexcept {
    return surface::facet_jet(kind(f), nodes(f), xi[0], xi[1]);
  }

  /// Closest point of the surface to x. The hint changes the time it takes, and which of places that are
  /// equally near to rounding is found.
  FacetProjection closest(const Vec3<double>& x, const Query& q = {}) const noexcept {
    FacetProjection out;
    out.status = Status::failed;
    if (!finite_ || !x.allFinite()) return out;
    Candidate best;
    best.point.distance2 = q.limit * q.limit;
    double doubt2 = std::numeric_limits<double>::infinity();
    if (q.hint >= 0 && static_cast<std::size_t>(q.hint) < facets()) {
      attempt(x, q, q.hint, q.start ? &*q.start : nullptr, 0.0, best);
      settle(x, q, best);
    }
    const auto visit = [&](std::int32_t f, double d2) {
      doubt2 = std::min(doubt2, attempt(x, q, f, nullptr, d2, best));
    };
    if (best.facet >= 0)
      tree_.descend_beside(static_cast<std::size_t>(best.facet), x, best.point.distance2, visit);
    else
      tree_.descend(x, best.point.distance2, visit);
    if (doubt2 < best.point.distance2) return out;
    settle(x, q, best);
    return finish(x, q, best);
  }

  /// Facets within a distance of x, in ascending order.
  std::vector<std::int32_t> within(const Vec3<double>& x, double distance) const {
    std::vector<std::int32_t> found;
    within(x, distance, [](std::int32_t) { return true; }, found);
    return found;
  }

  /// The same of those that are wanted, which is asked before the distance; `found` is written anew.
  template <class Wanted>
  void within(const Vec3<double>& x, double distance, const Wanted& wanted,
              std::vector<std::int32_t>& found) const {
    found.clear();
    const double bound = squared_bound(distance);
    tree_.descend(x, bound, [&](std::int32_t f, double) {
      if (wanted(f) && is_nearer(f, x, bound)) found.push_back(f);
    });
    std::sort(found.begin(), found.end());
  }

  /// Whether a facet is within a distance of x.
  bool is_within(std::int32_t f, const Vec3<double>& x, double distance) const {
    return is_nearer(f, x, squared_bound(distance));
  }

 private:
  struct Candidate {
    std::int32_t facet{-1};
    projection::FacetPoint point{};
  };

  /// The bound below which squares of distances are up to one.
  static double squared_bound(double distance) {
    return std::nextafter(distance * distance, 2.0 * distance * distance);
  }

  /// Whether a facet is nearer than a bound, the square of a distance; a node of it may be as well.
  bool is_nearer(std::int32_t f, const Vec3<double>& x, double bound2) const {
    const FacetNodes p = nodes(f);
    for (std::size_t a = 0; a < surface::node_count(kind(f).topology); ++a)
      if ((p[a] - x).squaredNorm() < bound2) return true;
    return projection::closest_point(kind(f), p, x, bound2).search == projection::Search::found;
  }

  std::vector<Box> bounds() {
    finite_ = true;
    for (const auto& x : points_) finite_ = finite_ && x.allFinite();
    std::vector<Box> boxes(facets(), Box::empty());
    for (std::size_t f = 0; f < facets(); ++f) {
      const auto t = mesh_.kind(f).topology;
      const auto p = surface::control_points(t, nodes(static_cast<std::int32_t>(f)));
      for (std::size_t i = 0; i < surface::control_count(t); ++i) boxes[f].add(p[i]);
    }
    return boxes;
  }

  /// Takes facet f if it is nearer than the best so far. If its projection fails: the squared
  /// distance at least below which this is a doubt, else infinity.
  double attempt(const Vec3<double>& x, const Query& q, std::int32_t f,
                 const std::array<double, 2>* start, double d2, Candidate& best) const noexcept {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (q.excludes(f)) return none;
    const auto p = projection::closest_point(kind(f), nodes(f), x, best.point.distance2, start);
    if (p.search == projection::Search::found) best = {f, p};
    return p.search == projection::Search::failed ? d2 : none;
  }

  /// Length that tells points of a facet apart: |x - rho| and the size of the facet, to rounding.
  double tie(const Candidate& c) const noexcept {
    constexpr double rounding = 1e-12;
    const auto n = mesh_.nodes(static_cast<std::size_t>(c.facet));
    const double size =
        (points_[static_cast<std::size_t>(n[0])] - points_[static_cast<std::size_t>(n[1])]).norm();
    return rounding * (std::sqrt(c.point.distance2) + size);
  }

  /// How far x is from the tangent plane of a facet at its closest point.
  static double above(const Vec3<double>& x, const Candidate& c) noexcept {
    return std::abs((x - c.point.position).dot(c.point.cross)) / c.point.cross.norm();
  }

  /// Which of two facets with the same closest point is named: the one whose normal is x - rho,
  /// then the one with the point on an edge, inner edges first, then the one whose normal is nearer
  /// to x - rho, then the one of the query, then the first. So the name is one of the place, and
  /// what depends on it is the same from wherever the point has come.
  bool goes_before(const Vec3<double>& x, const Candidate& a, const Candidate& b,
                   const Query& q) const noexcept {
    const auto place = [&](const Candidate& c) {
      const bool border = c.point.feature == Feature::edge &&
                          mesh_.border_side(static_cast<std::size_t>(c.facet),
                                            static_cast<std::size_t>(c.point.entity));
      return std::array<int, 2>{static_cast<int>(c.point.feature), border ? 1 : 0};
    };
    const auto first = place(a), second = place(b);
    if (first != second) return first < second;
    const double nearer = above(x, a) - above(x, b);
    if (std::abs(nearer) > tie(b)) return nearer > 0.0;
    const auto rank = [&](const Candidate& c) {
      return std::array<int, 2>{c.facet == q.named ? 0 : 1, c.facet};
    };
    return rank(a) < rank(b);
  }

  /// Calls visit(g) for the other facets that share the side or the vertex a point is on.
  template <class Visit>
  void sharing(const Candidate& c, const Visit& visit) const noexcept {
    const auto f = static_cast<std::size_t>(c.facet);
    std::array<std::size_t, 4> on{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < mesh_.kind(f).sides(); ++k)
      if (c.point.boundary >> k & 1U) on[count++] = k;
    if (count == 1) return mesh_.across(f, on[0], [&](std::int32_t g, std::size_t) { visit(g); });
    if (count == 0) return;
    const auto a = mesh_.side(f, on[0]), b = mesh_.side(f, on[1]);
    for (const std::int32_t g : mesh_.around(a[0] == b[0] || a[0] == b[1] ? a[0] : a[1]))
      if (g != c.facet) visit(g);
  }

  /// Walks over the sides and vertices the point is on to facets that are nearer, or that go before.
  void settle(const Vec3<double>& x, const Query& q, Candidate& best) const noexcept {
    constexpr int most_facets = 64;
    for (int k = 0; k < most_facets && best.facet >= 0 && best.point.boundary != 0; ++k) {
      Candidate top = best;
      const double slack = tie(best);
      sharing(best, [&](std::int32_t g) {
        if (q.excludes(g)) return;
        const double top_distance = std::sqrt(top.point.distance2), limit = top_distance + slack;
        const Candidate c{g, projection::closest_point(kind(g), nodes(g), x, limit * limit)};
        if (c.point.search != projection::Search::found) return;
        const bool same = std::sqrt(c.point.distance2) > top_distance - slack;
        if (same ? goes_before(x, c, top, q) : c.point.distance2 < top.point.distance2) top = c;
      });
      if (top.facet == best.facet) return;
      best = top;
    }
  }

  Vec3<double> unit_normal(std::int32_t f, const std::array<double, 2>& xi) const noexcept {
    const auto j = jet(f, xi);
    return j.d1[0].cross(j.d1[1]).normalized();
  }

  /// Sum of the normals of the facets at a side, at a point of it.
  Vec3<double> side_normal(std::int32_t f, std::size_t side,
                           const std::array<double, 2>& xi) const noexcept {
    const auto here = static_cast<std::size_t>(f);
    const auto from =
        surface::vertex_coordinates(surface::side_vertices(kind(f).topology, side)[0]);
    const auto s = surface::exchanged(kind(f), xi);
    const auto e = surface::side_direction({kind(f).topology, false}, side);
    const double t = std::abs(e[0]) > 0.0 ? (s[0] - from[0]) / e[0] : (s[1] - from[1]) / e[1];
    Vec3<double> sum = unit_normal(f, xi);
    mesh_.across(here, side, [&](std::int32_t g, std::size_t other) {
      const auto& k = kind(g);
      const bool same =
          mesh_.side(static_cast<std::size_t>(g), other)[0] == mesh_.side(here, side)[0];
      const double r = same ? t : 1.0 - t;
      const auto v = surface::side_vertices(k.topology, other);
      const auto a = surface::vertex_coordinates(v[0]), b = surface::vertex_coordinates(v[1]);
      sum += unit_normal(
          g, surface::exchanged(k, {a[0] + r * (b[0] - a[0]), a[1] + r * (b[1] - a[1])}));
    });
    return sum;
  }

  /// Sum of the normals of the facets at a vertex, each by its angle there [Baerentzen Aanaes 2005].
  Vec3<double> vertex_normal(std::int32_t point) const noexcept {
    Vec3<double> sum = Vec3<double>::Zero();
    for (const std::int32_t g : mesh_.around(point)) {
      const auto& k = kind(g);
      const auto facet = static_cast<std::size_t>(g);
      std::size_t corner = 0;
      while (mesh_.vertex(facet, corner) != point) ++corner;
      const auto xi = surface::exchanged(k, surface::vertex_coordinates(corner));
      const auto j = jet(g, xi);
      std::array<Vec3<double>, 2> along;
      std::size_t count = 0;
      for (std::size_t side = 0; side < k.sides(); ++side) {
        const auto v = surface::side_vertices(k.topology, side);
        if (v[0] != corner && v[1] != corner) continue;
        const auto d = surface::side_direction(k, side);
        along[count++] = (v[0] == corner ? 1.0 : -1.0) * (d[0] * j.d1[0] + d[1] * j.d1[1]);
      }
      const double angle = std::atan2(along[0].cross(along[1]).norm(), along[0].dot(along[1]));
      sum += angle * j.d1[0].cross(j.d1[1]).normalized();
    }
    return sum;
  }

  bool ends_at(const Candidate& c, const Query& q) const noexcept {
    const auto f = static_cast<std::size_t>(c.facet);
    const auto k = static_cast<std::size_t>(c.point.entity);
    bool ends = c.point.feature == Feature::edge ? mesh_.border_side(f, k)
                                                 : mesh_.border_vertex(mesh_.vertex(f, k));
    sharing(c, [&](std::int32_t g) { ends = ends || q.excludes(g); });
    return ends;
  }

  /// Outward normal where the surface is smooth, else a vector that tells outside from inside.
  Vec3<double> outward(const Candidate& c) const noexcept {
    const auto f = static_cast<std::size_t>(c.facet), k = static_cast<std::size_t>(c.point.entity);
    switch (c.point.feature) {
      case Feature::interior:
        break;
      case Feature::edge:
        return side_normal(c.facet, k, c.point.xi);
      case Feature::vertex:
        return vertex_normal(mesh_.vertex(f, k));
    }
    return c.point.cross.normalized();
  }

  FacetProjection finish(const Vec3<double>& x, const Query& q,
                         const Candidate& best) const noexcept {
    FacetProjection out;
    if (best.facet < 0) return out;
    const auto& p = best.point;
    const bool interior = p.feature == Feature::interior;
    const Vec3<double> n = outward(best), apart = x - p.position;
    if (!(n.squaredNorm() > 0.0)) {
      out.status = Status::failed;
      return out;
    }
    out.facet = best.facet;
    out.status = !interior && ends_at(best, q) ? Status::off : Status::on;
    out.feature = p.feature;
    out.entity = p.entity;
    if (p.feature == Feature::edge)
      out.edge = surface::side_direction(kind(best.facet), static_cast<std::size_t>(p.entity));
    out.xi = p.xi;
    out.position = p.position;
    out.normal = interior ? n : (apart.dot(n) < 0.0 ? -1.0 : 1.0) * apart.normalized();
    out.gap = apart.dot(out.normal);
    return out;
  }

  std::vector<Vec3<double>> points_;
  Connectivity mesh_;
  bool finite_{true};
  std::vector<Box> boxes_;
  Tree tree_;
  double cost_;
};

}  // namespace anisocontact::search
