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
inline void transform(Topology t, surface::Shape<double>& s) {
  if (t != Topology::tri6) return;
  constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{1, 2}, {0, 2}, {0, 1}}};
  for (std::size_t e = 0; e < 3; ++e) {
    const std::size_t k = 3 + e;
    for (const std::size_t v : ends[e]) {
      s.N[v] += edge_share * s.N[k];
      for (std::size_t i = 0; i < 2; ++i) s.dN[v][i] += edge_share * s.dN[k][i];
    }
    s.N[k] *= 1.0 - 2.0 * edge_share;
    for (std::size_t i = 0; i < 2; ++i) s.dN[k][i] *= 1.0 - 2.0 * edge_share;
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

/// Numbers side by side, one for each function of a slave facet, so that they share registers.
template <std::size_t L>
struct alignas(32) Lanes {
  std::array<double, L> v{};

  double& operator[](std::size_t l) { return v[l]; }
  double operator[](std::size_t l) const { return v[l]; }
  /// this += f other
  ANISOCONTACT_INLINE void add(double f, const Lanes& other) {
    each_register([&](std::size_t l, auto& x, auto& y) ANISOCONTACT_INLINE_LAMBDA {
      std::memcpy(&x, other.v.data() + l, sizeof x);
      std::memcpy(&y, v.data() + l, sizeof y);
      y += f * x;
      std::memcpy(v.data() + l, &y, sizeof y);
    });
  }
  ANISOCONTACT_INLINE friend Lanes operator*(double f, const Lanes& factor) {
    Lanes out;
    each_register([&](std::size_t l, auto& x, auto& y) ANISOCONTACT_INLINE_LAMBDA {
      std::memcpy(&x, factor.v.data() + l, sizeof x);
      y = f * x;
      std::memcpy(out.v.data() + l, &y, sizeof y);
    });
    return out;
  }
  ANISOCONTACT_INLINE friend Lanes operator+(const Lanes& x, const Lanes& y) {
    Lanes out = x;
    out.add(1.0, y);
    return out;
  }

 private:
#if defined(__GNUC__)
  using Register = double __attribute__((vector_size(32)));
#else
  using Register = double;
#endif
  template <class F>
  ANISOCONTACT_INLINE static void each_register(const F& f) {
    Register x, y;
    for (std::size_t l = 0; l < L; l += sizeof(Register) / sizeof(double)) f(l, x, y);
  }
};

/// Calls f with a number of lanes that so many functions fit in, as a constant.
template <class F>
auto with_lanes(std::size_t functions, const F& f) {
  using std::integral_constant;
  if (functions <= 4) return f(integral_constant<std::size_t, 4>{});
  if (functions <= 8) return f(integral_constant<std::size_t, 8>{});
  return f(integral_constant<std::size_t, 12>{});
}

/// Integrals over overlaps with their derivatives: rows are the functions j of the slave, whose lanes
/// are m_ij, then those of the master, c_ik; columns three for each node of the slave, then of the
/// master.
template <std::size_t L>
struct Integrals {
  std::size_t rows{0}, columns{0};
  std::vector<Lanes<L>> value, slope;  ///< (rows,), (rows, columns)

  Integrals(std::size_t slaves, std::size_t masters, bool slopes)
      : rows(slaves + masters),
        columns(3 * rows),
        value(rows),
        slope(slopes ? rows * columns : 0) {}
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
      Overlap o{&part_, &other, facet, {0, 1, 2, 3}, corners_, {}};
      if (overlap(master, o)) out.push_back(o);
    }
  }

  const Plane& plane() const { return plane_; }
  bool scaled() const { return scaled_; }

 private:
  /// Below this share of the part an overlap is rounding.
  static constexpr double sliver = 1e-13;

  bool overlap(const Facet& master, Overlap& o) const {
    const std::size_t count = o.master->corners;
    Polygon other;
    other.count = o.corners.masters = count;
    for (std::size_t a = 0; a < count; ++a)
      other.vertex[a].x = plane_.flat(master.x[o.master->node[a]]);
    if (other.area() < 0.0)
      for (std::size_t a = 1; a < count; ++a) o.order[a] = count - a;
    for (std::size_t a = 0; a < count; ++a) o.corners.x[4 + a] = other.vertex[o.order[a]].x;
    if (apart(o.corners)) return false;
    Polygon next;
    o.polygon = subject_;
    for (std::size_t a = 0; a < count && o.polygon.count > 2; ++a) {
      clip(o.polygon, o.corners, 4 + a, next);
      std::swap(o.polygon, next);
    }
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
      const auto &at = at_[n / batch], l = n % batch;
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
