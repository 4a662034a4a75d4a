#pragma once
// Nodal forces and tangent blocks of slave points: the virtual work
//   - [t . (delta x_s - delta rho) + m_j . delta rho_j] ds
//   = - (t . (sum_a N_a delta x_a - sum_b M_b delta x_b) + m_j . sum_b M_b,j delta x_b) J w
// and its derivative with respect to the nodes of the slave facet, of the master facet and of the
// facet on which the history was committed. The shape functions M_b of the master move with xi.

#include "anisocontact/kernel/facet_pair.hpp"

namespace anisocontact::kernel {

inline constexpr std::size_t most_nodes = 9;

/// Shape functions at a point and their first derivatives.
struct NodalShape {
  std::size_t count{0};
  std::array<double, most_nodes> n{};
  std::array<std::array<double, 2>, most_nodes> dn{};
};

/// Area of the slave point: weight of the quadrature and, where the area is the current one, the
/// tangents of the slave facet.
struct SlaveArea {
  double weight{0.0};
  bool current{true};
  std::array<Vec3<double>, 2> tangents{Vec3<double>::Zero(), Vec3<double>::Zero()};

  Vec3<double> cross() const { return tangents[0].cross(tangents[1]); }
  double value() const { return weight * (current ? cross().norm() : 1.0); }
};

/// A point as it is assembled.
struct PairShapes {
  NodalShape slave, master, before;
  std::array<std::array<double, 3>, most_nodes> bend{};  ///< second derivatives of the master's
  SlaveArea area;
};

namespace detail {

/// Columns of some nodes, one after the other: rows of the changes, times area, of what the values of
/// the shape functions, their derivatives and their second derivatives are multiplied with.
struct ColumnRows {
  using Rows = std::array<std::array<double, 3 * 2 * most_nodes>, 3>;
  Rows force;
  std::array<Rows, 2> lever;
  std::array<Rows, 3> bend;
};

inline void put(ColumnRows::Rows& to, std::size_t c, const Eigen::Matrix3d& m) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      to[i][3 * c + j] = m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

/// Second derivatives of a master's shape functions that are not zero: the first one of 11, 12, 22,
/// and the one after the last.
constexpr std::array<std::size_t, 2> bends(std::size_t masters) {
  if (masters == 3) return {0, 0};
  if (masters == 4) return {1, 2};
  return {0, 3};
}

/// A node: what its displacement changes of three inputs.
struct Shares {
  std::array<double, 3> s;
  std::array<std::size_t, 3> input;

  Shares(const NodalShape& n, std::size_t a, const std::array<std::size_t, 3>& i)
      : s{n.n[a], n.dn[a][0], n.dn[a][1]}, input(i) {}

  Eigen::Matrix3d of(const std::array<Eigen::Matrix3d, inputs>& d) const {
    return s[0] * d[input[0]] + s[1] * d[input[1]] + s[2] * d[input[2]];
  }
};

inline constexpr std::array<std::size_t, 3> of_slave{index(Input::slave), slave_input(0),
                                                     slave_input(1)},
    of_master{index(Input::position), tangent_input(0), tangent_input(1)},
    of_before{index(Input::before_position), before_input(0), before_input(1)};

/// Writes the columns of one point.
class Columns {
 public:
  Columns(const PairResult& r, const PairSlopes& d, const PairShapes& s, ColumnRows& out) noexcept
      : r_(r), d_(d), s_(s), out_(out), area_(s.area.value()) {
    if (!s.area.current) return;
    const Vec3<double> m = s.area.cross().normalized();
    change_ = {s.area.weight * s.area.tangents[1].cross(m),
               s.area.weight * m.cross(s.area.tangents[0])};
  }

  template <class Masters>
  void slave(std::size_t a, std::size_t column, Masters masters) {
    const Shares own(s_.slave, a, of_slave);
    const Vec3<double> grows = own.s[1] * change_[0] + own.s[2] * change_[1];
    put(out_.force, column, area_ * own.of(d_.traction) + r_.traction * grows.transpose());
    const Eigen::Matrix<double, 2, 3> shift = (area_ * own.s[0]) * d_.xi[0];
    for (std::size_t j = 0; j < 2; ++j)
      put(out_.lever[j], column,
          area_ * own.of(d_.couple[j]) + r_.couple[j] * grows.transpose() -
              r_.traction * shift.row(static_cast<Eigen::Index>(j)));
    bend(column, shift, masters);
  }

  /// `merged` where the history was committed on the same facet.
  template <class Masters>
  void master(std::size_t b, std::size_t column, bool merged, Masters masters) {
    const Shares own(s_.master, b, of_master);
    Eigen::Matrix3d force = own.of(d_.traction);
    std::array<Eigen::Matrix3d, 2> lever{own.of(d_.couple[0]), own.of(d_.couple[1])};
    if (merged) {
      const Shares old(s_.before, b, of_before);
      force += old.of(d_.traction);
      for (std::size_t j = 0; j < 2; ++j) lever[j] += old.of(d_.couple[j]);
    }
    put(out_.force, column, area_ * force);
    const Eigen::Matrix<double, 2, 3> shift =
        area_ * (own.s[0] * d_.xi[1] + own.s[1] * d_.xi[2] + own.s[2] * d_.xi[3]);
    for (std::size_t j = 0; j < 2; ++j)
      put(out_.lever[j], column,
          area_ * lever[j] - r_.traction * shift.row(static_cast<Eigen::Index>(j)));
    bend(column, shift, masters);
  }

  void before(std::size_t c, std::size_t column) {
    const Shares old(s_.before, c, of_before);
    put(out_.force, column, area_ * old.of(d_.traction));
    for (std::size_t j = 0; j < 2; ++j) put(out_.lever[j], column, area_ * old.of(d_.couple[j]));
  }

 private:
  /// m_j d xi^k M_,jk, the mixed derivative once.
  template <class Masters>
  void bend(std::size_t column, const Eigen::Matrix<double, 2, 3>& shift, Masters masters) {
    for (std::size_t k = bends(masters)[0]; k < bends(masters)[1]; ++k) {
      const std::size_t i = k / 2, j = k - i;  // 11, 12, 22
      Eigen::Matrix3d m = r_.couple[i] * shift.row(static_cast<Eigen::Index>(j));
      if (i != j) m += r_.couple[j] * shift.row(static_cast<Eigen::Index>(i));
      put(out_.bend[k], column, m);
    }
  }

  const PairResult& r_;
  const PairSlopes& d_;
  const PairShapes& s_;
  ColumnRows& out_;
  double area_;
  std::array<Vec3<double>, 2> change_{Vec3<double>::Zero(), Vec3<double>::Zero()};
};

/// Adds rows times columns; `length` is the number of entries in a row. Without `bent` nothing in
/// these columns moves the projection.
template <class Slaves, class Masters, class Length>
void add_rows(Slaves slaves, Masters masters, Length length, const PairShapes& s,
              const ColumnRows& columns, bool bent, double* out) noexcept {
  for (std::size_t a = 0; a < slaves; ++a)
    for (std::size_t i = 0; i < 3; ++i, out += length)
      for (std::size_t j = 0; j < length; ++j) out[j] -= s.slave.n[a] * columns.force[i][j];
  for (std::size_t b = 0; b < masters; ++b) {
    const auto& dn = s.master.dn[b];
    for (std::size_t i = 0; i < 3; ++i, out += length) {
      for (std::size_t j = 0; j < length; ++j)
        out[j] += s.master.n[b] * columns.force[i][j] - dn[0] * columns.lever[0][i][j] -
                  dn[1] * columns.lever[1][i][j];
      for (std::size_t k = bends(masters)[0]; bent && k < bends(masters)[1]; ++k)
        for (std::size_t j = 0; j < length; ++j) out[j] -= s.bend[b][k] * columns.bend[k][i][j];
    }
  }
}

/// Calls f with both numbers of nodes, as constants for the usual facets.
template <class F>
void with_counts(std::size_t slaves, std::size_t masters, const F& f) {
  const auto constant = [&]<std::size_t N>(std::integral_constant<std::size_t, N> n) {
    const bool both = slaves == N && masters == N;
    if (both) f(n, n);
    return both;
  };
  using std::integral_constant;
  if (constant(integral_constant<std::size_t, 4>{}) ||
      constant(integral_constant<std::size_t, 3>{}) ||
      constant(integral_constant<std::size_t, 9>{}) ||
      constant(integral_constant<std::size_t, 6>{}))
    return;
  f(slaves, masters);
}

/// Three times a number of nodes, constant where that is.
template <std::size_t N>
constexpr auto entries(std::integral_constant<std::size_t, N>) {
  return std::integral_constant<std::size_t, 3 * N>{};
}
constexpr std::size_t entries(std::size_t n) { return 3 * n; }
template <std::size_t N, std::size_t M>
constexpr auto total(std::integral_constant<std::size_t, N>,
                     std::integral_constant<std::size_t, M>) {
  return std::integral_constant<std::size_t, N + M>{};
}
constexpr std::size_t total(std::size_t n, std::size_t m) { return n + m; }

}  // namespace detail

/// Adds the residual of a point: three components for each node of the slave, then of the master.
inline void add_residual(const PairResult& r, const PairShapes& s, double* out) noexcept {
  const double area = s.area.value();
  const auto add = [&](const Vec3<double>& f) {
    for (Eigen::Index i = 0; i < 3; ++i) *out++ += area * f[i];
  };
  for (std::size_t a = 0; a < s.slave.count; ++a) add(-s.slave.n[a] * r.traction);
  for (std::size_t b = 0; b < s.master.count; ++b)
    add(s.master.n[b] * r.traction - s.master.dn[b][0] * r.couple[0] -
        s.master.dn[b][1] * r.couple[1]);
}

/// Adds the tangent of a point. Rows of both blocks: nodes of the slave, then of the master.
/// Columns of `own`: the same; of `earlier`: the nodes of the facet on which the history was
/// committed. Without `earlier` that is the master's, or there is none.
inline void add_tangent(const PairResult& r, const PairSlopes& d, const PairShapes& s, double* own,
                        double* earlier) noexcept {
  detail::with_counts(s.slave.count, s.master.count, [&](auto slaves, auto masters) {
    detail::ColumnRows rows;
    detail::Columns columns(r, d, s, rows);
    const bool merged = earlier == nullptr && s.before.count > 0;
    for (std::size_t a = 0; a < slaves; ++a) columns.slave(a, a, masters);
    for (std::size_t b = 0; b < masters; ++b) columns.master(b, slaves + b, merged, masters);
    detail::add_rows(slaves, masters, detail::entries(detail::total(slaves, masters)), s, rows,
                     true, own);
    if (earlier == nullptr) return;
    for (std::size_t c = 0; c < masters; ++c) columns.before(c, c);
    detail::add_rows(slaves, masters, detail::entries(masters), s, rows, false, earlier);
  });
}

}  // namespace anisocontact::kernel
