#pragma once
// Derivatives of tractions at slave nodes: what laws give by the nodes of the contact planes, carried
// on to what these are made of, see `MovingPart`.
//
// A plane has the averaged normal n of the slave. Material tangents d of the master at the place y that
// the node x meets along it, c . P (x - y) = 0 with the tangents c of its facet and P = I - n n, are turned
// into the plane, e = d - (d . n) / (1 + m . n) (m + n), m the normal of d_1, d_2. The place follows the
// slave point and the normal, and the mean of the master the weights.

#include <array>
#include <cmath>
#include <cstdint>

#include "anisocontact/mortar/couplings.hpp"

namespace anisocontact::mortar {

using Tangents = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

/// Two tangents at slave nodes and their derivatives by the coordinates, as sums over nodes.
struct TangentSums {
  std::size_t width;                ///< how many nodes
  const std::int32_t* node;         ///< (n, width), -1 for none
  const double *gradient, *second;  ///< (n, 2, width), (n, 2, 2, width)

  static Vec3<double> at(const double* x, std::int32_t node) {
    const double* const p = x + 3 * static_cast<std::ptrdiff_t>(node);
    return {p[0], p[1], p[2]};
  }
  /// Sum of values at the nodes, of nodes at x.
  Vec3<double> sum(std::size_t i, const double* values, const double* x) const {
    Vec3<double> out = Vec3<double>::Zero();
    for (std::size_t k = 0; k < width; ++k)
      if (const std::int32_t m = node[i * width + k]; m >= 0) out += values[k] * at(x, m);
    return out;
  }
  Tangents tangents(std::size_t i, const double* x) const {
    Tangents out;
    for (std::size_t a = 0; a < 2; ++a)
      out.row(static_cast<Eigen::Index>(a)) = sum(i, gradient + (2 * i + a) * width, x).transpose();
    return out;
  }
  Vec3<double> bend(std::size_t i, std::size_t a, std::size_t b, const double* x) const {
    return sum(i, second + (4 * i + 2 * a + b) * width, x);
  }
};

/// What is opposite to slave nodes, n of them.
struct OppositeView {
  std::size_t masters;         ///< how many
  const std::int32_t* master;  ///< (n, masters), -1 for none
  const double* share;         ///< (n, masters)
  const std::int32_t* facet;   ///< (n,), -1 for none
  const double *shape, *edge;  ///< of the facet (n, width), (n, 2), not a number inside a facet
  TangentSums own, material;   ///< of the facet; of the surface, continuous across edges

  Vec3<double> mean(std::size_t i, const double* x) const {
    Vec3<double> out = Vec3<double>::Zero();
    for (std::size_t k = i * masters; k < (i + 1) * masters; ++k)
      if (master[k] >= 0) out += share[k] * TangentSums::at(x, master[k]);
    return out;
  }
  Tangents tangents(std::size_t i, const double* x) const {
    return facet[i] < 0 ? Tangents(Tangents::Identity()) : material.tangents(i, x);
  }
};

/// Slave nodes with their contact planes.
struct PlanesView {
  const double *slave, *tangents;  ///< positions (n, 3), tangents of the slave (n, 2, 3)
  const double *normal, *held;     ///< (n, 3), (n, 3, 3)
  const double *now, *reference;   ///< positions of the nodes of both bodies
  const double *then, *carried;    ///< planes of the accepted increment, see `CarriedAxes`
  const double* area;              ///< weights of the slave nodes, (n,)
  OppositeView opposite;
};

namespace detail {

using Matrix2 = Eigen::Matrix2d;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

inline Matrix3 matrix3(const double* p) { return Eigen::Map<const Matrix3>(p); }

/// Tangents turned from their normal to that of a plane, with the way back.
class TurnedTangents {
 public:
  TurnedTangents(const Tangents& d, const Vec3<double>& n) : d_(d), n_(n) {
    m_ = d.row(0).transpose().cross(d.row(1).transpose()).normalized();
    const double both = 1.0 + m_.dot(n);
    share_ = both > 0.0 ? 1.0 / both : 0.0;
    for (Eigen::Index a = 0; a < 2; ++a) fall_[a] = d.row(a).dot(n) * share_;
    const Matrix2 metric = d * d.transpose();
    dual_ = metric.inverse() * d;
  }

  Tangents axes() const {
    Tangents out = d_;
    for (Eigen::Index a = 0; a < 2; ++a) out.row(a) -= fall_[a] * (m_ + n_).transpose();
    return out;
  }

  /// Derivatives by d, from those by e, and by n.
  Vec3<double> pull_back(Tangents& by) const {
    const Vec3<double> both = m_ + n_;
    Vec3<double> by_n = Vec3<double>::Zero(), fallen = Vec3<double>::Zero();
    double by_share = 0.0;
    for (Eigen::Index a = 0; a < 2; ++a) {
      const double along = by.row(a).dot(both) * share_;
      by_share += along * fall_[a];
      by_n -= along * d_.row(a).transpose();
      fallen += fall_[a] * by.row(a).transpose();
      by.row(a) -= along * n_.transpose();
    }
    by_n += by_share * m_ - fallen;
    const Vec3<double> by_m = by_share * n_ - fallen;
    // dm = - sum_a d^a (m . dd_a), d^a the dual tangents
    for (Eigen::Index a = 0; a < 2; ++a) by.row(a) -= dual_.row(a).dot(by_m) * m_.transpose();
    return by_n;
  }

 private:
  Tangents d_, dual_;
  Vec3<double> n_, m_;
  double share_;
  Eigen::Vector2d fall_;
};

/// Axes of a plane that are carried along with material tangents, e_a = A_ab d_b + B_a m, m the normal of
/// d_1, d_2: A, and B in the last column.
class CarriedAxes {
 public:
  CarriedAxes(const Tangents& d, const Tangents& by) : by_(by) {
    m_ = d.row(0).transpose().cross(d.row(1).transpose()).normalized();
    const Matrix2 metric = d * d.transpose();
    dual_ = metric.inverse() * d;
  }

  /// Derivatives by d in place of those by e.
  void pull_back(Vec3<double>& first, Vec3<double>& second) const {
    const Tangents e = (Tangents() << first.transpose(), second.transpose()).finished();
    const Matrix3 by = by_.transpose() * e;
    const Vec3<double> by_m = by.row(2).transpose();
    first = by.row(0).transpose() - dual_.row(0).dot(by_m) * m_;
    second = by.row(1).transpose() - dual_.row(1).dot(by_m) * m_;
  }

 private:
  Tangents by_, dual_;
  Vec3<double> m_;
};

/// How the normal of a plane follows the tangents of the slave, but along held directions.
class AveragedNormal {
 public:
  AveragedNormal(const Tangents& t, const Matrix3& held) : t_(t), held_(held) {
    const Vec3<double> cross = t.row(0).transpose().cross(t.row(1).transpose());
    size_ = cross.norm();
    unit_ = cross / size_;
    rest_ = unit_ - held * unit_;
    length_ = rest_.norm();
    rest_ /= length_;
  }

  Tangents pull_back(Vec3<double> by) const {
    by = (by - by.dot(rest_) * rest_) / length_;
    by -= held_.transpose() * by;
    // n = - unit; d unit = (1 - u u) (dt_1 x t_2 + t_1 x dt_2) / size
    const Vec3<double> k = -(by - by.dot(unit_) * unit_) / size_;
    Tangents out;
    out.row(0) = t_.row(1).transpose().cross(k).transpose();
    out.row(1) = k.cross(t_.row(0).transpose()).transpose();
    return out;
  }

 private:
  Tangents t_;
  Matrix3 held_;
  Vec3<double> unit_, rest_;
  double size_, length_;
};

/// How tangents of the master follow the place where they are taken, and it the slave point and n:
///   d d_a = (d_ab - d_c (D^c . D_ab)) d xi^b , less what the reference turns, in which directions are
///   taken;
///   d xi^b = w^ba [c_a . P (dx - dy) + dc_a . r - (s c_a + (c_a . n) r) . dn] .
struct PlaceSlopes {
  std::array<std::array<Vec3<double>, 2>, 2> turn;
  Tangents c, along;  ///< of the facet; w c P
  Matrix2 w;
  Vec3<double> n, apart;  ///< apart: r = P (x - y)
  double distance;        ///< s = n . (x - y)

  PlaceSlopes(const PlanesView& p, std::size_t i, const Tangents& d, const Tangents& dual)
      : n(p.normal + 3 * i) {
    const OppositeView& o = p.opposite;
    c = o.facet[i] < 0 ? d : o.own.tangents(i, p.now);
    apart = TangentSums::at(p.slave, static_cast<std::int32_t>(i)) -
            o.own.sum(i, o.shape + i * o.own.width, p.now);
    distance = n.dot(apart);
    apart -= distance * n;
    const Tangents across = c - (c * n) * n.transpose();
    Matrix2 metric = across * across.transpose();
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 0; b < 2; ++b) {
        turn[a][b] = o.material.bend(i, a, b, p.now) -
                     d.transpose() * (dual * o.material.bend(i, a, b, p.reference));
        metric(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) -=
            o.own.bend(i, a, b, p.now).dot(apart);
      }
    const Eigen::Vector2d e(o.edge[2 * i], o.edge[2 * i + 1]);
    if (std::isnan(e[0])) {
      w = metric.inverse();
    } else {
      const double slope = e.dot(metric * e);
      w = e * e.transpose() / (slope == 0.0 ? 1.0 : slope);
    }
    along = w * across;
  }

  /// Derivative by n, from that by d xi, through `lean` = w^T of it.
  Vec3<double> by_normal(const Eigen::Vector2d& lean) const {
    const Vec3<double> way = c.transpose() * lean;
    return -distance * way - n.dot(way) * apart;
  }
};

}  // namespace detail

/// Writes the derivatives of the traction of a slave node by the moving parts, (parts, 3, 3), and by
/// the weights, (masters, 3), from those by the nodes of the planes, (3, 27).
inline void plane_slopes(const PlanesView& p, std::size_t i, const double* by_nodes, double* by,
                         double* lift) {
  using Eigen::Index;
  const OppositeView& o = p.opposite;
  const Tangents d = o.tangents(i, p.now), then = o.tangents(i, p.reference);
  const detail::Matrix2 metric = then * then.transpose();
  const Tangents dual = metric.inverse() * then;
  const detail::TurnedTangents turned(d, Vec3<double>(p.normal + 3 * i));
  const detail::Matrix3 held = detail::matrix3(p.held + 9 * i);
  const detail::AveragedNormal normal(Eigen::Map<const Tangents>(p.tangents + 6 * i), held);
  const detail::PlaceSlopes place(p, i, d, dual);
  const detail::CarriedAxes carried(Eigen::Map<const Tangents>(p.then + 6 * i),
                                    Eigen::Map<const Tangents>(p.carried + 6 * i));
  detail::Matrix3 by_mean;
  for (std::size_t r = 0; r < 3; ++r) {
    std::array<std::array<Vec3<double>, 3>, 3> g;  // by part and node of it
    for (std::size_t part = 0; part < 3; ++part) {
      for (std::size_t k = 0; k < 3; ++k)
        g[part][k] = Vec3<double>(by_nodes + 27 * r + 9 * part + 3 * k);
      g[part][0] += g[part][1] + g[part][2];
    }
    carried.pull_back(g[2][1], g[2][2]);
    Tangents axes;
    axes << g[1][1].transpose(), g[1][2].transpose();
    Vec3<double> by_normal = turned.pull_back(axes);
    for (std::size_t part = 1; part < 3; ++part) {  // both means follow the slave point there
      const Vec3<double> along = held.transpose() * g[part][0];
      g[part][0] -= along;
      g[0][0] += along;
    }
    Eigen::Vector2d by_place = Eigen::Vector2d::Zero();
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 0; b < 2; ++b)
        by_place[static_cast<Index>(b)] += axes.row(static_cast<Index>(a)).dot(place.turn[a][b]);
    const Vec3<double> foot = place.along.transpose() * by_place;
    const Eigen::Vector2d lean = place.w.transpose() * by_place;
    by_normal += place.by_normal(lean);
    const Tangents own = normal.pull_back(by_normal);
    for (std::size_t a = 0; a < 2; ++a) {
      const auto row = static_cast<Index>(a);
      g[1][1 + a] = axes.row(row).transpose();
      g[0][1 + a] += own.row(row).transpose();
    }
    g[0][0] += foot;
    const auto put = [&](std::size_t part, const Vec3<double>& v) {
      std::copy(v.data(), v.data() + 3, by + part * block_size + 3 * r);
    };
    for (std::size_t part = 0; part < 9; ++part) put(part, g[part / 3][part % 3]);
    put(9, -foot);
    put(10, lean[0] * place.apart);
    put(11, lean[1] * place.apart);
    by_mean.row(static_cast<Index>(r)) = g[1][0].transpose();
  }
  // the mean moves along the plane less what the point of the reference moves there, at which
  // directions are taken: on a master that keeps its shape both are the same
  const double share = p.area[i] > 0.0 ? 1.0 / p.area[i] : 0.0;
  const detail::Matrix3 follow = turned.axes().transpose() * dual;
  const Vec3<double> mean = o.mean(i, p.now), material = o.mean(i, p.reference);
  for (std::size_t k = 0; k < o.masters; ++k) {
    const std::int32_t m = o.master[i * o.masters + k];
    Vec3<double> way = Vec3<double>::Zero();
    if (m >= 0)
      way = share * (TangentSums::at(p.now, m) - mean -
                     follow * (TangentSums::at(p.reference, m) - material));
    const Vec3<double> v = by_mean * way;
    std::copy(v.data(), v.data() + 3, lift + 3 * k);
  }
}

}  // namespace anisocontact::mortar
