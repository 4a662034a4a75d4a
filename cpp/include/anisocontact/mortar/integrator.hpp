#pragma once
// Quadrature over the polygon of an overlap, and derivatives backwards from the integrals to the nodes.

#include <Eigen/Dense>
#include <vector>

#include "anisocontact/mortar/in_part.hpp"

namespace anisocontact::mortar {

namespace detail {

/// Gradient of the integrals of a row by corners of both parts, (8, 2).
template <std::size_t L>
using ByCorners = std::array<Twins<L>, 8>;

/// Derivatives by coordinates in the plane as those by nodes: coordinates follow the nodes, and the
/// plane turns with the normal, d x_a = e_a . dx - h e_a . dn with the height h of a corner.
class ByNodes {
 public:
  ByNodes(const Plane& plane, const Overlap& o, const Facet& slave, const Facet& master,
          bool scaled)
      : plane_(plane), o_(o), scaled_(scaled) {
    for (std::size_t a = 0; a < o.slave->corners; ++a)
      height_[a] = plane.n.dot(slave.x[o.slave->node[a]] - plane.middle);
    for (std::size_t a = 0; a < o.master->corners; ++a)
      height_[4 + a] = plane.n.dot(master.x[o.master->node[o.order[a]]] - plane.middle);
  }

  /// Adds the derivative of numbers to columns: `g` by the plane, `value` where its scale changes
  /// with it; nodes of the slave, and of the master, have these columns.
  template <std::size_t L>
  ANISOCONTACT_INLINE void add(const ByCorners<L>& g, const Lanes<L>& value,
                               const std::array<std::size_t, most>& masters, Lanes<L>* out) const {
    std::array<Lanes<L>, 3> lean{};  // by dn
    const auto by = [&](std::size_t corner, std::size_t column) ANISOCONTACT_INLINE_LAMBDA {
      const Lanes<L> first = g[corner].part(0), second = g[corner].part(1);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto d = (plane_.scale * e(0, i)) * first + (plane_.scale * e(1, i)) * second;
        out[column + i].add(1.0, d);
        lean[i].add(-height_[corner], d);
      }
    };
    const SubFacet &slave = *o_.slave, &master = *o_.master;
    for (std::size_t a = 0; a < slave.corners; ++a) by(a, 3 * slave.node[a]);
    for (std::size_t a = 0; a < master.corners; ++a) by(4 + a, masters[master.node[o_.order[a]]]);
    // dn = (1 - n n)(dt_1 x t_2 + t_1 x dt_2) / |t_1 x t_2|; of the scale, - n . d(t_1 x t_2) / |..|
    if (scaled_)
      for (std::size_t i = 0; i < 3; ++i)
        lean[i].add(-plane_.scale * plane_.n[static_cast<Eigen::Index>(i)], value);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const auto first = t(1, j) * lean[k] + (-t(1, k)) * lean[j],
                 second = t(0, k) * lean[j] + (-t(0, j)) * lean[k];
      for (std::size_t a = 0; a < slave.corners; ++a)
        out[3 * slave.node[a] + i].add(
            1.0 / plane_.size, plane_.shape.dN[a][0] * first + plane_.shape.dN[a][1] * second);
    }
  }

 private:
  double e(std::size_t a, std::size_t i) const { return plane_.e[a][static_cast<Eigen::Index>(i)]; }
  double t(std::size_t a, std::size_t i) const { return plane_.t[a][static_cast<Eigen::Index>(i)]; }

  const Plane& plane_;
  const Overlap& o_;
  bool scaled_;
  std::array<double, 8> height_{};
};

}  // namespace detail

/// What an integrator works in; it keeps its memory from one facet to the next.
template <std::size_t L>
struct IntegratorMemory {
  using Batch = detail::Batch;

  /// Values and gradients of all functions, those of the slave first, at points side by side.
  struct Values {
    std::array<Batch, 2 * most> value;
    std::array<detail::PlanePoints, 2 * most> slope;
    std::array<Batch, 8> corner;  ///< functions of the corners of both parts, times - 2 A
  };
  /// Functions of the slave at a point, times its weight.
  struct AtPoint {
    Twins<L> first, second, dN;  ///< values as first components and as second ones; gradient
  };
  /// A triangle of the polygon.
  struct Triangle {
    double twice;                ///< twice its area
    std::array<Point, 3> grown;  ///< the derivative of this by the vertices
  };
  std::vector<Triangle> triangles;
  std::vector<AtPoint> points;
  std::vector<Values> values;
  std::vector<Crossing> crossings;
};

/// Integrates over overlaps of a slave facet.
template <std::size_t L>
class Integrator {
 public:
  Integrator(const Facet& slave, const Rules& rules, IntegratorMemory<L>& memory, Integrals<L>& out)
      : slave_(slave),
        rules_(rules),
        out_(out),
        slopes_(!out.slope.empty()),
        triangles_(memory.triangles),
        points_(memory.points),
        values_(memory.values),
        crossings_(memory.crossings) {}

  /// Adds the integrals over an overlap; columns of the nodes of the master are given, and with them
  /// rows.
  ANISOCONTACT_INLINE void add(const SlavePart& part, const Overlap& o, const Facet& master,
                               const std::array<std::size_t, most>& columns) {
    static constexpr std::array<std::size_t, 4> straight{0, 1, 2, 3};
    const detail::InPart own(*o.slave, straight, o.corners, 0),
        other(*o.master, o.order, o.corners, 4);
    const bool both = own.straight() && other.straight();
    const TriangleRule& rule = both ? rules_.straight : rules_.skew;
    const std::size_t slaves = slave_.nodes(), rows = slaves + master.nodes();
    if (!find(o, rule, own, other, master.topology)) return;
    const detail::ByNodes by(part.plane(), o, slave_, master, part.scaled());
    if (slopes_) cross(o);
    for (std::size_t r = 0; r < rows; ++r) {
      const std::size_t place = r < slaves ? r : columns[r - slaves] / 3;
      Row row;
      if (r < slaves)
        integrate<false>(r, rule, row);
      else
        integrate<true>(r, rule, row);
      out_.value[place].add(part.plane().scale, row.value);
      if (!slopes_) continue;
      spread(o, row);
      by.add(row.corner, row.value, columns, out_.slope.data() + place * out_.columns);
    }
  }

 private:
  using Batch = detail::Batch;
  static constexpr std::size_t batch = detail::batch;

  using Memory = IntegratorMemory<L>;
  using Values = typename Memory::Values;
  using AtPoint = typename Memory::AtPoint;
  using Triangle = typename Memory::Triangle;

  /// Integrals of a row, and their derivatives by vertices and corners.
  struct Row {
    Lanes<L> value;
    std::array<Twins<L>, 9> vertex;
    detail::ByCorners<L> corner;
  };

  /// Functions at all points of the quadrature; whether all were found.
  ANISOCONTACT_INLINE bool find(const Overlap& o, const TriangleRule& rule,
                                const detail::InPart& own, const detail::InPart& other,
                                Topology master) {
    const Polygon& p = o.polygon;
    triangles_.resize(p.count - 2);
    const std::size_t count = triangles_.size() * rule.count;
    points_.resize(count);
    values_.resize((count + batch - 1) / batch);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const Point &a = p.vertex[0].x, &b = p.vertex[i + 1].x, &c = p.vertex[i + 2].x;
      const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
      triangles_[i] = {bx * cy - by * cx, {{{by - cy, cx - bx}, {cy, -cx}, {-by, bx}}}};
    }
    std::size_t i = 0, q = 0;  // triangle, and point of its rule
    for (std::size_t b = 0; b < values_.size(); ++b) {
      const std::size_t first = b * batch, end = std::min(first + batch, count);
      detail::PlanePoints x, s;
      Batch twice;
      for (std::size_t l = 0; l < batch; ++l) {
        const double u = rule.points[2 * q], v = rule.points[2 * q + 1], w = 1.0 - u - v;
        for (std::size_t d = 0; d < 2; ++d)
          x[d].set(l, w * p.vertex[0].x[d] + u * p.vertex[i + 1].x[d] + v * p.vertex[i + 2].x[d]);
        twice.set(l, -triangles_[i].twice);
        if (first + l + 1 < count && ++q == rule.count) {
          q = 0;
          ++i;
        }
      }
      if (!own.locate(x, s)) return false;
      Values& to = values_[b];
      own.functions(slave_.topology, true, s, &to.corner[0], &to.value[0],
                    slopes_ ? &to.slope[0] : nullptr);
      weigh(rule, first, end, to);
      if (!other.locate(x, s)) return false;
      const std::size_t k = slave_.nodes();
      other.functions(master, false, s, &to.corner[4], &to.value[k],
                      slopes_ ? &to.slope[k] : nullptr);
      for (Batch& one : to.corner) one = twice * one;
    }
    return true;
  }

  /// Functions of the slave at points [first, end), side by side for each.
  ANISOCONTACT_INLINE void weigh(const TriangleRule& rule, std::size_t first, std::size_t end,
                                 const Values& from) {
    std::size_t q = first % rule.count;
    for (std::size_t n = first; n < end; ++n, q = q + 1 == rule.count ? 0 : q + 1) {
      AtPoint& to = points_[n];
      const double weight = rule.weights[q];
      for (std::size_t i = 0; i < slave_.nodes(); ++i) {
        const double N = weight * from.value[i][n - first];
        to.first.set(Twins<L>::place(0, i), N);
        if (!slopes_) continue;
        to.second.set(Twins<L>::place(1, i), N);
        for (std::size_t d = 0; d < 2; ++d)
          to.dN.set(Twins<L>::place(d, i), weight * from.slope[i][d][n - first]);
      }
    }
  }

  /// Integrals of N times a function, of the slave or of the master; where a corner moves, so do
  /// functions of its side the other way.
  template <bool master>
  ANISOCONTACT_INLINE void integrate(std::size_t r, const TriangleRule& rule, Row& row) const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const Triangle& t = triangles_[i];
      Twins<L> first, second;  // the integral as first components, and as second ones
      std::array<Twins<L>, 3> vertex;
      for (std::size_t q = 0; q < rule.count; ++q, ++n) {
        const AtPoint& p = points_[n];
        const Values& at = values_[n / batch];
        const std::size_t l = n % batch;
        const double f = at.value[r][l];
        first.add(f, p.first);
        if (!slopes_) continue;
        second.add(f, p.second);
        const auto own = f * p.dN,
                   other = at.slope[r][0][l] * p.first + at.slope[r][1][l] * p.second,
                   both = own + other;
        const double u = rule.points[2 * q], v = rule.points[2 * q + 1];
        vertex[0].add(1.0 - u - v, both);
        vertex[1].add(u, both);
        vertex[2].add(v, both);
        each<4>([&](std::size_t k) ANISOCONTACT_INLINE_LAMBDA {
          row.corner[k].add(at.corner[k][l], master ? own : both);
          if (master) row.corner[4 + k].add(at.corner[4 + k][l], other);
        });
      }
      row.value.add(t.twice, first.part(0));
      if (!slopes_) continue;
      const std::array<std::size_t, 3> place{0, i + 1, i + 2};
      each<3>([&](std::size_t k) ANISOCONTACT_INLINE_LAMBDA {
        vertex[k] = t.twice * vertex[k];
        vertex[k].add(t.grown[k][0], first);
        vertex[k].add(t.grown[k][1], second);
        row.vertex[place[k]] += vertex[k];
      });
    }
  }

  /// How the vertices of an overlap follow corners.
  ANISOCONTACT_INLINE void cross(const Overlap& o) {
    crossings_.clear();
    for (std::size_t v = 0; v < o.polygon.count; ++v)
      if (o.polygon.vertex[v].crosses()) crossings_.emplace_back(o.corners, o.polygon.vertex[v]);
  }

  /// Vertices follow corners.
  ANISOCONTACT_INLINE void spread(const Overlap& o, Row& row) const {
    std::size_t next = 0;
    for (std::size_t v = 0; v < o.polygon.count; ++v) {
      const Vertex& vertex = o.polygon.vertex[v];
      const Lanes<L> first = row.vertex[v].part(0), second = row.vertex[v].part(1);
      if (!vertex.crosses()) {
        row.corner[vertex.from[0]].add_part(0, first);
        row.corner[vertex.from[0]].add_part(1, second);
        continue;
      }
      const Crossing& x = crossings_[next++];
      for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t k = 0; k < 2; ++k)
          row.corner[x.corner[c]].add_part(k, x.by[c][0][k] * first + x.by[c][1][k] * second);
    }
  }

  const Facet& slave_;
  const Rules& rules_;
  Integrals<L>& out_;
  bool slopes_;
  std::vector<Triangle>& triangles_;
  std::vector<AtPoint>& points_;
  std::vector<Values>& values_;
  std::vector<Crossing>& crossings_;
};

}  // namespace anisocontact::mortar
