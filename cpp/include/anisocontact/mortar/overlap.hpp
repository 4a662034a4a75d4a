#pragma once
// Integrals over the overlap of a facet of the slave and one of the master:
//   m_ij = integral of N_i N_j,   c_ik = integral of N_i M_k ,
// N the (transformed) shape functions of the slave, M those of the master, over the plane at the
// middle of each part of the slave facet, along its normal [Puso Laursen 2004]; with their exact
// derivatives by the nodes of both.

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "anisocontact/mortar/clip.hpp"
#include "anisocontact/mortar/lanes.hpp"
#include "anisocontact/mortar/sub_facets.hpp"
#include "anisocontact/tensor/tangent.hpp"

namespace anisocontact::mortar {

using surface::max_facet_nodes;
using surface::Topology;
using Positions = std::array<Vec3<double>, max_facet_nodes>;

/// Points and weights on the unit triangle; weights sum to 1/2.
struct TriangleRule {
  const double *points, *weights;
  std::size_t count;
};

/// Rules for products of shape functions on parts that are triangles or parallelograms, on which these
/// are polynomials of the position, and on other quadrilaterals.
struct Rules {
  TriangleRule straight, skew;
};

/// A facet: its shape and where its nodes are.
struct Facet {
  Topology topology;
  Positions x;
  std::size_t nodes() const { return surface::node_count(topology); }
};

/// Shape functions of the slave that the multipliers are dual to. Those of the vertices of a tri6 have
/// no mass: they take a share of the nodes of the edges beside them, x_edge = (1 - 2 a) x'_edge + a
/// (x_1 + x_2) [Popp Wohlmuth Gitterle Wall 2012, sec. 3.2].
inline constexpr double edge_share = 0.2;
template <class S>
void transform(Topology t, surface::Shape<S>& s) {
  if (t != Topology::tri6) return;
  constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{1, 2}, {0, 2}, {0, 1}}};
  for (std::size_t e = 0; e < 3; ++e) {
    const std::size_t k = 3 + e;
    for (const std::size_t v : ends[e]) {
      s.N[v] += S(edge_share) * s.N[k];
      for (std::size_t i = 0; i < 2; ++i) s.dN[v][i] += S(edge_share) * s.dN[k][i];
    }
    s.N[k] = S(1.0 - 2.0 * edge_share) * s.N[k];
    for (std::size_t i = 0; i < 2; ++i) s.dN[k][i] = S(1.0 - 2.0 * edge_share) * s.dN[k][i];
  }
}

/// The plane at the middle of a part of a slave facet.
struct Plane {
  Vec3<double> middle, n;
  std::array<Vec3<double>, 2> t, e;  ///< tangents of the part, and axes of the plane
  CornerShape shape;
  double size;   ///< |t_1 x t_2|
  double scale;  ///< what areas are multiplied with

  Plane(const SubFacet& part, const Facet& f)
      : shape(part.corners, part.corners == 3 ? 1.0 / 3.0 : 0.5,
              part.corners == 3 ? 1.0 / 3.0 : 0.5) {
    middle.setZero();
    t = {Vec3<double>::Zero(), Vec3<double>::Zero()};
    for (std::size_t a = 0; a < part.corners; ++a) {
      const auto& x = f.x[part.node[a]];
      middle += shape.N[a] * x;
      for (std::size_t i = 0; i < 2; ++i) t[i] += shape.dN[a][i] * x;
    }
    const Vec3<double> c = t[0].cross(t[1]);
    size = c.norm();
    n = c / size;
    e[0] = t[0].normalized();
    e[1] = n.cross(e[0]);
    scale = 1.0;
  }

  std::array<double, 2> flat(const Vec3<double>& x) const {
    const Vec3<double> r = x - middle;
    return {r.dot(e[0]), r.dot(e[1])};
  }
};

/// Largest number of nodes of a facet.
inline constexpr std::size_t most = max_facet_nodes;

/// Integrals over overlaps with their derivatives: rows are the functions j of the slave, whose lanes
/// are m_ij, then those of the master, c_ik; columns three for each node of the slave, then of the
/// master.
template <std::size_t L>
struct Integrals {
  std::size_t rows{0}, columns{0};
  std::vector<Lanes<L>> value, slope;  ///< (rows,), (rows, columns)

  /// All zero, in the memory that is there.
  void begin(std::size_t slaves, std::size_t masters, bool slopes) {
    rows = slaves + masters;
    columns = 3 * rows;
    value.assign(rows, {});
    slope.assign(slopes ? rows * columns : 0, {});
  }
};

/// An overlap of parts of two facets, in the plane of the slave's.
struct Overlap {
  const SubFacet *slave, *master;
  std::size_t facet;  ///< of the master
  std::array<std::size_t, 4>
      order;  ///< corners of the master's part that turn as those of the slave
  Corners corners;
  Polygon polygon;
};

/// One part of a slave facet and its overlaps with facets of the master.
class SlavePart {
 public:
  SlavePart(const Facet& slave, const SubFacet& part) : part_(part), plane_(part, slave) {
    corners_.slaves = subject_.count = part.corners;
    for (std::size_t a = 0; a < part.corners; ++a) {
      corners_.x[a] = plane_.flat(slave.x[part.node[a]]);
      subject_.vertex[a] = {corners_.x[a], a, {a, a}};
    }
    area_ = subject_.area();
  }

  /// Counts areas as those of a reference configuration, where the facet has other positions.
  void scale_to(const Facet& reference) {
    plane_.scale = Plane(part_, reference).size / plane_.size;
    scaled_ = true;
  }

  /// Whether there is a plane.
  bool valid() const { return area_ > 0.0 && std::isfinite(area_); }

  /// Adds the overlaps with a facet of the master.
  void find(const Facet& master, std::size_t facet, std::vector<Overlap>& out) const {
    for (const SubFacet& other : sub_facets(master.topology)) {
      Corners corners = corners_;
      const auto order = place(master, other, corners);
      if (apart(corners)) continue;
      out.push_back({&part_, &other, facet, order, corners, {}});
      if (!cut(out.back())) out.pop_back();
    }
  }

  const Plane& plane() const { return plane_; }
  bool scaled() const { return scaled_; }

 private:
  /// Below this share of the part an overlap is rounding.
  static constexpr double sliver = 1e-13;

  /// Adds the corners of a part of the master, in the order in which they turn as those of the slave.
  std::array<std::size_t, 4> place(const Facet& master, const SubFacet& part, Corners& c) const {
    const std::size_t count = part.corners;
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::array<Point, 4> x;
    double twice = 0.0;
    for (std::size_t a = 0; a < count; ++a) x[a] = plane_.flat(master.x[part.node[a]]);
    for (std::size_t a = 0; a < count; ++a) {
      const Point &p = x[a], &q = x[a + 1 == count ? 0 : a + 1];
      twice += p[0] * q[1] - p[1] * q[0];
    }
    if (twice < 0.0)
      for (std::size_t a = 1; a < count; ++a) order[a] = count - a;
    c.masters = count;
    for (std::size_t a = 0; a < count; ++a) c.x[4 + a] = x[order[a]];
    return order;
  }

  /// Cuts the part with that of the master; whether anything is left.
  bool cut(Overlap& o) const {
    Polygon spare;
    Polygon *from = &o.polygon, *to = &spare;
    *from = subject_;
    for (std::size_t a = 0; a < o.corners.masters && from->count > 2; ++a) {
      clip(*from, o.corners, 4 + a, *to);
      std::swap(from, to);
    }
    if (from != &o.polygon) o.polygon = *from;
    return o.polygon.count > 2 && o.polygon.area() > sliver * area_;
  }

  static bool apart(const Corners& c) {
    for (std::size_t i = 0; i < 2; ++i) {
      std::array<double, 2> low, high;
      low.fill(std::numeric_limits<double>::infinity());
      high.fill(-low[0]);
      const auto put = [&](std::size_t side, double x) {
        low[side] = std::min(low[side], x);
        high[side] = std::max(high[side], x);
      };
      for (std::size_t a = 0; a < c.slaves; ++a) put(0, c.x[a][i]);
      for (std::size_t a = 0; a < c.masters; ++a) put(1, c.x[4 + a][i]);
      if (!(low[1] < high[0] && high[1] > low[0])) return true;
    }
    return false;
  }

  const SubFacet& part_;
  Plane plane_;
  Corners corners_;
  Polygon subject_;
  double area_;
  bool scaled_{false};
};

}  // namespace anisocontact::mortar
