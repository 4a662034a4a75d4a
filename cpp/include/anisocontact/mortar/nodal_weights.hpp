#pragma once
// Mortar weights of slave nodes, collected from the facets around each.

#include "anisocontact/mortar/dual_weights.hpp"

namespace anisocontact::mortar {

/// Lists one after the other: that of i is [offset[i], offset[i + 1]).
struct ListView {
  const std::int64_t* offset;
  const std::int32_t* item;

  const std::int32_t* begin(std::size_t i) const { return item + offset[i]; }
  const std::int32_t* end(std::size_t i) const { return item + offset[i + 1]; }
  std::size_t size(std::size_t i) const {
    return static_cast<std::size_t>(offset[i + 1] - offset[i]);
  }
};

/// The facets around each slave node and the nodes of these, -1 behind the last.
struct Patches {
  ListView facet, local;
  const std::int32_t* nodes;
  std::size_t width;
};

/// Where the weights of n nodes go. Columns: nodes of the patch, then masters; `most` masters a node.
struct NodalWeights {
  std::size_t most;
  std::int32_t* masters;
  double *area, *weight, *d_area, *d_weight;
};

/// Nodes of the master that a slave node has weights on, and further ones, ascending.
inline std::vector<std::int32_t> masters_of(const std::vector<DualWeights>& facets,
                                            const Patches& p, const ListView& more, std::size_t i) {
  std::vector<std::int32_t> out(more.begin(i), more.end(i));
  for (const std::int32_t* f = p.facet.begin(i); f != p.facet.end(i); ++f) {
    const auto& m = facets[static_cast<std::size_t>(*f)].masters;
    out.insert(out.end(), m.begin(), m.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Writes the weights of a node; what is written to is zero before.
inline void collect(const MortarInput& in, const std::vector<DualWeights>& facets, const Patches& p,
                    const std::vector<std::int32_t>& masters, std::size_t i,
                    const NodalWeights& out) {
  const std::size_t columns = 3 * (p.width + out.most), ns = in.slave.width();
  std::copy(masters.begin(), masters.end(), out.masters + i * out.most);
  std::vector<std::size_t> column;
  for (std::size_t e = 0; e < p.facet.size(i); ++e) {
    const auto f = static_cast<std::size_t>(p.facet.begin(i)[e]);
    const auto row = static_cast<Eigen::Index>(p.local.begin(i)[e]);
    const DualWeights& own = facets[f];
    if (own.masters.empty()) continue;
    out.area[i] += own.area[row];
    const auto count = static_cast<Eigen::Index>(own.masters.size());
    column.clear();
    for (std::size_t a = 0; a < ns; ++a) {
      const std::int32_t* patch = p.nodes + i * p.width;
      column.push_back(
          static_cast<std::size_t>(std::find(patch, patch + p.width, in.slave.node(f, a)) - patch));
    }
    for (const std::int32_t m : own.masters)
      column.push_back(
          p.width + static_cast<std::size_t>(std::lower_bound(masters.begin(), masters.end(), m) -
                                             masters.begin()));
    const auto add = [&](const auto& from, double* to) {
      for (std::size_t c = 0; c < column.size(); ++c)
        for (std::size_t j = 0; j < 3; ++j)
          to[3 * column[c] + j] += from[static_cast<Eigen::Index>(3 * c + j)];
    };
    if (in.slopes) add(own.d_area.row(row), out.d_area + i * columns);
    for (Eigen::Index k = 0; k < count; ++k) {
      const std::size_t to = column[ns + static_cast<std::size_t>(k)] - p.width;
      out.weight[i * out.most + to] += own.weight(row, k);
      if (in.slopes)
        add(own.d_weight.row(row * count + k), out.d_weight + (i * out.most + to) * columns);
    }
  }
}

}  // namespace anisocontact::mortar
