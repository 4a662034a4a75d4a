#pragma once
// Nodal forces and tangent blocks of slave points: the virtual work
//   - [t . (delta x_s - delta rho) + m_j . delta rho_j] ds
//   = - (t . (sum_a N_a delta x_a - sum_b M_b delta x_b) + m_j . sum_b M_b,j delta x_b) J w
// and its derivative with respect to the nodes of the slave facet, of the master facet and of the
// facet on which the history was committed. The shape functions M_b of the master move with xi.

#include <algorithm>

#include "anisocontact/kernel/facet_pair.hpp"
#include "anisocontact/surface/facet_shapes.hpp"

namespace anisocontact::kernel {

inline constexpr std::size_t most_nodes = surface::max_facet_nodes;

/// Shape functions of some nodes at a point.
struct NodalShape : surface::Shape<double> {
  std::size_t count{0};
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

/// A block that a point is added to; a fresh one holds nothing yet.
struct Block {
  double* values{nullptr};
  bool fresh{false};
};

namespace detail {

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

/// Begins with a line of the cache, so that wide registers do not read across two of them. The last
/// number is the zero behind a vector.
struct alignas(64) Row : std::array<double, 3 * 2 * most_nodes + 1> {};
using Rows = std::array<Row, 3>;
/// One number for each node of a facet.
struct alignas(64) NodeRow : std::array<double, most_nodes> {};

/// Columns of some nodes, one after the other: rows of the changes, times area, of what the values of
/// the shape functions and their derivatives are multiplied with; and what moves these derivatives,
/// m_j M_,jk d xi^k.
struct ColumnRows {
  std::array<Rows, 3> acting;  ///< force, and levers on both derivatives
  std::array<const double*, 2> xi;
  std::array<Vec3<double>, 2> couple;  ///< times area
};

/// out = sum of factors times rows, or out += sum where it is not `Fresh`.
template <bool Fresh, std::size_t K, class Length>
ANISOCONTACT_INLINE void combine(Length length, const std::array<double, K>& c,
                                 const std::array<const double*, K>& rows,
                                 double* __restrict out) noexcept {
  const auto sum = [&]<std::size_t... I>(std::index_sequence<I...>) ANISOCONTACT_INLINE_LAMBDA {
    for (std::size_t j = 0; j < length; ++j)
      if constexpr (Fresh)
        out[j] = (... + (c[I] * rows[I][j]));
      else
        out[j] = (out[j] + ... + (c[I] * rows[I][j]));
  };
  sum(std::make_index_sequence<K>{});
}

ANISOCONTACT_INLINE double part(const Vec3<double>& v, std::size_t i) {
  return v[static_cast<Eigen::Index>(i)];
}

/// Writes the columns of one point: its linear forms in the displacements of nodes, and from them what
/// acts.
class Columns {
 public:
  Columns(const PairResult& r, const PairSlopes& d, const PairShapes& s) noexcept
      : r_(r), d_(d), s_(s), cross_(s.area.cross()), area_(s.area.weight) {
    if (!s.area.current) return;
    const double size = cross_.norm();
    area_ *= size;
    cross_ *= 1.0 / size;
  }

  /// Columns of the nodes of the slave and of the master; `merged` where the history was committed
  /// on the same facet.
  template <class Slaves, class Masters, class Length>
  ANISOCONTACT_INLINE void own(Slaves slaves, Masters masters, Length length, bool merged,
                               ColumnRows& out) noexcept {
    put_shapes(slaves, s_.slave, Input::slave, slave_input(0));
    put_shapes(masters, s_.master, Input::position, tangent_input(0));
    if (merged) put_shapes(masters, s_.before, Input::before_position, before_input(0));
    for (std::size_t f = 0; f < 2; ++f) {
      const auto& by = d_.friction[f].by;
      double* const to = friction_[f].data();
      spread(slaves, by, Inputs<0, 7, 8>{}, to);
      if (merged)
        spread(masters, by, Inputs<1, 2, 3, 4, 5, 6>{}, to + entries(slaves));
      else
        spread(masters, by, Inputs<1, 2, 3>{}, to + entries(slaves));
    }
    const std::size_t forms = d_.interior ? PairSlopes::first_beside : PairSlopes::near_forms;
    for (std::size_t f = 0; f < forms; ++f) {
      spread(slaves, d_.near[f].by, Inputs<0>{}, near_[f].data());
      spread(masters, d_.near[f].by, Inputs<1, 2, 3>{}, near_[f].data() + entries(slaves));
    }
    put_growth(slaves, length);
    force(length, out.acting[0]);
    for (std::size_t j = 0; j < 2; ++j) {
      if (d_.interior)
        lever<3>(length, j, out.acting[1 + j]);
      else
        lever<6>(length, j, out.acting[1 + j]);
    }
    for (std::size_t j = 0; j < 2; ++j) {
      out.xi[j] = near_[j].data();
      out.couple[j] = area_ * r_.couple[j];
    }
  }

  /// Columns of the nodes of the facet on which the history was committed.
  template <class Masters, class Length>
  ANISOCONTACT_INLINE void before(Masters masters, Length length, ColumnRows& out) noexcept {
    put_shapes(masters, s_.before, Input::before_position, before_input(0));
    for (std::size_t f = 0; f < 2; ++f)
      spread(masters, d_.friction[f].by, Inputs<4, 5, 6>{}, friction_[f].data());
    for (std::size_t q = 0; q < PairSlopes::acting; ++q)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& to = d_.along_friction[q];
        combine<true, 2>(length, {area_ * part(to[0], i), area_ * part(to[1], i)},
                         {friction_[0].data(), friction_[1].data()}, out.acting[q][i].data());
      }
  }

 private:
  template <std::size_t... I>
  using Inputs = std::index_sequence<I...>;

  /// Writes the shape functions of some nodes that an input and the two after `first_slope` follow.
  template <class Nodes>
  ANISOCONTACT_INLINE void put_shapes(Nodes nodes, const NodalShape& s, Input value,
                                      std::size_t first_slope) noexcept {
    NodeRow &v = shapes_[index(value)], &v1 = shapes_[first_slope], &v2 = shapes_[first_slope + 1];
    for (std::size_t a = 0; a < nodes; ++a) {
      v[a] = s.N[a];
      v1[a] = s.dN[a][0];
      v2[a] = s.dN[a][1];
    }
  }

  /// Writes a form by the nodes that some inputs follow, and a zero behind the last one.
  template <std::size_t... I, class Nodes, class By>
  ANISOCONTACT_INLINE void spread(Nodes nodes, const By& by, Inputs<I...>,
                                  double* to) const noexcept {
    for (std::size_t a = 0; a < nodes; ++a) (... + (shapes_[I][a] * by[I])).to(to + 3 * a);
  }

  /// Change of the area with the nodes of the slave.
  template <class Slaves, class Length>
  ANISOCONTACT_INLINE void put_growth(Slaves slaves, Length length) {
    const std::size_t own = s_.area.current ? entries(slaves) : 0;
    std::fill_n(growth_.data() + own, length - own, 0.0);
    if (!s_.area.current) return;
    std::array<Padded, inputs> by;
    by[slave_input(0)] = s_.area.weight * s_.area.tangents[1].cross(cross_);
    by[slave_input(1)] = s_.area.weight * cross_.cross(s_.area.tangents[0]);
    spread(slaves, by, Inputs<7, 8>{}, growth_.data());
  }

  template <class Length>
  ANISOCONTACT_INLINE void force(Length length, Rows& out) {
    const auto& f = d_.along_friction[0];
    const auto& n = d_.along[0];
    for (std::size_t i = 0; i < 3; ++i)
      combine<true, 6>(length,
                       {area_ * part(f[0], i), area_ * part(f[1], i), area_ * part(n[2], i),
                        area_ * part(n[3], i), area_ * part(n[4], i), part(r_.traction, i)},
                       {friction_[0].data(), friction_[1].data(), near_[2].data(), near_[3].data(),
                        near_[4].data(), growth_.data()},
                       out[i].data());
  }

  /// d (A m_j) - A t d xi^j, with the first `Terms` of its forms.
  template <std::size_t Terms, class Length>
  ANISOCONTACT_INLINE void lever(Length length, std::size_t j, Rows& out) {
    constexpr std::size_t K = Terms + 4;
    const auto& to = d_.along_friction[1 + j];
    const auto terms = PairSlopes::terms(1 + j);
    std::array<const double*, K> rows{friction_[0].data(), friction_[1].data(), growth_.data(),
                                      near_[j].data()};
    for (std::size_t t = 0; t < Terms; ++t) rows[4 + t] = near_[terms[t]].data();
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, K> c{area_ * part(to[0], i), area_ * part(to[1], i), part(r_.couple[j], i),
                              -area_ * part(r_.traction, i)};
      for (std::size_t t = 0; t < Terms; ++t) c[4 + t] = area_ * part(d_.along[1 + j][terms[t]], i);
      combine<true, K>(length, c, rows, out[i].data());
    }
  }

  const PairResult& r_;
  const PairSlopes& d_;
  const PairShapes& s_;
  Vec3<double> cross_;  ///< of the tangents of the slave; its direction where the area follows
  double area_;
  std::array<NodeRow, inputs> shapes_;  ///< that each input follows
  std::array<Row, 2> friction_;
  std::array<Row, PairSlopes::near_forms> near_;
  Row growth_;
};

/// Adds the rows of the nodes of the master; `Bent` where their second derivatives count.
template <bool Fresh, bool Bent, class Masters, class Length>
ANISOCONTACT_INLINE void add_master_rows(Masters masters, Length length, const NodalShape& s,
                                         const ColumnRows& columns, double* out) noexcept {
  constexpr std::size_t terms = Bent ? 5 : 3;
  const auto& m = columns.couple;
  for (std::size_t b = 0; b < masters; ++b)
    for (std::size_t i = 0; i < 3; ++i, out += length) {
      std::array<double, terms> c{s.N[b], -s.dN[b][0], -s.dN[b][1]};
      std::array<const double*, terms> rows{
          columns.acting[0][i].data(), columns.acting[1][i].data(), columns.acting[2][i].data()};
      if constexpr (Bent)
        for (std::size_t k = 0; k < 2; ++k) {
          c[3 + k] = -(s.d2N[b][k] * part(m[0], i) + s.d2N[b][k + 1] * part(m[1], i));
          rows[3 + k] = columns.xi[k];
        }
      combine<Fresh, terms>(length, c, rows, out);
    }
}

/// Adds rows times columns, or writes them where the block is `Fresh`; `length` is the number of
/// entries in a row. Without `bent` nothing in these columns moves the projection.
template <bool Fresh, class Slaves, class Masters, class Length>
ANISOCONTACT_INLINE void add_rows(Slaves slaves, Masters masters, Length length,
                                  const PairShapes& s, const ColumnRows& columns, bool bent,
                                  double* out) noexcept {
  for (std::size_t a = 0; a < slaves; ++a)
    for (std::size_t i = 0; i < 3; ++i, out += length)
      combine<Fresh, 1>(length, {-s.slave.N[a]}, {columns.acting[0][i].data()}, out);
  if (!bent || masters == 3)
    add_master_rows<Fresh, false>(masters, length, s.master, columns, out);
  else
    add_master_rows<Fresh, true>(masters, length, s.master, columns, out);
}
template <class Slaves, class Masters, class Length>
ANISOCONTACT_INLINE void add_rows(Slaves slaves, Masters masters, Length length,
                                  const PairShapes& s, const ColumnRows& columns, bool bent,
                                  Block block) noexcept {
  if (block.fresh)
    add_rows<true>(slaves, masters, length, s, columns, bent, block.values);
  else
    add_rows<false>(slaves, masters, length, s, columns, bent, block.values);
}

template <class Slaves, class Masters>
ANISOCONTACT_INLINE void add_tangent_of(Slaves slaves, Masters masters, const PairResult& r,
                                        const PairSlopes& d, const PairShapes& s, Block own,
                                        Block earlier) noexcept {
  ColumnRows rows;
  Columns columns(r, d, s);
  const auto length = entries(total(slaves, masters));
  columns.own(slaves, masters, length, earlier.values == nullptr && s.before.count > 0, rows);
  add_rows(slaves, masters, length, s, rows, true, own);
  if (earlier.values == nullptr) return;
  const auto part = entries(masters);
  columns.before(masters, part, rows);
  add_rows(slaves, masters, part, s, rows, false, earlier);
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

}  // namespace detail

/// Adds the residual of a point: three components for each node of the slave, then of the master.
inline void add_residual(const PairResult& r, const PairShapes& s, double* out) noexcept {
  const double area = s.area.value();
  const auto add = [&](const Vec3<double>& f) {
    for (Eigen::Index i = 0; i < 3; ++i) *out++ += area * f[i];
  };
  for (std::size_t a = 0; a < s.slave.count; ++a) add(-s.slave.N[a] * r.traction);
  for (std::size_t b = 0; b < s.master.count; ++b)
    add(s.master.N[b] * r.traction - s.master.dN[b][0] * r.couple[0] -
        s.master.dN[b][1] * r.couple[1]);
}

/// Adds to three residuals what each component of a slip makes of that of a point, see `slip_slopes`.
inline void add_slip_residuals(const PairSlopes& d, const PairShapes& s, double* out) noexcept {
  const std::size_t rows = 3 * (s.slave.count + s.master.count);
  for (Eigen::Index k = 0; k < 3; ++k, out += rows) {
    PairResult change;
    change.traction = d.by_slip.col(k);
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t a = 0; a < 2; ++a)
        change.couple[j] +=
            d.along_friction[0][a].dot(change.traction) * d.along_friction[1 + j][a];
    add_residual(change, s, out);
  }
}

/// Adds the tangent of a point. Rows of both blocks: nodes of the slave, then of the master.
/// Columns of `own`: the same; of `earlier`: the nodes of the facet on which the history was
/// committed. Without `earlier` that is the master's, or there is none.
inline void add_tangent(const PairResult& r, const PairSlopes& d, const PairShapes& s, Block own,
                        Block earlier) noexcept {
  detail::with_counts(s.slave.count, s.master.count, [&](auto slaves, auto masters) {
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      detail::add_tangent_of(slaves, masters, r, d, s, own, earlier);
    });
  });
}

/// Writes the derivative of a point's traction times its area, three rows, by the nodes of the slave, of the
/// master and of the facet on which the history was committed.
inline void traction_slopes(const PairResult& r, const PairSlopes& d, const PairShapes& s,
                            double* out) noexcept {
  detail::with_counts(s.slave.count, s.master.count, [&](auto slaves, auto masters) {
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      detail::ColumnRows rows;
      detail::Columns columns(r, d, s);
      const auto length = detail::entries(detail::total(slaves, masters));
      const auto part = detail::entries(masters);
      columns.own(slaves, masters, length, false, rows);
      for (std::size_t i = 0; i < 3; ++i)
        std::copy_n(rows.acting[0][i].data(), length, out + i * (length + part));
      columns.before(masters, part, rows);
      for (std::size_t i = 0; i < 3; ++i)
        std::copy_n(rows.acting[0][i].data(), part, out + i * (length + part) + length);
    });
  });
}

}  // namespace anisocontact::kernel
