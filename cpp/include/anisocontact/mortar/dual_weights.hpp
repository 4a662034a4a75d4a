#pragma once
// Mortar weights of one slave facet: dual functions psi_i of its covered part,
//   integral of psi_i N_j = delta_ij integral of N_j   [Wohlmuth 2000],
// biorthogonal on what the master covers [Cichosz Bischoff 2011], and with them
//   D_i = integral of N_i,   W_ik = integral of psi_i M_k = D_i (m^-1 c)_ik .
// Where hardly anything of a node is covered, psi_i is added to those of the others.

#include <algorithm>
#include <span>
#include <vector>

#include "anisocontact/mortar/integrator.hpp"
#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::mortar {

/// Facets of a mesh.
struct Facets {
  Topology topology;
  const std::int32_t* nodes;  ///< (count, node_count)
  std::size_t count;

  std::size_t width() const { return surface::node_count(topology); }
  std::int32_t node(std::size_t f, std::size_t a) const { return nodes[f * width() + a]; }
  Facet at(std::size_t f, const double* x) const {
    Facet out{topology, {}};
    for (std::size_t a = 0; a < width(); ++a) {
      const double* p = x + 3 * static_cast<std::size_t>(node(f, a));
      out.x[a] = {p[0], p[1], p[2]};
    }
    return out;
  }
};

/// Weights of a facet and their derivatives: three columns for each node of the facet, then of
/// `masters`.
struct DualWeights {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<std::int32_t> masters;  ///< nodes, ascending
  Eigen::VectorXd area;               ///< D
  Matrix weight;                      ///< W, (slaves, masters)
  Matrix d_area, d_weight;            ///< (slaves, columns), (slaves * masters, columns)
};

namespace detail {

using Eigen::Index;

/// The inverse of m, column by column; whether there is one. Rows and columns are scaled to a diagonal
/// of one, so that the size of what is covered does not matter.
template <std::size_t L>
bool invert(const Integrals<L>& in, std::size_t n, std::array<Lanes<L>, L>& out) {
  Eigen::MatrixXd m(n, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      m(static_cast<Index>(i), static_cast<Index>(j)) = in.value[j][i];
  if (!(m.diagonal().minCoeff() > 0.0)) return false;
  const Eigen::VectorXd unit = m.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factor(unit.asDiagonal() * m * unit.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-13)) return false;
  const Eigen::MatrixXd inverse =
      unit.asDiagonal() * factor.solve(Eigen::MatrixXd(unit.asDiagonal()));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      out[j].set(i, inverse(static_cast<Index>(i), static_cast<Index>(j)));
  return true;
}

/// W = D m^-1 c with its derivatives; whether m can be inverted.
template <std::size_t L>
ANISOCONTACT_INLINE bool put_weights(const Integrals<L>& in, std::size_t n, DualWeights& out) {
  const std::size_t count = in.rows - n, columns = in.columns;
  std::array<Lanes<L>, L> inverse;
  if (!invert(in, n, inverse)) return false;
  const auto times = [&](const auto& x) ANISOCONTACT_INLINE_LAMBDA {
    Lanes<L> product;
    for (std::size_t j = 0; j < n; ++j) product.add(x[j], inverse[j]);
    return product;
  };
  Lanes<L> area;
  for (std::size_t j = 0; j < n; ++j) area.add(1.0, in.value[j]);
  std::vector<Lanes<L>> z(count);
  out.area.resize(static_cast<Index>(n));
  out.weight.resize(static_cast<Index>(n), static_cast<Index>(count));
  for (std::size_t k = 0; k < count; ++k) z[k] = times(in.value[n + k]);
  for (std::size_t i = 0; i < n; ++i) {
    out.area[static_cast<Index>(i)] = area[i];
    for (std::size_t k = 0; k < count; ++k) out.weight.data()[i * count + k] = area[i] * z[k][i];
  }
  if (in.slope.empty()) return true;
  out.d_area.resize(static_cast<Index>(n), static_cast<Index>(columns));
  out.d_weight.resize(static_cast<Index>(n * count), static_cast<Index>(columns));
  for (std::size_t c = 0; c < columns; ++c) {
    Lanes<L> grown;
    for (std::size_t j = 0; j < n; ++j) grown.add(1.0, in.slope[j * columns + c]);
    for (std::size_t i = 0; i < n; ++i) out.d_area.data()[i * columns + c] = grown[i];
    for (std::size_t k = 0; k < count; ++k) {
      // dz = m^-1 (dc - dm z)
      Lanes<L> right = in.slope[(n + k) * columns + c];
      for (std::size_t j = 0; j < n; ++j) right.add(-z[k][j], in.slope[j * columns + c]);
      const Lanes<L> dz = times(right);
      for (std::size_t i = 0; i < n; ++i)
        out.d_weight.data()[(i * count + k) * columns + c] = z[k][i] * grown[i] + area[i] * dz[i];
    }
  }
  return true;
}

/// Least share of its weight that has to be covered for a node, over that of the node of the facet of
/// which most is: dual functions of less extrapolate from a strip to where nothing is covered.
inline constexpr double extrapolated = 0.2;

/// Gives the weights of nodes that would be extrapolated to the other nodes of the facet, so that a
/// uniform traction is still handed over exactly; `whole` are the weights where all is covered.
inline void hand_over(std::span<const double> whole, DualWeights& out) {
  const auto n = static_cast<Index>(whole.size()), masters = out.weight.cols();
  const Eigen::VectorXd share =
      out.area.array() / Eigen::Map<const Eigen::ArrayXd>(whole.data(), n);
  const auto kept = share.array() > extrapolated * share.maxCoeff();
  const double part = 1.0 / static_cast<double>(kept.count());
  const auto move = [&](auto& rows, Index width) {
    for (Index from = 0; from < n; ++from) {
      if (kept[from]) continue;
      auto little = rows.middleRows(from * width, width);
      for (Index to = 0; to < n; ++to)
        if (kept[to]) rows.middleRows(to * width, width) += part * little;
      little.setZero();
    }
  };
  move(out.area, 1);
  move(out.weight, 1);
  if (out.d_area.size() == 0) return;
  move(out.d_area, 1);
  move(out.d_weight, masters);
}

}  // namespace detail

/// What the weights of facets are found from.
struct MortarInput {
  Facets slave, master;
  const double *now,
      *reference;  ///< positions of the nodes; no reference where areas are those of now
  Rules rules;
  std::span<const double>
      whole;  ///< weights of a facet all of which is covered; none: see `hand_over`
  bool slopes;
};

/// Weights of a slave facet against facets of the master; none where nothing is covered.
inline DualWeights dual_weights(const MortarInput& in, std::size_t f,
                                const std::int32_t* candidates, std::size_t count) {
  const Facet slave = in.slave.at(f, in.now);
  const auto sub = sub_facets(slave.topology);
  std::vector<SlavePart> parts;
  std::vector<Overlap> found;
  DualWeights out;
  parts.reserve(sub.size());
  found.reserve(count);
  for (const SubFacet& part : sub) {
    parts.emplace_back(slave, part);
    if (!parts.back().valid()) return {};
    if (in.reference != nullptr) parts.back().scale_to(in.slave.at(f, in.reference));
    for (std::size_t c = 0; c < count; ++c) {
      const auto g = static_cast<std::size_t>(candidates[c]);
      parts.back().find(in.master.at(g, in.now), g, found);
    }
  }
  if (found.empty()) return out;
  for (const Overlap& o : found)
    for (std::size_t a = 0; a < in.master.width(); ++a)
      out.masters.push_back(in.master.node(o.facet, a));
  std::sort(out.masters.begin(), out.masters.end());
  out.masters.erase(std::unique(out.masters.begin(), out.masters.end()), out.masters.end());
  const bool any = with_lanes(slave.nodes(), [&](auto lanes) {
    Integrals<lanes> total(slave.nodes(), out.masters.size(), in.slopes);
    Integrator<lanes> integrator(slave, in.rules, total);
    bool good = false;
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (const Overlap& o : found) {
        std::array<std::size_t, most> column{};
        for (std::size_t a = 0; a < in.master.width(); ++a)
          column[a] =
              3 * (slave.nodes() +
                   static_cast<std::size_t>(std::lower_bound(out.masters.begin(), out.masters.end(),
                                                             in.master.node(o.facet, a)) -
                                            out.masters.begin()));
        integrator.add(parts[static_cast<std::size_t>(o.slave - sub.data())], o,
                       in.master.at(o.facet, in.now), column);
      }
      good = detail::put_weights(total, slave.nodes(), out);
    });
    return good;
  });
  if (any && !in.whole.empty()) detail::hand_over(in.whole, out);
  return any ? out : DualWeights{};
}

}  // namespace anisocontact::mortar
