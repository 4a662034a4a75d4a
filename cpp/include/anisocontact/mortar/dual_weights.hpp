#pragma once
// Mortar weights of one slave facet: dual functions psi_i of its covered part,
//   integral of psi_i N_j = delta_ij integral of N_j   [Wohlmuth 2000],
// biorthogonal on what the master covers [Cichosz Bischoff 2011], and with them
//   D_i = integral of N_i,   W_ik = integral of psi_i M_k = D_i (m^-1 c)_ik .

#include <algorithm>
#include <vector>

#include "anisocontact/mortar/overlap.hpp"
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
  using Matrix = PairIntegrals::Matrix;
  std::vector<std::int32_t> masters;  ///< nodes, ascending
  Eigen::VectorXd area;               ///< D
  Matrix weight;                      ///< W, (slaves, masters)
  Matrix d_area, d_weight;            ///< (slaves, columns), (slaves * masters, columns)
};

namespace detail {

using Eigen::Index;

/// Integrals over all overlaps of a facet, columns as of `DualWeights`.
struct FacetIntegrals {
  PairIntegrals sum;

  /// Adds a pair whose masters have these places among all.
  void add(const PairIntegrals& one, Index slaves, const std::vector<Index>& place, bool slopes) {
    sum.m += one.m;
    const Index own = 3 * slaves, count = sum.c.cols(), mine = one.c.cols();
    for (Index i = 0; i < slaves; ++i)
      for (Index k = 0; k < mine; ++k) sum.c(i, place[static_cast<std::size_t>(k)]) += one.c(i, k);
    if (!slopes) return;
    const auto columns = [&](const auto& from, auto to) {
      to.head(own) += from.head(own);
      for (Index k = 0; k < mine; ++k)
        to.segment(own + 3 * place[static_cast<std::size_t>(k)], 3) += from.segment(own + 3 * k, 3);
    };
    for (Index r = 0; r < one.dm.rows(); ++r) columns(one.dm.row(r), sum.dm.row(r));
    for (Index i = 0; i < slaves; ++i)
      for (Index k = 0; k < mine; ++k)
        columns(one.dc.row(i * mine + k),
                sum.dc.row(i * count + place[static_cast<std::size_t>(k)]));
  }
};

/// W = D m^-1 c with its derivatives; whether m can be inverted. Its rows and columns are scaled to a
/// diagonal of one, so that the size of what is covered does not matter.
inline bool put_weights(const PairIntegrals& in, bool slopes, DualWeights& out) {
  const Index n = in.m.rows(), count = in.c.cols();
  if (!(in.m.diagonal().minCoeff() > 0.0)) return false;
  const Eigen::VectorXd unit = in.m.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * in.m * unit.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factor(scaled);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-13)) return false;
  const auto solve = [&](const auto& b) -> Eigen::MatrixXd {
    return unit.asDiagonal() * factor.solve(unit.asDiagonal() * b);
  };
  const Eigen::MatrixXd z = solve(in.c);
  out.area = in.m.rowwise().sum();
  out.weight = out.area.asDiagonal() * z;
  if (!slopes) return true;
  const Index columns = in.dm.cols();
  out.d_area.setZero(n, columns);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) out.d_area.row(i) += in.dm.row(i * n + j);
  // dz = m^-1 (dc - dm z), all columns at once: rows i, columns (k, v)
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> right(n, count * columns);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < count; ++k) {
      auto to = right.row(i).segment(k * columns, columns);
      to = in.dc.row(i * count + k);
      for (Index j = 0; j < n; ++j) to -= z(j, k) * in.dm.row(i * n + j);
    }
  const Eigen::MatrixXd inverse = solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> dz = inverse * right;
  out.d_weight.resize(n * count, columns);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < count; ++k)
      out.d_weight.row(i * count + k) =
          z(i, k) * out.d_area.row(i) + out.area[i] * dz.row(i).segment(k * columns, columns);
  return true;
}

}  // namespace detail

/// What the weights of facets are found from.
struct MortarInput {
  Facets slave, master;
  const double *now,
      *reference;  ///< positions of the nodes; no reference where areas are those of now
  Rules rules;
  bool slopes;
};

/// Weights of a slave facet against facets of the master; none where nothing is covered.
inline DualWeights dual_weights(const MortarInput& in, std::size_t f,
                                const std::int32_t* candidates, std::size_t count) {
  const Facet slave = in.slave.at(f, in.now);
  const std::size_t ns = slave.nodes(), nm = in.master.width();
  std::vector<std::pair<std::int32_t, PairIntegrals>> found;
  detail::PlaneIntegrals work;
  std::vector<Overlaps> parts;
  for (const SubFacet& part : sub_facets(slave.topology)) {
    parts.emplace_back(slave, part, in.rules, in.slopes);
    if (!parts.back().valid()) return {};
    if (in.reference != nullptr) parts.back().scale_to(in.slave.at(f, in.reference));
  }
  for (std::size_t c = 0; c < count; ++c) {
    const Facet master = in.master.at(static_cast<std::size_t>(candidates[c]), in.now);
    PairIntegrals pair;
    pair.reset(ns, nm, in.slopes);
    bool any = false;
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (const Overlaps& part : parts) any |= part.add(master, work, pair);
    });
    if (any) found.emplace_back(candidates[c], std::move(pair));
  }
  DualWeights out;
  if (found.empty()) return out;
  for (const auto& [g, pair] : found)
    for (std::size_t a = 0; a < nm; ++a)
      out.masters.push_back(in.master.node(static_cast<std::size_t>(g), a));
  std::sort(out.masters.begin(), out.masters.end());
  out.masters.erase(std::unique(out.masters.begin(), out.masters.end()), out.masters.end());
  detail::FacetIntegrals total;
  total.sum.reset(ns, out.masters.size(), in.slopes);
  std::vector<Eigen::Index> place(nm);
  for (const auto& [g, pair] : found) {
    for (std::size_t a = 0; a < nm; ++a)
      place[a] = std::lower_bound(out.masters.begin(), out.masters.end(),
                                  in.master.node(static_cast<std::size_t>(g), a)) -
                 out.masters.begin();
    total.add(pair, static_cast<Eigen::Index>(ns), place, in.slopes);
  }
  if (!detail::put_weights(total.sum, in.slopes, out)) return {};
  return out;
}

}  // namespace anisocontact::mortar
