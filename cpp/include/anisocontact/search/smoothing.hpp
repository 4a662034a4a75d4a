#pragma once
// Smooth surface over linear facets: tri3 and quad4 become tri6 and quad8 with edges that are normal
// to averaged normals at the vertices, so that normals hardly jump over a mesh that approximates a
// curved surface. The patches are facets like any other.
//
// Where a normal is averaged over one side only, at the border and at sharp edges, and more so at
// their corners, an edge that leaves from there is an arc after the normal at its other end.

#include <cmath>
#include <map>

#include "anisocontact/search/connectivity.hpp"
#include "anisocontact/surface/patch.hpp"

namespace anisocontact::search {

/// Derivatives of the middles of the edges: middle m depends on the points
/// `points[first[m]] ... points[first[m + 1] - 1]`, with one 3 x 3 block each.
struct MiddleDerivatives {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> points;
  std::vector<Eigen::Matrix3d> blocks;
};

class Smoothing {
 public:
  /// Edges at which the facets of `points` meet at more than `crease` (an angle of their normals)
  /// stay sharp and straight, for good. All facets are tri3 or quad4.
  Smoothing(const std::vector<Vec3<double>>& points, std::vector<FacetKind> kinds,
            std::vector<std::int32_t> nodes, double crease)
      : mesh_(points.size(), std::move(kinds), std::move(nodes)) {
    for (std::size_t f = 0; f < mesh_.facets(); ++f)
      if (mesh_.kind(f).nodes() != mesh_.kind(f).sides())
        throw std::invalid_argument("facet " + std::to_string(f) + " is not linear");
    number_edges(points, std::cos(crease));
    group_corners(points);
  }

  std::size_t middles() const { return edges_.size(); }
  const Connectivity& mesh() const { return mesh_; }

  /// Topologies of the patches.
  std::vector<FacetKind> kinds() const {
    std::vector<FacetKind> k;
    for (std::size_t f = 0; f < mesh_.facets(); ++f)
      k.push_back({surface::triangular(mesh_.kind(f).topology) ? surface::Topology::tri6
                                                               : surface::Topology::quad8,
                   mesh_.kind(f).flip});
    return k;
  }

  /// Nodes of the patches, one after the other: the points, then the middles from `points` on.
  std::vector<std::int32_t> nodes(std::size_t points) const {
    std::vector<std::int32_t> n;
    for (std::size_t f = 0; f < mesh_.facets(); ++f) {
      const auto corners = mesh_.nodes(f);
      n.insert(n.end(), corners.begin(), corners.end());
      for (std::size_t k = 0; k < mesh_.kind(f).sides(); ++k)
        n.push_back(static_cast<std::int32_t>(points) + edge_of_[first_[f] + k]);
    }
    return n;
  }

  std::vector<Vec3<double>> middles(const std::vector<Vec3<double>>& points) const {
    const auto n = normals(points);
    std::vector<Vec3<double>> out;
    out.reserve(edges_.size());
    for (const Edge& e : edges_) {
      const auto &a = points[index(e.ends[0])], &b = points[index(e.ends[1])];
      out.push_back(middle(e, a, b, n[e.groups[0]], n[e.groups[1]]));
    }
    return out;
  }

  MiddleDerivatives derivatives(const std::vector<Vec3<double>>& points) const {
    const auto n = normals(points);
    const auto dn = normal_derivatives(points);
    MiddleDerivatives out;
    out.first.push_back(0);
    for (const Edge& e : edges_) {
      const auto &a = points[index(e.ends[0])], &b = points[index(e.ends[1])];
      Blocks blocks;
      const auto d = partial(e, a, b, n[e.groups[0]], n[e.groups[1]]);
      for (std::size_t i = 0; i < 2; ++i) {
        add(blocks, e.ends[i], d[i]);
        if (!d[2 + i].isZero(0.0))
          for (const auto& [p, block] : dn[e.groups[i]]) add(blocks, p, d[2 + i] * block);
      }
      for (const auto& [p, block] : blocks) {
        out.points.push_back(p);
        out.blocks.push_back(block);
      }
      out.first.push_back(out.points.size());
    }
    return out;
  }

 private:
  using Blocks = std::map<std::int32_t, Eigen::Matrix3d>;

  /// How far around a point its normal is averaged: all around, over one side, in a corner.
  enum class Surrounding { all, side, corner };

  struct Edge {
    std::array<std::int32_t, 2> ends;
    std::array<std::size_t, 2> groups;  ///< of corners at the ends that share a normal
    bool sharp;
    std::array<Surrounding, 2> surrounding;
  };

  struct Corner {
    std::int32_t point, next, previous;  ///< counter-clockwise about the normal
  };

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

  static void add(Blocks& blocks, std::int32_t point, const Eigen::Matrix3d& m) {
    const auto [at, fresh] = blocks.try_emplace(point, m);
    if (!fresh) at->second += m;
  }

  Corner corner(std::size_t f, std::size_t k) const {
    constexpr std::array<std::array<std::size_t, 2>, 4> quad{{{1, 2}, {3, 0}, {0, 3}, {2, 1}}};
    const bool triangle = surface::triangular(mesh_.kind(f).topology);
    auto next = triangle ? (k + 1) % 3 : quad[k][0], previous = triangle ? (k + 2) % 3 : quad[k][1];
    if (mesh_.kind(f).flip) std::swap(next, previous);
    return {mesh_.vertex(f, k), mesh_.vertex(f, next), mesh_.vertex(f, previous)};
  }

  /// Edges of a corner.
  std::array<Vec3<double>, 2> edges_at(const std::vector<Vec3<double>>& x, const Corner& c) const {
    return {x[index(c.next)] - x[index(c.point)], x[index(c.previous)] - x[index(c.point)]};
  }

  Vec3<double> facet_normal(const std::vector<Vec3<double>>& x, std::size_t f) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (std::size_t k = 0; k < mesh_.kind(f).sides(); ++k) {
      const auto [a, b] = edges_at(x, corner(f, k));
      sum += a.cross(b);
    }
    return sum.normalized();
  }

  void number_edges(const std::vector<Vec3<double>>& x, double least_cosine) {
    first_.assign(1, 0);
    for (std::size_t f = 0; f < mesh_.facets(); ++f)
      first_.push_back(first_.back() + mesh_.kind(f).sides());
    edge_of_.assign(first_.back(), -1);
    for (std::size_t f = 0; f < mesh_.facets(); ++f)
      for (std::size_t k = 0; k < mesh_.kind(f).sides(); ++k) {
        if (edge_of_[first_[f] + k] >= 0) continue;
        const auto number = static_cast<std::int32_t>(edges_.size());
        bool sharp = false;
        edge_of_[first_[f] + k] = number;
        mesh_.across(f, k, [&](std::int32_t g, std::size_t side) {
          edge_of_[first_[index(g)] + side] = number;
          sharp = sharp || facet_normal(x, f).dot(facet_normal(x, index(g))) < least_cosine;
        });
        edges_.push_back({mesh_.side(f, k), {}, sharp, {}});
      }
  }

  /// Corners at a point that are connected over edges that are not sharp share a normal.
  void group_corners(const std::vector<Vec3<double>>& points) {
    group_of_.assign(first_.back(), unset);
    for (std::size_t f = 0; f < mesh_.facets(); ++f)
      for (std::size_t k = 0; k < mesh_.kind(f).sides(); ++k)
        if (group_of_[first_[f] + k] == unset) spread(points, f, k);
    for (std::size_t f = 0; f < mesh_.facets(); ++f)
      for (std::size_t side = 0; side < mesh_.kind(f).sides(); ++side) {
        Edge& e = edges_[index(edge_of_[first_[f] + side])];
        for (std::size_t k = 0; k < mesh_.kind(f).sides(); ++k)
          for (std::size_t end = 0; end < 2; ++end)
            if (mesh_.vertex(f, k) == e.ends[end]) {
              e.groups[end] = group_of_[first_[f] + k];
              e.surrounding[end] = surrounding_[e.groups[end]];
            }
      }
  }

  /// A new group from corner k of facet f on.
  void spread(const std::vector<Vec3<double>>& x, std::size_t f, std::size_t k) {
    constexpr double corner_angle = 2.35;  // between a right angle and a straight one
    const std::int32_t point = mesh_.vertex(f, k);
    const std::size_t group = groups_.size();
    groups_.emplace_back();
    bool open = false;
    double angle = 0.0;
    std::vector<std::size_t> waiting{f};
    while (!waiting.empty()) {
      const std::size_t g = waiting.back();
      waiting.pop_back();
      std::size_t own = 0;
      while (mesh_.vertex(g, own) != point) ++own;
      if (group_of_[first_[g] + own] != unset) continue;
      group_of_[first_[g] + own] = group;
      groups_[group].push_back({g, own});
      const auto [a, b] = edges_at(x, corner(g, own));
      angle += std::atan2(a.cross(b).norm(), a.dot(b));
      for (std::size_t side = 0; side < mesh_.kind(g).sides(); ++side) {
        const auto ends = mesh_.side(g, side);
        if (ends[0] != point && ends[1] != point) continue;
        const bool sharp = edges_[index(edge_of_[first_[g] + side])].sharp;
        open = open || sharp || mesh_.border_side(g, side);
        if (sharp) continue;
        mesh_.across(g, side, [&](std::int32_t h, std::size_t) { waiting.push_back(index(h)); });
      }
    }
    surrounding_.push_back(!open                  ? Surrounding::all
                           : angle > corner_angle ? Surrounding::side
                                                  : Surrounding::corner);
  }

  Vec3<double> normal_sum(const std::vector<Vec3<double>>& x, std::size_t group) const {
    Vec3<double> sum = Vec3<double>::Zero();
    for (const auto& [f, k] : groups_[group]) {
      const auto [a, b] = edges_at(x, corner(f, k));
      sum += surface::corner_share(a, b);
    }
    return sum;
  }

  std::vector<Vec3<double>> normals(const std::vector<Vec3<double>>& x) const {
    std::vector<Vec3<double>> n;
    for (std::size_t g = 0; g < groups_.size(); ++g) n.push_back(normal_sum(x, g).normalized());
    return n;
  }

  std::vector<Blocks> normal_derivatives(const std::vector<Vec3<double>>& x) const {
    using S = Dual<6>;
    std::vector<Blocks> out(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const Vec3<double> sum = normal_sum(x, g), n = sum.normalized();
      const Eigen::Matrix3d unit = (Eigen::Matrix3d::Identity() - n * n.transpose()) / sum.norm();
      for (const auto& [f, k] : groups_[g]) {
        const Corner c = corner(f, k);
        const auto v = variables<6>(edges_at(x, c));
        const Vec3<S> share = surface::corner_share(v[0], v[1]);
        const Eigen::Matrix3d by_next = unit * block(share, 0),
                              by_previous = unit * block(share, 1);
        add(out[g], c.next, by_next);
        add(out[g], c.previous, by_previous);
        add(out[g], c.point, -(by_next + by_previous));
      }
    }
    return out;
  }

  /// The vectors as independent variables, three numbers each.
  template <std::size_t N>
  static std::array<Vec3<Dual<N>>, N / 3> variables(const std::array<Vec3<double>, N / 3>& v) {
    std::array<Vec3<Dual<N>>, N / 3> out;
    for (std::size_t k = 0; k < N; ++k)
      out[k / 3][static_cast<Eigen::Index>(k % 3)] =
          Dual<N>::variable(v[k / 3][static_cast<Eigen::Index>(k % 3)], k);
    return out;
  }

  /// Derivative of u by the j-th vector of variables.
  template <std::size_t N>
  static Eigen::Matrix3d block(const Vec3<Dual<N>>& u, std::size_t j) {
    Eigen::Matrix3d m;
    for (Eigen::Index i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) m(i, static_cast<Eigen::Index>(k)) = u[i].d[3 * j + k];
    return m;
  }

  template <class S>
  static Vec3<S> middle(const Edge& e, const Vec3<S>& a, const Vec3<S>& b, Vec3<S> n0, Vec3<S> n1) {
    if (e.sharp) return S(0.5) * (a + b);
    const auto [at0, at1] = e.surrounding;
    if (at0 > at1) n0 = surface::mirrored_normal<S>(n1, b - a);
    if (at1 > at0) n1 = surface::mirrored_normal<S>(n0, b - a);
    return surface::patch_middle(a, b, n0, n1);
  }

  /// Derivatives of a middle by both ends and both normals.
  static std::array<Eigen::Matrix3d, 4> partial(const Edge& e, const Vec3<double>& a,
                                                const Vec3<double>& b, const Vec3<double>& n0,
                                                const Vec3<double>& n1) {
    const auto v = variables<12>({a, b, n0, n1});
    const auto m = middle(e, v[0], v[1], v[2], v[3]);
    return {block(m, 0), block(m, 1), block(m, 2), block(m, 3)};
  }

  static constexpr std::size_t unset = static_cast<std::size_t>(-1);
  Connectivity mesh_;
  std::vector<std::size_t> first_;     ///< corner k and side k of facet f are number first_[f] + k
  std::vector<std::int32_t> edge_of_;  ///< by side
  std::vector<std::size_t> group_of_;  ///< by corner
  std::vector<Edge> edges_;
  std::vector<std::vector<std::array<std::size_t, 2>>> groups_;  ///< facet and corner
  std::vector<Surrounding> surrounding_;                         ///< by group
};

}  // namespace anisocontact::search
