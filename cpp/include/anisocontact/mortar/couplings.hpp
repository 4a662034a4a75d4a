#pragma once
// Tangent of the forces of a mortar contact. Of a slave node with traction t, weights D and W_k:
//   - d(D t) = - D dt - t dD   on the nodes of its support,
//     d(W_k t) = W_k dt + t dW_k   on those of the master,
// where t follows moving parts, which are sums over nodes, and the weights. Derivatives of weights are
// contracted facet by facet; what is left are blocks of 3 x 3 numbers, row by row.

#include <span>

#include "anisocontact/mortar/nodal_weights.hpp"

namespace anisocontact::mortar {

/// How many things a traction depends on that are sums over nodes: slave point and tangents, mean of
/// the master and tangents, the same of the accepted increment, place of the tangents and tangents of
/// its facet.
inline constexpr std::size_t moving_parts = 12;
inline constexpr std::size_t block_size = 9;

/// The nodes that moving parts are made of, for each slave node: `count` parts from `first` on.
struct MovingPart {
  std::size_t first, count, width;
  const std::int32_t* nodes;  ///< (n, width) of the master, -1 for none; none at all: of the patch
  const double* values;       ///< (n, count, width)
};

/// Slave nodes whose tangent is wanted, p of n.
struct Chosen {
  const std::int32_t* which;  ///< (p,)
  std::size_t count;
  const double* by;        ///< slopes of their tractions by the moving parts, (p, parts, 3, 3)
  const double* lift;      ///< and by the weights, (p, masters, 3)
  const double* traction;  ///< (p, 3)
};

/// What the weights of a facet give, by the nodes of the facet and then its masters, (3 c); none where no
/// node of it is chosen.
struct FacetBlocks {
  std::vector<std::int32_t> nodes;  ///< columns, and rows of the force
  std::vector<bool> acting;         ///< which of these rows are not all zero
  double *lift{nullptr},
      *force{nullptr};  ///< of tractions of its nodes, (slaves, 3, 3 c), and (c, 3, 3 c)

  /// How many numbers both have.
  static std::size_t size(std::size_t slaves, std::size_t masters) {
    const std::size_t count = slaves + masters;
    return masters == 0 ? 0 : (slaves + count) * block_size * count;
  }
};

/// Weights of slave nodes and what they were found from.
struct Nodes {
  const MortarInput& in;
  const std::vector<DualWeights>& facets;
  const Patches& patches;
  const double* support;  ///< (n, rows)
  std::size_t rows;
  const NodalWeights& weights;

  std::size_t columns() const { return patches.width + weights.most; }
  const std::int32_t* patch(std::size_t i) const { return patches.nodes + i * patches.width; }
  const std::int32_t* masters(std::size_t i) const { return weights.masters + i * weights.most; }
  std::size_t place(std::size_t i, std::int32_t master) const { return weights.place(i, master); }
  std::size_t count(std::size_t i) const { return static_cast<std::size_t>(weights.count[i]); }
};

namespace detail {

ANISOCONTACT_INLINE void add_block(double factor, const double* from, double* to) {
  for (std::size_t x = 0; x < block_size; ++x) to[x] += factor * from[x];
}

/// Adds vector times row, (width,), to three rows.
ANISOCONTACT_INLINE void add_outer(const double* v, const double* row, std::size_t width,
                                   double* to) {
  for (std::size_t x = 0; x < 3; ++x)
    for (std::size_t c = 0; c < width; ++c) to[x * width + c] += v[x] * row[c];
}

/// A vector times a row.
struct Outer {
  const double *v, *row;
};

/// Writes a sum of vectors times rows, (width,), to three rows, four at a time: what is written to is
/// read once for four.
template <class Of>
ANISOCONTACT_INLINE void sum_outers(std::size_t count, const Of& of, std::size_t width,
                                    double* to) {
  static constexpr std::array<double, 3> none{};
  for (std::size_t first = 0; first < count; first += 4) {
    std::array<Outer, 4> o;
    for (std::size_t e = 0; e < 4; ++e)
      o[e] = first + e < count ? of(first + e) : Outer{none.data(), o[0].row};
    for (std::size_t x = 0; x < 3; ++x) {
      double* const out = to + x * width;
      const double a = o[0].v[x], b = o[1].v[x], c = o[2].v[x], d = o[3].v[x];
      if (first == 0) std::fill_n(out, width, 0.0);
      for (std::size_t j = 0; j < width; ++j)
        out[j] = out[j] + a * o[0].row[j] + b * o[1].row[j] + c * o[2].row[j] + d * o[3].row[j];
    }
  }
}

/// Adds column c of three rows, (3, width), to a block.
ANISOCONTACT_INLINE void add_column(const double* rows, std::size_t width, std::size_t c,
                                    double* to) {
  for (std::size_t x = 0; x < 3; ++x)
    for (std::size_t j = 0; j < 3; ++j) to[3 * x + j] += rows[x * width + 3 * c + j];
}

}  // namespace detail

/// Blocks of a facet, whose nodes have these places among those that are chosen, -1 for none, written
/// to memory of `FacetBlocks::size`.
inline FacetBlocks facet_blocks(const Nodes& n, const Chosen& chosen, std::size_t f,
                                const DualWeights& own, const std::int32_t* place, double* memory) {
  FacetBlocks out;
  const std::size_t slaves = n.in.slave.width(), masters = own.masters.size(),
                    count = slaves + masters, width = 3 * count;
  if (masters == 0) return out;
  for (std::size_t a = 0; a < slaves; ++a) out.nodes.push_back(n.in.slave.node(f, a));
  out.nodes.insert(out.nodes.end(), own.masters.begin(), own.masters.end());
  out.acting.assign(count, false);
  out.lift = memory;
  out.force = memory + slaves * 3 * width;
  std::fill_n(memory, 2 * slaves * 3 * width, 0.0);  // without the rows of masters
  std::array<std::size_t, most> there{};             // nodes that are chosen
  std::size_t some = 0;
  for (std::size_t s = 0; s < slaves; ++s)
    if (place[s] >= 0) there[some++] = s;
  const auto q = [&](std::size_t s) { return static_cast<std::size_t>(place[s]); };
  const auto slopes = [&](std::size_t s, std::size_t k) {
    return own.d_weight.data() + (s * masters + k) * width;
  };
  const auto node = [&](std::size_t s) ANISOCONTACT_INLINE_LAMBDA {
    const auto i = static_cast<std::size_t>(chosen.which[q(s)]);
    const double* const t = chosen.traction + 3 * q(s);
    for (std::size_t r = 0; r < n.rows; ++r) {
      const double share = -n.support[i * n.rows + r];
      if (share == 0.0) continue;
      const auto a = static_cast<std::size_t>(
          std::find(out.nodes.begin(), out.nodes.end(), n.patch(i)[r]) - out.nodes.begin());
      out.acting[a] = true;
      const std::array<double, 3> v{share * t[0], share * t[1], share * t[2]};
      detail::add_outer(v.data(), own.d_area.data() + s * width, width, out.force + a * 3 * width);
    }
    const double* const lift = chosen.lift + 3 * q(s) * n.weights.most;
    detail::sum_outers(
        masters,
        [&](std::size_t k) {
          return detail::Outer{lift + 3 * n.place(i, own.masters[k]), slopes(s, k)};
        },
        width, out.lift + s * 3 * width);
  };
  with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
    for (std::size_t e = 0; e < some; ++e) node(there[e]);
    for (std::size_t k = 0; k < masters; ++k) {
      out.acting[slaves + k] = true;
      detail::sum_outers(
          some,
          [&](std::size_t e) {
            return detail::Outer{chosen.traction + 3 * q(there[e]), slopes(there[e], k)};
          },
          width, out.force + (slaves + k) * 3 * width);
    }
  });
  return out;
}

/// Writes dt/du of a chosen slave node, (columns, 9): by the moving parts, and by the weights.
inline void traction_slopes(const Nodes& n, const std::vector<FacetBlocks>& blocks,
                            const std::vector<MovingPart>& parts, const Chosen& chosen,
                            std::size_t q, double* out) {
  const auto i = static_cast<std::size_t>(chosen.which[q]);
  const std::size_t width = n.patches.width;
  std::fill_n(out, n.columns() * block_size, 0.0);
  with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
    for (const MovingPart& part : parts)
      for (std::size_t a = 0; a < part.width; ++a) {
        const std::int32_t node = part.nodes == nullptr ? 0 : part.nodes[i * part.width + a];
        if (node < 0) continue;
        const std::size_t c = part.nodes == nullptr ? a : width + n.place(i, node);
        for (std::size_t v = 0; v < part.count; ++v)
          detail::add_block(part.values[(i * part.count + v) * part.width + a],
                            chosen.by + (q * moving_parts + part.first + v) * block_size,
                            out + c * block_size);
      }
    for (std::size_t e = 0; e < n.patches.facet.size(i); ++e) {
      const FacetBlocks& b = blocks[static_cast<std::size_t>(n.patches.facet.begin(i)[e])];
      const std::size_t count = b.nodes.size(), slaves = n.in.slave.width();
      const double* const from =
          b.lift + static_cast<std::size_t>(n.patches.local.begin(i)[e]) * block_size * count;
      for (std::size_t c = 0; c < count; ++c) {
        const auto patch = n.patch(i);
        const std::size_t to =
            c < slaves
                ? static_cast<std::size_t>(std::find(patch, patch + width, b.nodes[c]) - patch)
                : width + n.place(i, b.nodes[c]);
        detail::add_column(from, 3 * count, c, out + to * block_size);
      }
    }
  });
}

/// Rows of the tangent of the forces, each with the slave nodes and facets that add to it.
class ForceRows {
 public:
  struct Term {
    std::size_t of;        ///< chosen slave node, or facet
    const double* blocks;  ///< (columns, 9) of a node, (3, 3 c) of a facet
    double factor;
  };

  /// `slopes` are those of the tractions, (p, columns, 9).
  ForceRows(const Nodes& n, const Chosen& chosen, const double* slopes,
            const std::vector<FacetBlocks>& facets, std::size_t nodes)
      : n_(n), chosen_(chosen), facets_(facets), by_node_(nodes), by_facet_(nodes) {
    const auto each_node = [&](const auto& put) {
      for (std::size_t q = 0; q < chosen.count; ++q) {
        const auto i = static_cast<std::size_t>(chosen.which[q]);
        const double* const dt = slopes + q * n.columns() * block_size;
        for (std::size_t r = 0; r < n.rows; ++r)
          if (const double share = n.support[i * n.rows + r]; share != 0.0)
            put(n.patch(i)[r], Term{q, dt, -share * n.weights.area[i]});
        for (std::size_t k = 0; k < n.count(i); ++k)
          put(n.masters(i)[k], Term{q, dt, n.weights.weight[i * n.weights.most + k]});
      }
    };
    const auto each_facet = [&](const auto& put) {
      for (std::size_t f = 0; f < facets.size(); ++f) {
        const std::size_t count = facets[f].nodes.size();
        for (std::size_t a = 0; a < count; ++a)
          if (facets[f].acting[a])
            put(facets[f].nodes[a], Term{f, facets[f].force + a * count * block_size, 1.0});
      }
    };
    by_node_.fill(each_node);
    by_facet_.fill(each_facet);
    for (std::size_t r = 0; r < nodes; ++r)
      if (by_node_.size(r) > 0) nodes_.push_back(static_cast<std::int32_t>(r));
  }

  /// Nodes that have a row.
  const std::vector<std::int32_t>& nodes() const { return nodes_; }

  /// Writes the columns of a row, in the order in which they come; `place` is -1 for every node.
  void columns(std::int32_t row, std::vector<std::int32_t>& place,
               std::vector<std::int32_t>& out) const {
    out.clear();
    const auto put = [&](std::int32_t node) {
      auto& there = place[static_cast<std::size_t>(node)];
      if (there >= 0) return;
      there = 0;
      out.push_back(node);
    };
    for (const Term& term : by_node_.of(row)) {
      const auto i = static_cast<std::size_t>(chosen_.which[term.of]);
      std::for_each_n(n_.patch(i), n_.patches.width, put);
      std::for_each_n(n_.masters(i), n_.count(i), put);
    }
    for (const std::int32_t node : out) place[static_cast<std::size_t>(node)] = -1;
  }

  /// Writes the blocks of a row, (columns, 9); `place` as before.
  void write(std::int32_t row, const std::vector<std::int32_t>& columns,
             std::vector<std::int32_t>& place, double* out) const {
    std::fill_n(out, columns.size() * block_size, 0.0);
    for (std::size_t c = 0; c < columns.size(); ++c)
      place[static_cast<std::size_t>(columns[c])] = static_cast<std::int32_t>(c);
    const auto to = [&](std::int32_t node) ANISOCONTACT_INLINE_LAMBDA {
      return out + static_cast<std::size_t>(place[static_cast<std::size_t>(node)]) * block_size;
    };
    with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (const Term& term : by_node_.of(row)) {
        const auto i = static_cast<std::size_t>(chosen_.which[term.of]);
        const double* from = term.blocks;
        for (std::size_t c = 0; c < n_.patches.width; ++c, from += block_size)
          detail::add_block(term.factor, from, to(n_.patch(i)[c]));
        for (std::size_t k = 0; k < n_.count(i); ++k, from += block_size)
          detail::add_block(term.factor, from, to(n_.masters(i)[k]));
      }
      for (const Term& term : by_facet_.of(row)) {
        const auto& nodes = facets_[term.of].nodes;
        for (std::size_t c = 0; c < nodes.size(); ++c)
          detail::add_column(term.blocks, 3 * nodes.size(), c, to(nodes[c]));
      }
    });
    for (const std::int32_t node : columns) place[static_cast<std::size_t>(node)] = -1;
  }

 private:
  /// Terms sorted by their row.
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
  const std::vector<FacetBlocks>& facets_;
  Sorted by_node_, by_facet_;
  std::vector<std::int32_t> nodes_;
};

}  // namespace anisocontact::mortar
