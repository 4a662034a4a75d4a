#pragma once
// Nodal forces and tangent blocks of slave points: the virtual work
//   - t . (delta x_s - delta rho) ds = - t . (sum_a N_a delta x_a - sum_b M_b(xi) delta x_b) J w
// and its derivative with respect to the nodes of the slave facet, of the master facet and of the
// facet on which the history was committed.

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
  SlaveArea area;
};

namespace detail {

/// Columns of some nodes, one after the other: rows of the change of area times traction, and of
/// area times the shift of the coordinates.
struct ColumnRows {
  std::array<std::array<double, 3 * 2 * most_nodes>, 3> force;
  std::array<std::array<double, 3 * 2 * most_nodes>, 2> xi;

  void put(std::size_t c, const Eigen::Matrix3d& f, const Eigen::Matrix<double, 2, 3>& shift) {
    for (std::size_t j = 0; j < 3; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      for (std::size_t i = 0; i < 3; ++i)
        force[i][3 * c + j] = f(static_cast<Eigen::Index>(i), column);
      for (std::size_t i = 0; i < 2; ++i)
        xi[i][3 * c + j] = shift(static_cast<Eigen::Index>(i), column);
    }
  }
};

/// s_0 d_0 + s_1 d_1 + s_2 d_2 for the value and the two derivatives of a shape function.
template <class M>
M combined(const NodalShape& s, std::size_t a, const M& d0, const M& d1, const M& d2) {
  return s.n[a] * d0 + s.dn[a][0] * d1 + s.dn[a][1] * d2;
}

inline Eigen::Matrix3d of_before(const PairResult& r, const NodalShape& before, std::size_t c) {
  return combined<Eigen::Matrix3d>(before, c, r.d_traction[index(Input::before_position)],
                                   r.d_traction[before_input(0)], r.d_traction[before_input(1)]);
}

/// Columns of the nodes of the slave and of the master; `merged` where the history was committed on
/// the same facet of the master.
template <class Slaves, class Masters>
void put_columns(Slaves slaves, Masters masters, const PairResult& r, const PairShapes& s,
                 bool merged, ColumnRows& out) noexcept {
  const double area = s.area.value();
  std::array<Vec3<double>, 2> change{Vec3<double>::Zero(), Vec3<double>::Zero()};
  if (s.area.current) {
    const Vec3<double> m = s.area.cross().normalized();
    change = {s.area.weight * s.area.tangents[1].cross(m),
              s.area.weight * m.cross(s.area.tangents[0])};
  }
  for (std::size_t a = 0; a < slaves; ++a) {
    const auto& dn = s.slave.dn[a];
    const Eigen::Matrix3d d =
        combined<Eigen::Matrix3d>(s.slave, a, r.d_traction[index(Input::slave)],
                                  r.d_traction[slave_input(0)], r.d_traction[slave_input(1)]);
    const Vec3<double> grows = dn[0] * change[0] + dn[1] * change[1];
    out.put(a, area * d + r.traction * grows.transpose(), (area * s.slave.n[a]) * r.d_xi[0]);
  }
  for (std::size_t b = 0; b < masters; ++b) {
    Eigen::Matrix3d d =
        combined<Eigen::Matrix3d>(s.master, b, r.d_traction[index(Input::position)],
                                  r.d_traction[tangent_input(0)], r.d_traction[tangent_input(1)]);
    if (merged) d += of_before(r, s.before, b);
    out.put(
        slaves + b, area * d,
        area * combined<Eigen::Matrix<double, 2, 3>>(s.master, b, r.d_xi[1], r.d_xi[2], r.d_xi[3]));
  }
}

/// Adds rows times columns; `length` is the number of entries in a row.
template <class Slaves, class Masters, class Length>
void add_rows(Slaves slaves, Masters masters, Length length, const Vec3<double>& traction,
              const PairShapes& s, const ColumnRows& columns, bool shifts, double* out) noexcept {
  for (std::size_t a = 0; a < slaves; ++a)
    for (std::size_t i = 0; i < 3; ++i, out += length)
      for (std::size_t j = 0; j < length; ++j) out[j] -= s.slave.n[a] * columns.force[i][j];
  for (std::size_t b = 0; b < masters; ++b) {
    std::array<double, 3 * 2 * most_nodes> moved;
    const auto& dn = s.master.dn[b];
    for (std::size_t j = 0; j < length; ++j)
      moved[j] = shifts ? dn[0] * columns.xi[0][j] + dn[1] * columns.xi[1][j] : 0.0;
    for (std::size_t i = 0; i < 3; ++i, out += length)
      for (std::size_t j = 0; j < length; ++j)
        out[j] +=
            s.master.n[b] * columns.force[i][j] + traction[static_cast<Eigen::Index>(i)] * moved[j];
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
  const Vec3<double> t = s.area.value() * r.traction;
  const auto add = [&](double factor) {
    for (Eigen::Index i = 0; i < 3; ++i) *out++ += factor * t[i];
  };
  for (std::size_t a = 0; a < s.slave.count; ++a) add(-s.slave.n[a]);
  for (std::size_t b = 0; b < s.master.count; ++b) add(s.master.n[b]);
}

/// Adds the tangent of a point. Rows of both blocks: nodes of the slave, then of the master.
/// Columns of `own`: the same; of `earlier`: the nodes of the facet on which the history was
/// committed. Without `earlier` that is the master's, or there is none.
inline void add_tangent(const PairResult& r, const PairShapes& s, double* own,
                        double* earlier) noexcept {
  detail::with_counts(s.slave.count, s.master.count, [&](auto slaves, auto masters) {
    detail::ColumnRows columns;
    const bool merged = earlier == nullptr && s.before.count > 0;
    detail::put_columns(slaves, masters, r, s, merged, columns);
    const auto length = detail::entries(detail::total(slaves, masters));
    detail::add_rows(slaves, masters, length, r.traction, s, columns, true, own);
    if (earlier == nullptr) return;
    const Eigen::Matrix<double, 2, 3> still = Eigen::Matrix<double, 2, 3>::Zero();
    for (std::size_t c = 0; c < masters; ++c)
      columns.put(c, s.area.value() * detail::of_before(r, s.before, c), still);
    detail::add_rows(slaves, masters, detail::entries(masters), r.traction, s, columns, false,
                     earlier);
  });
}

}  // namespace anisocontact::kernel
