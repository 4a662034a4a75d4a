#pragma once
// Tangent of the forces of a mortar contact. Of a slave node with traction t, weights D and W_k:
//   - d(D t) = - D dt - t dD   on the nodes of its support,
//     d(W_k t) = W_k dt + t dW_k   on those of the master,
// where t follows moving parts, which are sums over nodes, and the weights. What dW_k gives is summed
// facet by facet.

#include <span>

#include "anisocontact/mortar/node_rows.hpp"

namespace anisocontact::mortar {

/// Rows of the tangent of the forces, each with the slave nodes and facets that add to it.
class ForceRows {
 public:
  /// Adds `scale` dt + `lean` t dD of a chosen slave node.
  struct NodeTerm {
    std::size_t of;
    double scale, lean;
  };
  /// Adds t dW_k of the nodes of a facet, k-th of its masters.
  struct FacetTerm {
    std::size_t of, master;
  };

  ForceRows(const Nodes& n, const Chosen& chosen, const NodeRows& slopes, const FacetRows& facets,
            std::size_t nodes)
      : n_(n),
        chosen_(chosen),
        slopes_(slopes),
        facets_(facets),
        by_node_(nodes),
        by_facet_(nodes) {
    by_node_.fill([&](const auto& put) { each_node(put); });
    by_facet_.fill([&](const auto& put) { each_facet(put); });
    for (std::size_t r = 0; r < nodes; ++r)
      if (by_node_.size(r) > 0) nodes_.push_back(static_cast<std::int32_t>(r));
  }

  /// Nodes that have a row.
  const std::vector<std::int32_t>& nodes() const { return nodes_; }

  /// Writes the columns of a row, in the order in which they come.
  void columns(std::int32_t row, std::vector<std::int32_t>& place,
               std::vector<std::int32_t>& out) const {
    out.clear();
    const auto put = [&](std::int32_t node) {
      auto& there = place[static_cast<std::size_t>(node)];
      if (there >= 0) return;
      there = 0;
      out.push_back(node);
    };
    for (const NodeTerm& term : by_node_.of(row)) {
      const std::size_t i = chosen_.node(term.of);
      std::for_each_n(n_.patch(i), n_.patches.width, put);
      std::for_each_n(n_.masters(i), n_.count(i), put);
    }
    for (const std::int32_t node : out) place[static_cast<std::size_t>(node)] = -1;
  }

  /// Writes the blocks of a row, (columns, 9).
  void write(std::int32_t row, const std::vector<std::int32_t>& columns, RowMemory& in,
             double* out) const {
    in.sums.assign(3 * columns.size(), {});
    for (std::size_t c = 0; c < columns.size(); ++c)
      in.place[static_cast<std::size_t>(columns[c])] = static_cast<std::int32_t>(3 * c);
    with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
      const auto nodes = by_node_.of(row);
      for (std::size_t j = 0; j < nodes.size(); ++j) {
        if (j + 1 < nodes.size()) slopes_.prefetch(nodes[j + 1].of);
        add(nodes[j], in);
      }
      const auto facets = by_facet_.of(row);
      for (std::size_t j = 0; j < facets.size(); ++j) {
        if (j + 1 < facets.size()) facets_.prefetch_force(facets[j + 1].of, facets[j + 1].master);
        add(facets[j], in);
      }
    });
    for (std::size_t x = 0; x < in.sums.size(); ++x)
      std::memcpy(out + 3 * x, &in.sums[x], 3 * sizeof *out);
    for (const std::int32_t node : columns) in.place[static_cast<std::size_t>(node)] = -1;
  }

 private:
  ANISOCONTACT_INLINE void add(const NodeTerm& term, RowMemory& in) const {
    const std::size_t i = chosen_.node(term.of), width = slopes_.width();
    const double *const t = chosen_.traction + 3 * term.of, *area = slopes_.area(term.of),
                        *slope = slopes_.traction(term.of);
    const std::array<double, 3> leans{term.lean * t[0], term.lean * t[1], term.lean * t[2]};
    const auto put = [&](std::int32_t node) ANISOCONTACT_INLINE_LAMBDA {
      Three* const to = in.sums.data() + in.place[static_cast<std::size_t>(node)];
      for (std::size_t x = 0; x < 3; ++x) to[x].add(term.scale, Three::from(slope + x * width));
      if (term.lean != 0.0)
        for (std::size_t x = 0; x < 3; ++x) to[x].add(leans[x], Three::from(area));
      area += column_size;
      slope += column_size;
    };
    for (std::size_t c = 0; c < n_.patches.width; ++c) put(n_.patch(i)[c]);
    for (std::size_t k = 0; k < n_.count(i); ++k) put(n_.masters(i)[k]);
  }

  ANISOCONTACT_INLINE void add(const FacetTerm& term, RowMemory& in) const {
    const auto& masters = n_.facets[term.of].masters;
    const std::size_t slaves = n_.in.slave.width(), columns = slaves + masters.size();
    const double* const rows = facets_.force(term.of, term.master);
    for (std::size_t c = 0; c < columns; ++c) {
      const std::int32_t node = c < slaves ? n_.in.slave.node(term.of, c) : masters[c - slaves];
      Three* const to = in.sums.data() + in.place[static_cast<std::size_t>(node)];
      for (std::size_t x = 0; x < 3; ++x) to[x].add(1.0, Three::from(rows + 3 * (x * columns + c)));
    }
  }

  /// Calls put with every row and what slave nodes add to it.
  template <class Put>
  void each_node(const Put& put) const {
    for (std::size_t q = 0; q < chosen_.count; ++q) {
      const std::size_t i = chosen_.node(q);
      for (std::size_t r = 0; r < n_.rows; ++r)
        if (const double share = n_.support[i * n_.rows + r]; share != 0.0)
          put(n_.patch(i)[r], NodeTerm{q, -share * n_.weights.area[i], -share});
      for (const std::int32_t k : n_.weights.reached[i]) {
        const auto m = static_cast<std::size_t>(k);
        put(n_.masters(i)[m], NodeTerm{q, n_.weights.weight[i * n_.weights.most + m], 0.0});
      }
    }
  }
  /// The same of facets.
  template <class Put>
  void each_facet(const Put& put) const {
    for (std::size_t f = 0; f < n_.facets.size(); ++f) {
      if (!facets_.any(f)) continue;
      for (std::size_t k = 0; k < n_.facets[f].masters.size(); ++k)
        put(n_.facets[f].masters[k], FacetTerm{f, k});
    }
  }

  /// Terms sorted by their row.
  template <class Term>
  struct Sorted {
    std::vector<std::size_t> offset;
    std::vector<Term> terms;

    explicit Sorted(std::size_t nodes) : offset(nodes + 2, 0) {}
    template <class Each>
    void fill(const Each& each) {
      each([&](std::int32_t row, const Term&) { ++offset[static_cast<std::size_t>(row) + 2]; });
      for (std::size_t r = 2; r < offset.size(); ++r) offset[r] += offset[r - 1];
      terms.resize(offset.back());
      each([&](std::int32_t row, const Term& t) {
        terms[offset[static_cast<std::size_t>(row) + 1]++] = t;
      });
    }
    std::size_t size(std::size_t row) const { return offset[row + 1] - offset[row]; }
    std::span<const Term> of(std::int32_t row) const {
      const auto r = static_cast<std::size_t>(row);
      return {terms.data() + offset[r], size(r)};
    }
  };

  const Nodes& n_;
  const Chosen& chosen_;
  const NodeRows& slopes_;
  const FacetRows& facets_;
  Sorted<NodeTerm> by_node_;
  Sorted<FacetTerm> by_facet_;
  std::vector<std::int32_t> nodes_;
};

}  // namespace anisocontact::mortar
