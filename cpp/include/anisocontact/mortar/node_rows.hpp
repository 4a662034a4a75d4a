#pragma once
// Derivatives of the weights and of the tractions of slave nodes, as rows of three numbers, which fill a
// register with one that does not count, for each node that they depend on.

#include <algorithm>
#include <array>
#include <vector>

#include "anisocontact/mortar/nodal_weights.hpp"

namespace anisocontact::mortar {

/// How many things a traction depends on that are sums over nodes: slave point and tangents, mean of
/// the master and tangents, the same of the accepted increment, place of the tangents and tangents of
/// its facet.
inline constexpr std::size_t moving_parts = 12;
inline constexpr std::size_t block_size = 9;
/// Three numbers of a column, and one that does not count.
using Three = Lanes<4>;
inline constexpr std::size_t column_size = 4;

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

  std::size_t node(std::size_t q) const { return static_cast<std::size_t>(which[q]); }
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
  /// Column of a node of the patch, the first one of it.
  std::size_t own_column(std::size_t i, std::int32_t node) const {
    return static_cast<std::size_t>(std::find(patch(i), patch(i) + patches.width, node) - patch(i));
  }
};

/// Derivatives of the weights of facets, by the nodes of the facet and then its masters, (3 c): of the
/// weights of its nodes, then of each of these on each master.
class FacetRows {
 public:
  FacetRows(const std::vector<DualWeights>& facets, std::size_t slaves)
      : facets_(facets), slaves_(slaves), first_{0} {
    for (const DualWeights& one : facets) {
      const std::size_t k = one.masters.size();
      first_.push_back(first_.back() + (k == 0 ? 0 : slaves * (1 + k) * 3 * (slaves + k)));
    }
  }
  /// How many numbers there are, in memory that is handed over; what is read last ends behind them.
  std::size_t size() const { return first_.back() + column_size; }
  void use(double* memory) { memory_ = memory; }

  /// Keeps those of a facet.
  void put(std::size_t f, const DualWeights& own) const {
    if (own.masters.empty()) return;
    double* const to = memory_ + first_[f];
    std::copy_n(own.d_area.data(), own.d_area.size(), to);
    std::copy_n(own.d_weight.data(), own.d_weight.size(), to + own.d_area.size());
  }
  const double* area(std::size_t f, std::size_t s) const {
    return memory_ + first_[f] + s * width(f);
  }
  const double* weight(std::size_t f, std::size_t s, std::size_t k) const {
    return area(f, slaves_ + s * facets_[f].masters.size() + k);
  }

 private:
  std::size_t width(std::size_t f) const { return 3 * (slaves_ + facets_[f].masters.size()); }

  const std::vector<DualWeights>& facets_;
  std::size_t slaves_;
  std::vector<std::size_t> first_;
  double* memory_{nullptr};
};

namespace detail {

/// A vector times a row.
struct Outer {
  const double *v, *row;
};

/// Writes a sum of vectors times rows, (width,), to three rows, four at a time: what is written to is read
/// once for four.
template <class Of>
ANISOCONTACT_INLINE void sum_outers(std::size_t count, const Of& of, std::size_t width,
                                    double* to) {
  static constexpr std::array<double, 3> none{};
  std::fill_n(to, 3 * width, 0.0);
  for (std::size_t first = 0; first < count; first += 4) {
    std::array<Outer, 4> o;
    for (std::size_t e = 0; e < 4; ++e)
      o[e] = first + e < count ? of(first + e) : Outer{none.data(), o[0].row};
    for (std::size_t x = 0; x < 3; ++x) {
      double* const out = to + x * width;
      const double a = o[0].v[x], b = o[1].v[x], c = o[2].v[x], d = o[3].v[x];
      for (std::size_t j = 0; j < width; ++j)
        out[j] = out[j] + a * o[0].row[j] + b * o[1].row[j] + c * o[2].row[j] + d * o[3].row[j];
    }
  }
}

}  // namespace detail

/// What rows are found in; places of nodes are -1 before and after.
struct RowMemory {
  explicit RowMemory(std::size_t nodes) : place(nodes, -1) {}
  std::vector<std::int32_t> place;
  std::vector<Three> sums;
  std::vector<double> rows;
};

/// Derivatives at chosen slave nodes by their columns: of the weight, and of the traction.
class NodeRows {
 public:
  NodeRows(const Nodes& n, const Chosen& chosen) : n_(n), chosen_(chosen) {}
  std::size_t width() const { return column_size * n_.columns(); }
  /// How many numbers those of the weights are, in memory that is handed over, with that of the tractions.
  std::size_t size() const { return chosen_.count * width(); }
  void use(double* areas, double* tractions) {
    areas_ = areas;
    tractions_ = tractions;
  }

  const double* area(std::size_t q) const { return areas_ + q * width(); }
  const double* traction(std::size_t q) const { return tractions_ + q * 3 * width(); }

  /// Finds those of a node from the facets around it, and from its moving parts.
  void find(std::size_t q, const FacetRows& facets, const std::vector<MovingPart>& parts,
            RowMemory& memory) const {
    const std::size_t i = chosen_.node(q);
    for (std::size_t k = 0; k < n_.count(i); ++k)
      memory.place[static_cast<std::size_t>(n_.masters(i)[k])] = static_cast<std::int32_t>(k);
    std::fill_n(areas_ + q * width(), width(), 0.0);
    std::fill_n(tractions_ + q * 3 * width(), 3 * width(), 0.0);
    with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (std::size_t e = 0; e < n_.patches.facet.size(i); ++e) add_facet(q, e, facets, memory);
      for (const MovingPart& part : parts) add_part(q, part, memory.place);
    });
    for (std::size_t k = 0; k < n_.count(i); ++k)
      memory.place[static_cast<std::size_t>(n_.masters(i)[k])] = -1;
  }

 private:
  ANISOCONTACT_INLINE static void add_three(double factor, const Three& x, double* to) {
    Three sum = Three::from(to);
    sum.add(factor, x);
    sum.to(to);
  }

  /// Adds what follows of the weights on a facet around a node.
  ANISOCONTACT_INLINE void add_facet(std::size_t q, std::size_t e, const FacetRows& facets,
                                     RowMemory& memory) const {
    const std::size_t i = chosen_.node(q),
                      f = static_cast<std::size_t>(n_.patches.facet.begin(i)[e]),
                      s = static_cast<std::size_t>(n_.patches.local.begin(i)[e]);
    const auto& masters = n_.facets[f].masters;
    if (masters.empty()) return;
    const std::size_t slaves = n_.in.slave.width(), columns = slaves + masters.size();
    const double* const lift = chosen_.lift + 3 * q * n_.weights.most;
    const auto place = [&](std::int32_t master) {
      return static_cast<std::size_t>(memory.place[static_cast<std::size_t>(master)]);
    };
    memory.rows.resize(9 * columns + column_size);
    detail::sum_outers(
        masters.size(),
        [&](std::size_t k) {
          return detail::Outer{lift + 3 * place(masters[k]), facets.weight(f, s, k)};
        },
        3 * columns, memory.rows.data());
    double *const area = areas_ + q * width(), *const out = tractions_ + q * 3 * width();
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t to =
          column_size * (c < slaves ? n_.own_column(i, n_.in.slave.node(f, c))
                                    : n_.patches.width + place(masters[c - slaves]));
      add_three(1.0, Three::from(facets.area(f, s) + 3 * c), area + to);
      for (std::size_t x = 0; x < 3; ++x)
        add_three(1.0, Three::from(memory.rows.data() + 3 * (x * columns + c)),
                  out + x * width() + to);
    }
  }

  /// Adds what a traction follows of moving parts; `place` has those of the masters.
  ANISOCONTACT_INLINE void add_part(std::size_t q, const MovingPart& part,
                                    const std::vector<std::int32_t>& place) const {
    const std::size_t i = chosen_.node(q);
    double* const out = tractions_ + q * 3 * width();
    std::array<std::array<Three, 3>, 3> by;
    for (std::size_t v = 0; v < part.count; ++v) {
      const double* const from = chosen_.by + (q * moving_parts + part.first + v) * block_size;
      for (std::size_t x = 0; x < block_size; ++x) by[v][x / 3].set(x % 3, from[x]);
    }
    for (std::size_t a = 0; a < part.width; ++a) {
      std::size_t c = a;
      if (part.nodes != nullptr) {
        const std::int32_t node = part.nodes[i * part.width + a];
        if (node < 0) continue;
        c = n_.patches.width + static_cast<std::size_t>(place[static_cast<std::size_t>(node)]);
      }
      for (std::size_t x = 0; x < 3; ++x) {
        double* const to = out + x * width() + column_size * c;
        Three sum = Three::from(to);
        for (std::size_t v = 0; v < part.count; ++v)
          sum.add(part.values[(i * part.count + v) * part.width + a], by[v][x]);
        sum.to(to);
      }
    }
  }

  const Nodes& n_;
  const Chosen& chosen_;
  double *areas_{nullptr}, *tractions_{nullptr};
};

}  // namespace anisocontact::mortar
