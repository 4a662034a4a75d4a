#pragma once
// Quadrature over the polygon of an overlap, and derivatives backwards from the integrals to the nodes.

#include <Eigen/Dense>
#include <vector>

#include "anisocontact/mortar/overlap.hpp"

namespace anisocontact::mortar {

namespace detail {

/// Coordinates on a facet of points of the plane, through one of its parts.
class InPart {
 public:
  static constexpr std::size_t batch = 4;
  using Batch = Lanes<batch>;

  /// `order` are the corners of the part as they are in the plane, from `first` on.
  InPart(const SubFacet& part, const std::array<std::size_t, 4>& order, const Corners& corners,
         std::size_t first)
      : part_(part), order_(order) {
    const Point *p = corners.x.data() + first, last = part.corners == 3 ? p[2] : p[3];
    for (std::size_t i = 0; i < 2; ++i)
      c_[i] = {p[0][i], p[1][i] - p[0][i], last[i] - p[0][i],
               part.corners == 3 ? 0.0 : p[0][i] - p[1][i] + p[2][i] - last[i]};
  }

  /// Whether shape functions of the part are polynomials of the position, to rounding.
  bool straight() const {
    constexpr double rounding = 1e-9;
    return std::abs(c_[0][3]) + std::abs(c_[1][3]) <
           rounding * (std::abs(c_[0][1] + c_[0][2]) + std::abs(c_[1][1] + c_[1][2])) +
               std::numeric_limits<double>::min();
  }

  /// Solves for the coordinates of points, from the middle of the part.
  ANISOCONTACT_INLINE bool locate(const std::array<Batch, 2>& x, std::array<Batch, 2>& s) const {
    constexpr int iterations = 20;
    constexpr double converged = 1e-14, enough = 1e-10;
    for (std::size_t l = 0; l < batch; ++l) s[0][l] = s[1][l] = part_.corners == 3 ? 0.3 : 0.5;
    for (int it = 0; it < iterations; ++it) {
      Batch step;
      for (std::size_t l = 0; l < batch; ++l) {
        const double u = s[0][l], v = s[1][l];
        double r[2], j[2][2];
        for (std::size_t i = 0; i < 2; ++i) {
          const auto& c = c_[i];
          r[i] = x[i][l] - (c[0] + c[1] * u + (c[2] + c[3] * u) * v);
          j[i][0] = c[1] + c[3] * v;
          j[i][1] = c[2] + c[3] * u;
        }
        const double inverse = 1.0 / (j[0][0] * j[1][1] - j[0][1] * j[1][0]);
        const double du = inverse * (j[1][1] * r[0] - j[0][1] * r[1]),
                     dv = inverse * (j[0][0] * r[1] - j[1][0] * r[0]);
        s[0][l] = u + du;
        s[1][l] = v + dv;
        step[l] = std::abs(du) + std::abs(dv);
      }
      const double largest = std::max(std::max(step[0], step[1]), std::max(step[2], step[3]));
      if (!std::isfinite(step[0] + step[1] + step[2] + step[3])) return false;
      if (part_.corners == 3 || largest < converged || (it > 6 && largest < enough)) return true;
    }
    return false;
  }

  /// Shape functions of the corners, in the order of the part, and of the facet at coordinates on the part, their gradients by
  /// the coordinates on the facet; returns the derivative of the latter by the position.
  ANISOCONTACT_INLINE std::array<Point, 2> shape(Topology t, double s0, double s1,
                                                 std::array<double, 4>& corner,
                                                 surface::Shape<double>& shape) const {
    const CornerShape f(part_.corners, s0, s1);
    corner = f.N;
    Point at{0.0, 0.0};
    std::array<Point, 2> by{};
    const double j00 = c_[0][1] + c_[0][3] * s1, j01 = c_[0][2] + c_[0][3] * s0,
                 j10 = c_[1][1] + c_[1][3] * s1, j11 = c_[1][2] + c_[1][3] * s0,
                 inverse = 1.0 / (j00 * j11 - j01 * j10);
    for (std::size_t a = 0; a < part_.corners; ++a) {
      const double along = inverse * (f.dN[a][0] * j11 - f.dN[a][1] * j10),
                   across = inverse * (f.dN[a][1] * j00 - f.dN[a][0] * j01);
      const Point& on = part_.at[order_[a]];
      for (std::size_t i = 0; i < 2; ++i) {
        at[i] += f.N[a] * on[i];
        by[i][0] += on[i] * along;
        by[i][1] += on[i] * across;
      }
    }
    surface::shape(t, at[0], at[1], shape);
    return by;
  }

 private:
  const SubFacet& part_;
  const std::array<std::size_t, 4>& order_;
  std::array<std::array<double, 4>, 2> c_{};  ///< x = c_0 + c_1 s + c_2 t + c_3 s t
};

/// A point of the quadrature.
template <std::size_t L>
struct QuadraturePoint {
  double weight;
  std::array<double, 3> vertex;                       ///< shares of the vertices of the triangle
  std::array<double, 4> slave_corner, master_corner;  ///< of the corners of both parts
  Lanes<L> N;
  std::array<Lanes<L>, 2> dN;  ///< by the position
  std::array<double, most> M;
  std::array<Point, most> dM;
};

/// Gradient of the integrals of a row by corners of both parts, (8, 2).
template <std::size_t L>
using ByCorners = std::array<std::array<Lanes<L>, 2>, 8>;

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
      for (std::size_t i = 0; i < 3; ++i) {
        const auto d = plane_.scale * (e(0, i) * g[corner][0] + e(1, i) * g[corner][1]);
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

/// Integrates over overlaps of a slave facet; keeps its memory from one to the next.
template <std::size_t L>
class Integrator {
 public:
  Integrator(const Facet& slave, const Rules& rules, Integrals<L>& out)
      : slave_(slave), rules_(rules), out_(out), slopes_(!out.slope.empty()) {}

  /// Adds the integrals over an overlap; columns of the nodes of the master are given, and with them
  /// rows.
  ANISOCONTACT_INLINE void add(const SlavePart& part, const Overlap& o, const Facet& master,
                               const std::array<std::size_t, most>& columns) {
    static constexpr std::array<std::size_t, 4> straight{0, 1, 2, 3};
    const detail::InPart own(*o.slave, straight, o.corners, 0),
        other(*o.master, o.order, o.corners, 4);
    const bool both = own.straight() && other.straight();
    const TriangleRule& rule = both ? rules_.straight : rules_.skew;
    const std::size_t rows = slave_.nodes() + master.nodes(), triangles = o.polygon.count - 2;
    if (!locate(o, rule, own, other)) return;
    for (std::size_t r = 0; r < rows; ++r) {
      value_[r] = {};
      if (!slopes_) continue;
      vertex_[r] = {};
      corner_[r] = {};
    }
    for (std::size_t i = 0; i < triangles; ++i) {
      shapes(i, rule, own, other, master.topology);
      triangle(o, i, rule.count, master.nodes());
    }
    const auto place = [&](std::size_t r) {
      return r < slave_.nodes() ? r : columns[r - slave_.nodes()] / 3;
    };
    for (std::size_t r = 0; r < rows; ++r) out_.value[place(r)].add(part.plane().scale, value_[r]);
    if (!slopes_) return;
    spread(o, rows);
    const detail::ByNodes by(part.plane(), o, slave_, master, part.scaled());
    for (std::size_t r = 0; r < rows; ++r)
      by.add(corner_[r], value_[r], columns, out_.slope.data() + place(r) * out_.columns);
  }

 private:
  using Batch = detail::InPart::Batch;
  static constexpr std::size_t batch = detail::InPart::batch;

  /// Coordinates on both parts of all points of the quadrature.
  ANISOCONTACT_INLINE bool locate(const Overlap& o, const TriangleRule& rule,
                                  const detail::InPart& own, const detail::InPart& other) {
    const Polygon& p = o.polygon;
    const std::size_t count = (p.count - 2) * rule.count;
    at_.resize((count + batch - 1) / batch);
    std::size_t n = 0;
    for (std::size_t i = 1; i + 1 < p.count; ++i) {
      const Point &a = p.vertex[0].x, &b = p.vertex[i].x, &c = p.vertex[i + 1].x;
      for (std::size_t q = 0; q < rule.count; ++q, ++n) {
        const double s = rule.points[2 * q], t = rule.points[2 * q + 1], r = 1.0 - s - t;
        for (std::size_t d = 0; d < 2; ++d)
          at_[n / batch].x[d][n % batch] = r * a[d] + s * b[d] + t * c[d];
      }
    }
    for (; n % batch != 0; ++n)
      for (std::size_t d = 0; d < 2; ++d) at_[n / batch].x[d][n % batch] = at_[n / batch].x[d][0];
    for (auto& one : at_)
      if (!own.locate(one.x, one.own) || !other.locate(one.x, one.other)) return false;
    return true;
  }

  /// Shape functions at the points of a triangle.
  ANISOCONTACT_INLINE void shapes(std::size_t triangle, const TriangleRule& rule,
                                  const detail::InPart& own, const detail::InPart& other,
                                  Topology master) {
    points_.resize(rule.count);
    for (std::size_t q = 0; q < rule.count; ++q) {
      auto& to = points_[q];
      const std::size_t n = triangle * rule.count + q;
      const auto& at = at_[n / batch];
      const std::size_t l = n % batch;
      const double s = rule.points[2 * q], t = rule.points[2 * q + 1];
      to.weight = rule.weights[q];
      to.vertex = {1.0 - s - t, s, t};
      surface::Shape<double> shape;
      auto by = own.shape(slave_.topology, at.own[0][l], at.own[1][l], to.slave_corner, shape);
      transform(slave_.topology, shape);
      for (std::size_t i = 0; i < slave_.nodes(); ++i) {
        to.N[i] = shape.N[i];
        for (std::size_t d = 0; d < 2; ++d)
          to.dN[d][i] = shape.dN[i][0] * by[0][d] + shape.dN[i][1] * by[1][d];
      }
      by = other.shape(master, at.other[0][l], at.other[1][l], to.master_corner, shape);
      for (std::size_t k = 0; k < surface::node_count(master); ++k) {
        to.M[k] = shape.N[k];
        for (std::size_t d = 0; d < 2; ++d)
          to.dM[k][d] = shape.dN[k][0] * by[0][d] + shape.dN[k][1] * by[1][d];
      }
    }
  }

  /// Adds a triangle: integrals, and how they follow vertices and corners.
  ANISOCONTACT_INLINE void triangle(const Overlap& o, std::size_t which, std::size_t count,
                                    std::size_t masters) {
    const std::array<std::size_t, 3> v{0, which + 1, which + 2};
    const Point &a = o.polygon.vertex[v[0]].x, &b = o.polygon.vertex[v[1]].x,
                &c = o.polygon.vertex[v[2]].x;
    const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1],
                 twice = bx * cy - by * cx;
    const std::array<Point, 3> grown{{{by - cy, cx - bx}, {cy, -cx}, {-by, bx}}};
    const std::size_t slaves = slave_.nodes();
    for (std::size_t r = 0; r < slaves + masters; ++r) {
      Row row;
      if (r < slaves)
        own_row(r, count, row);
      else
        master_row(r - slaves, count, row);
      value_[r].add(twice, row.value);
      if (!slopes_) continue;
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t d = 0; d < 2; ++d) {
          vertex_[r][v[k]][d].add(twice, row.vertex[k][d]);
          vertex_[r][v[k]][d].add(grown[k][d], row.value);
        }
      for (std::size_t k = 0; k < 8; ++k)
        for (std::size_t d = 0; d < 2; ++d) corner_[r][k][d].add(-twice, row.corner[k][d]);
    }
  }

  /// Sums over the points of a triangle.
  struct Row {
    Lanes<L> value;
    std::array<std::array<Lanes<L>, 2>, 3> vertex;
    detail::ByCorners<L> corner;
  };

  /// Of N N_j; where a corner moves, so do functions the other way.
  ANISOCONTACT_INLINE void own_row(std::size_t j, std::size_t count, Row& row) const {
    for (std::size_t q = 0; q < count; ++q) {
      const auto& p = points_[q];
      const double f = p.weight * p.N[j];
      row.value.add(f, p.N);
      if (!slopes_) continue;
      for (std::size_t d = 0; d < 2; ++d) {
        const auto slope = f * p.dN[d] + (p.weight * p.dN[d][j]) * p.N;
        for (std::size_t k = 0; k < 3; ++k) row.vertex[k][d].add(p.vertex[k], slope);
        for (std::size_t k = 0; k < 4; ++k) row.corner[k][d].add(p.slave_corner[k], slope);
      }
    }
  }
  /// Of N M_k.
  ANISOCONTACT_INLINE void master_row(std::size_t j, std::size_t count, Row& row) const {
    for (std::size_t q = 0; q < count; ++q) {
      const auto& p = points_[q];
      const double f = p.weight * p.M[j];
      row.value.add(f, p.N);
      if (!slopes_) continue;
      for (std::size_t d = 0; d < 2; ++d) {
        const auto own = f * p.dN[d], other = (p.weight * p.dM[j][d]) * p.N, both = own + other;
        for (std::size_t k = 0; k < 3; ++k) row.vertex[k][d].add(p.vertex[k], both);
        for (std::size_t k = 0; k < 4; ++k) row.corner[k][d].add(p.slave_corner[k], own);
        for (std::size_t k = 0; k < 4; ++k) row.corner[4 + k][d].add(p.master_corner[k], other);
      }
    }
  }

  /// Vertices follow corners.
  ANISOCONTACT_INLINE void spread(const Overlap& o, std::size_t rows) {
    for (std::size_t v = 0; v < o.polygon.count; ++v) {
      const Vertex& vertex = o.polygon.vertex[v];
      if (vertex.from[0] == vertex.from[1]) {
        for (std::size_t r = 0; r < rows; ++r)
          for (std::size_t d = 0; d < 2; ++d)
            corner_[r][vertex.from[0]][d].add(1.0, vertex_[r][v][d]);
        continue;
      }
      const Crossing x(o.corners, vertex);
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < 4; ++c)
          for (std::size_t k = 0; k < 2; ++k)
            for (std::size_t d = 0; d < 2; ++d)
              corner_[r][x.corner[c]][k].add(x.by[c][d][k], vertex_[r][v][d]);
    }
  }

  const Facet& slave_;
  const Rules& rules_;
  Integrals<L>& out_;
  bool slopes_;
  /// Points in the plane and on both parts.
  struct Located {
    std::array<Batch, 2> x, own, other;
  };
  std::vector<Located> at_;
  std::vector<detail::QuadraturePoint<L>> points_;
  std::array<Lanes<L>, 2 * most> value_;
  std::array<std::array<std::array<Lanes<L>, 2>, 9>, 2 * most> vertex_;
  std::array<detail::ByCorners<L>, 2 * most> corner_;
};

}  // namespace anisocontact::mortar
