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

/// Weights of n slave nodes on `most` masters each, -1 behind the last.
struct NodalWeights {
  std::size_t most;
  std::int32_t* masters;  ///< (n, most), ascending
  double *area, *weight;  ///< (n,), (n, most)
  std::int32_t* count;    ///< masters of each, (n,)
  /// Which of them are nodes of the facets that it overlaps, ascending: others have no weight.
  std::vector<std::vector<std::int32_t>> reached;

  /// Number of a node among the masters of a slave node.
  std::size_t place(std::size_t i, std::int32_t node) const {
    const auto first = static_cast<const std::int32_t*>(masters + i * most);
    return static_cast<std::size_t>(std::lower_bound(first, first + count[i], node) - first);
  }
};

/// Nodes of the master that a slave node has weights on, and further ones, ascending.
inline std::vector<std::int32_t> masters_of(const std::vector<DualWeights>& facets,
                                            const Patches& p, const ListView& more, std::size_t i) {
  std::size_t count = more.size(i);
  for (const std::int32_t* f = p.facet.begin(i); f != p.facet.end(i); ++f)
    count += facets[static_cast<std::size_t>(*f)].masters.size();
  std::vector<std::int32_t> out;
  out.reserve(count);
  out.assign(more.begin(i), more.end(i));
  for (const std::int32_t* f = p.facet.begin(i); f != p.facet.end(i); ++f) {
    const auto& m = facets[static_cast<std::size_t>(*f)].masters;
    out.insert(out.end(), m.begin(), m.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Writes the weights of a node; what is written to is zero before.
inline void collect(const std::vector<DualWeights>& facets, const Patches& p,
                    const std::vector<std::int32_t>& masters, std::size_t i, NodalWeights& out) {
  std::copy(masters.begin(), masters.end(), out.masters + i * out.most);
  out.count[i] = static_cast<std::int32_t>(masters.size());
  std::vector<char> reached(masters.size(), 0);
  for (std::size_t e = 0; e < p.facet.size(i); ++e) {
    const DualWeights& own = facets[static_cast<std::size_t>(p.facet.begin(i)[e])];
    if (own.masters.empty()) continue;
    const auto row = static_cast<Eigen::Index>(p.local.begin(i)[e]);
    out.area[i] += own.area[row];
    for (std::size_t k = 0; k < own.masters.size(); ++k) {
      const std::size_t there = out.place(i, own.masters[k]);
      out.weight[i * out.most + there] += own.weight(row, static_cast<Eigen::Index>(k));
      reached[there] = 1;
    }
  }
  for (std::size_t k = 0; k < masters.size(); ++k)
    if (reached[k] != 0) out.reached[i].push_back(static_cast<std::int32_t>(k));
}

}  // namespace anisocontact::mortar
