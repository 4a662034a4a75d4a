#pragma once
// Integrals over the overlap of a facet of the slave and one of the master:
//   m_ij = integral of N_i N_j,   c_ik = integral of N_i M_k ,
// N the (transformed) shape functions of the slave, M those of the master, over the plane at the
// middle of each part of the slave facet, along its normal [Puso Laursen 2004]; with their exact
// derivatives by the nodes of both.

#include <Eigen/Dense>
#include <cmath>
#include <limits>

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

/// Largest sizes: nine nodes on both sides.
inline constexpr std::size_t most = max_facet_nodes;

/// The integrals of a pair and their derivatives by nodes: three columns for each node of the slave,
/// then of the master.
struct PairIntegrals {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix m, c;    ///< (slave, slave), (slave, master)
  Matrix dm, dc;  ///< (slave * slave, columns), (slave * master, columns)

  void reset(std::size_t slaves, std::size_t masters, bool slopes) {
    const auto s = static_cast<Eigen::Index>(slaves), k = static_cast<Eigen::Index>(masters);
    m.setZero(s, s);
    c.setZero(s, k);
    if (!slopes) return;
    dm.setZero(s * s, 3 * (s + k));
    dc.setZero(s * k, 3 * (s + k));
  }
};

namespace detail {

/// Coordinates on a facet of a point of the plane, through one of its parts, and how they follow.
class InPart {
 public:
  InPart(const SubFacet& part, const std::array<Vertex, 4>& corner, std::size_t first)
      : part_(part), corner_(corner), first_(first) {}

  /// Solves for the coordinates, starting from the last ones.
  bool locate(const std::array<double, 2>& x) {
    constexpr int iterations = 20;
    constexpr double converged = 1e-14;
    for (int it = 0; it < iterations; ++it) {
      const CornerShape f(part_.corners, s_[0], s_[1]);
      std::array<double, 2> r = x;
      double j[2][2] = {{0.0, 0.0}, {0.0, 0.0}};
      for (std::size_t a = 0; a < part_.corners; ++a)
        for (std::size_t i = 0; i < 2; ++i) {
          r[i] -= f.N[a] * corner_[a].x[i];
          for (std::size_t k = 0; k < 2; ++k) j[i][k] += f.dN[a][k] * corner_[a].x[i];
        }
      const double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
      if (!(std::abs(det) > 0.0)) return false;
      inverse_ = {{{j[1][1] / det, -j[0][1] / det}, {-j[1][0] / det, j[0][0] / det}}};
      double step = 0.0;
      for (std::size_t i = 0; i < 2; ++i) {
        const double d = inverse_[i][0] * r[0] + inverse_[i][1] * r[1];
        s_[i] += d;
        step = std::max(step, std::abs(d));
      }
      if (part_.corners == 3 || step < converged) return std::isfinite(step);
      if (it > 6 && step < 1e-10) return true;
    }
    s_ = {0.5, 0.5};
    return false;
  }

  /// Shape functions of the facet there.
  void shape(Topology t, surface::Shape<double>& s) const {
    const CornerShape f(part_.corners, s_[0], s_[1]);
    double u = 0.0, v = 0.0;
    for (std::size_t a = 0; a < part_.corners; ++a) {
      u += f.N[a] * part_.at[a][0];
      v += f.N[a] * part_.at[a][1];
    }
    surface::shape(t, u, v, s);
  }

  /// Changes of the coordinates on the facet where the point moves by dx.
  void follow(const std::array<Row, 2>& dx, std::array<Row, 2>& du) const {
    const CornerShape f(part_.corners, s_[0], s_[1]);
    std::array<Row, 2> r = dx;
    for (std::size_t a = 0; a < part_.corners; ++a)
      for (std::size_t i = 0; i < 2; ++i) r[i][2 * (first_ + a) + i] -= f.N[a];
    double by[2][2] = {{0.0, 0.0}, {0.0, 0.0}};  // of u by x
    for (std::size_t a = 0; a < part_.corners; ++a)
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k)
          by[i][k] += part_.at[a][i] * (f.dN[a][0] * inverse_[0][k] + f.dN[a][1] * inverse_[1][k]);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < plane_inputs; ++k)
        du[i][k] = by[i][0] * r[0][k] + by[i][1] * r[1][k];
  }

 private:
  const SubFacet& part_;
  const std::array<Vertex, 4>& corner_;
  std::size_t first_;
  std::array<double, 2> s_{0.4, 0.3};
  std::array<std::array<double, 2>, 2> inverse_{};
};

/// Integrals of one pair of parts as functions of the coordinates in the plane.
struct PlaneIntegrals {
  std::array<std::array<double, most>, most> m, c;
  std::array<std::array<Row, most>, most> dm, dc;

  void reset(std::size_t slaves, std::size_t masters, bool slopes) {
    for (std::size_t i = 0; i < slaves; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        m[i][j] = 0.0;
        if (slopes) dm[i][j].fill(0.0);
      }
      for (std::size_t k = 0; k < masters; ++k) {
        c[i][k] = 0.0;
        if (slopes) dc[i][k].fill(0.0);
      }
    }
  }
};

inline void slopes_of(const surface::Shape<double>& s, std::size_t count,
                      const std::array<Row, 2>& du, std::array<Row, most>& out) {
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t k = 0; k < plane_inputs; ++k)
      out[a][k] = s.dN[a][0] * du[0][k] + s.dN[a][1] * du[1][k];
}

/// Adds one point of the quadrature.
inline void add_point(std::size_t slaves, std::size_t masters, const surface::Shape<double>& N,
                      const surface::Shape<double>& M, double w, PlaneIntegrals& out) {
  for (std::size_t i = 0; i < slaves; ++i) {
    const double f = w * N.N[i];
    for (std::size_t j = 0; j <= i; ++j) out.m[i][j] += f * N.N[j];
    for (std::size_t k = 0; k < masters; ++k) out.c[i][k] += f * M.N[k];
  }
}
inline void add_slopes(std::size_t slaves, std::size_t masters, const surface::Shape<double>& N,
                       const surface::Shape<double>& M, double w, const Row& dw,
                       const std::array<Row, most>& dN, const std::array<Row, most>& dM,
                       PlaneIntegrals& out) {
  for (std::size_t i = 0; i < slaves; ++i) {
    const double f = w * N.N[i];
    Row df;
    for (std::size_t q = 0; q < plane_inputs; ++q) df[q] = dw[q] * N.N[i] + w * dN[i][q];
    for (std::size_t j = 0; j <= i; ++j)
      for (std::size_t q = 0; q < plane_inputs; ++q)
        out.dm[i][j][q] += df[q] * N.N[j] + f * dN[j][q];
    for (std::size_t k = 0; k < masters; ++k)
      for (std::size_t q = 0; q < plane_inputs; ++q)
        out.dc[i][k][q] += df[q] * M.N[k] + f * dM[k][q];
  }
}

/// Derivatives by coordinates in the plane as those by nodes: coordinates follow the nodes, and the
/// plane turns with the normal, d x_a = e_a . dx - h e_a . dn with the height h of a corner.
class ByNodes {
 public:
  ByNodes(const Plane& plane, const SubFacet& slave, const SubFacet& master, const Facet& of_slave,
          const Facet& of_master, const std::array<std::size_t, 4>& order)
      : plane_(plane), slave_(slave), master_(master), order_(order), slaves_(of_slave.nodes()) {
    for (std::size_t a = 0; a < slave.corners; ++a)
      height_[a] = plane.n.dot(of_slave.x[slave.node[a]] - plane.middle);
    for (std::size_t a = 0; a < master.corners; ++a)
      height_[4 + a] = plane.n.dot(of_master.x[master.node[order[a]]] - plane.middle);
  }

  /// Adds the derivative of a number: `g` by the plane, `value` where its scale changes with it.
  void add(const Row& g, double value, bool scaled, double* out) const {
    Vec3<double> lean = Vec3<double>::Zero();  // by dn
    const auto by = [&](std::size_t corner, std::size_t node) {
      const Vec3<double> d =
          plane_.scale * (g[2 * corner] * plane_.e[0] + g[2 * corner + 1] * plane_.e[1]);
      lean -= height_[corner] * d;
      put(out, node, d);
    };
    for (std::size_t a = 0; a < slave_.corners; ++a) by(a, slave_.node[a]);
    for (std::size_t a = 0; a < master_.corners; ++a) by(4 + a, slaves_ + master_.node[order_[a]]);
    // dn = (1 - n n)(dt_1 x t_2 + t_1 x dt_2) / |t_1 x t_2|; of the scale, - n . d(t_1 x t_2) / |..|
    Vec3<double> k = lean;
    if (scaled) k -= plane_.scale * value * plane_.n;
    k /= plane_.size;
    const Vec3<double> first = plane_.t[1].cross(k), second = k.cross(plane_.t[0]);
    for (std::size_t a = 0; a < slave_.corners; ++a)
      put(out, slave_.node[a], plane_.shape.dN[a][0] * first + plane_.shape.dN[a][1] * second);
  }

 private:
  static void put(double* out, std::size_t node, const Vec3<double>& v) {
    for (std::size_t i = 0; i < 3; ++i) out[3 * node + i] += v[static_cast<Eigen::Index>(i)];
  }

  const Plane& plane_;
  const SubFacet &slave_, &master_;
  const std::array<std::size_t, 4>& order_;
  std::size_t slaves_;
  std::array<double, 8> height_{};
};

}  // namespace detail

/// Overlaps of one part of a slave facet with facets of the master.
class Overlaps {
 public:
  Overlaps(const Facet& slave, const SubFacet& part, const Rules& rules, bool slopes)
      : slave_(slave), part_(part), plane_(part, slave), rules_(rules), slopes_(slopes) {
    subject_.count = part.corners;
    for (std::size_t a = 0; a < part.corners; ++a) {
      put_corner(plane_.flat(slave.x[part.node[a]]), a, slopes, corner_[a]);
      subject_.vertex[a] = corner_[a];
    }
    area_ = subject_.area();
    straight_ = straight(corner_, part.corners);
  }

  /// Counts areas as those of a reference configuration, where the facet has other positions.
  void scale_to(const Facet& reference) {
    plane_.scale = Plane(part_, reference).size / plane_.size;
    scaled_ = true;
  }

  /// Whether there is a plane.
  bool valid() const { return area_ > 0.0 && std::isfinite(area_); }

  /// Adds the integrals over the overlap with a facet of the master; whether there is any.
  bool add(const Facet& master, detail::PlaneIntegrals& work, PairIntegrals& out) const {
    bool any = false;
    for (const SubFacet& part : sub_facets(master.topology)) any |= add(master, part, work, out);
    return any;
  }

 private:
  /// Below this share of the part an overlap is rounding.
  static constexpr double sliver = 1e-13;

  bool add(const Facet& master, const SubFacet& part, detail::PlaneIntegrals& work,
           PairIntegrals& out) const {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::array<Vertex, 4> corner;
    Polygon other;
    other.count = part.corners;
    for (std::size_t a = 0; a < part.corners; ++a)
      other.vertex[a].x = plane_.flat(master.x[part.node[a]]);
    if (other.area() < 0.0)
      for (std::size_t a = 1; a < part.corners; ++a) order[a] = part.corners - a;
    for (std::size_t a = 0; a < part.corners; ++a)
      put_corner(plane_.flat(master.x[part.node[order[a]]]), 4 + a, slopes_, corner[a]);
    if (apart(corner, part.corners)) return false;
    Polygon overlap = subject_, next;
    for (std::size_t a = 0; a < part.corners && overlap.count > 2; ++a) {
      clip(overlap, corner[a], corner[a + 1 == part.corners ? 0 : a + 1], slopes_, next);
      std::swap(overlap, next);
    }
    if (overlap.count < 3 || !(overlap.area() > sliver * area_)) return false;
    SubFacet turned = part;
    for (std::size_t a = 0; a < part.corners; ++a) {
      turned.node[a] = part.node[order[a]];
      turned.at[a] = part.at[order[a]];
    }
    const std::size_t ns = slave_.nodes(), nm = master.nodes();
    work.reset(ns, nm, slopes_);
    if (!integrate(overlap, master, turned, corner, work)) return false;
    const detail::ByNodes by(plane_, part_, part, slave_, master, order);
    hand_over(work, by, ns, nm, out);
    return true;
  }

  /// Whether shape functions of a part are polynomials of the position, to rounding.
  static bool straight(const std::array<Vertex, 4>& corner, std::size_t count) {
    constexpr double rounding = 1e-9;
    if (count == 3) return true;
    double bent = 0.0, size = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto x = [&](std::size_t a) { return corner[a].x[i]; };
      bent += std::abs(x(0) - x(1) + x(2) - x(3));
      size += std::abs(x(2) - x(0));
    }
    return bent < rounding * size;
  }

  bool apart(const std::array<Vertex, 4>& corner, std::size_t count) const {
    for (std::size_t i = 0; i < 2; ++i) {
      double low = std::numeric_limits<double>::infinity(), high = -low, least = low,
             greatest = -low;
      for (std::size_t a = 0; a < part_.corners; ++a) {
        low = std::min(low, corner_[a].x[i]);
        high = std::max(high, corner_[a].x[i]);
      }
      for (std::size_t a = 0; a < count; ++a) {
        least = std::min(least, corner[a].x[i]);
        greatest = std::max(greatest, corner[a].x[i]);
      }
      if (!(least < high && greatest > low)) return true;
    }
    return false;
  }

  bool integrate(const Polygon& p, const Facet& master, const SubFacet& part,
                 const std::array<Vertex, 4>& corner, detail::PlaneIntegrals& out) const {
    detail::InPart own(part_, corner_, 0), other(part, corner, 4);
    const bool both = straight_ && straight(corner, part.corners);
    const TriangleRule& rule = both ? rules_.straight : rules_.skew;
    for (std::size_t i = 1; i + 1 < p.count; ++i)
      if (!triangle(p.vertex[0], p.vertex[i], p.vertex[i + 1], master, rule, own, other, out))
        return false;
    return true;
  }

  bool triangle(const Vertex& a, const Vertex& b, const Vertex& c, const Facet& master,
                const TriangleRule& rule, detail::InPart& own, detail::InPart& other,
                detail::PlaneIntegrals& out) const {
    const double bx = b.x[0] - a.x[0], by = b.x[1] - a.x[1], cx = c.x[0] - a.x[0],
                 cy = c.x[1] - a.x[1], twice = bx * cy - by * cx;
    Row grown{};
    if (slopes_)
      for (std::size_t k = 0; k < plane_inputs; ++k)
        grown[k] = (b.d[0][k] - a.d[0][k]) * cy + bx * (c.d[1][k] - a.d[1][k]) -
                   (b.d[1][k] - a.d[1][k]) * cx - by * (c.d[0][k] - a.d[0][k]);
    const std::size_t ns = slave_.nodes(), nm = master.nodes();
    surface::Shape<double> N, M;
    for (std::size_t q = 0; q < rule.count; ++q) {
      const double s = rule.points[2 * q], t = rule.points[2 * q + 1], r = 1.0 - s - t,
                   w = rule.weights[q];
      std::array<double, 2> x;
      for (std::size_t i = 0; i < 2; ++i) x[i] = r * a.x[i] + s * b.x[i] + t * c.x[i];
      if (!own.locate(x) || !other.locate(x)) return false;
      own.shape(slave_.topology, N);
      transform(slave_.topology, N);
      other.shape(master.topology, M);
      detail::add_point(ns, nm, N, M, w * twice, out);
      if (!slopes_) continue;
      std::array<Row, 2> dx, du;
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < plane_inputs; ++k)
          dx[i][k] = r * a.d[i][k] + s * b.d[i][k] + t * c.d[i][k];
      std::array<Row, most> dN, dM;
      own.follow(dx, du);
      detail::slopes_of(N, ns, du, dN);
      other.follow(dx, du);
      detail::slopes_of(M, nm, du, dM);
      Row dw;
      for (std::size_t k = 0; k < plane_inputs; ++k) dw[k] = w * grown[k];
      detail::add_slopes(ns, nm, N, M, w * twice, dw, dN, dM, out);
    }
    return true;
  }

  void hand_over(const detail::PlaneIntegrals& in, const detail::ByNodes& by, std::size_t ns,
                 std::size_t nm, PairIntegrals& out) const {
    const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i); };
    for (std::size_t i = 0; i < ns; ++i)
      for (std::size_t j = 0; j < ns; ++j) {
        const std::size_t a = std::max(i, j), b = std::min(i, j);
        out.m(at(i), at(j)) += plane_.scale * in.m[a][b];
        if (slopes_) by.add(in.dm[a][b], in.m[a][b], scaled_, out.dm.row(at(i * ns + j)).data());
      }
    for (std::size_t i = 0; i < ns; ++i)
      for (std::size_t k = 0; k < nm; ++k) {
        out.c(at(i), at(k)) += plane_.scale * in.c[i][k];
        if (slopes_) by.add(in.dc[i][k], in.c[i][k], scaled_, out.dc.row(at(i * nm + k)).data());
      }
  }

  const Facet& slave_;
  const SubFacet& part_;
  Plane plane_;
  Rules rules_;
  bool slopes_, straight_, scaled_{false};
  std::array<Vertex, 4> corner_;
  Polygon subject_;
  double area_;
};

}  // namespace anisocontact::mortar
