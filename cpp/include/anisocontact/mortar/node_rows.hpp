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

namespace detail {

/// Has numbers read that are needed soon: short runs of them far apart are not foreseen.
inline void prefetch([[maybe_unused]] const double* first, [[maybe_unused]] std::size_t count) {
#if defined(__GNUC__)
  constexpr std::size_t line = 8;
  for (std::size_t j = 0; j < count; j += line) __builtin_prefetch(first + j);
#endif
}

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
  std::vector<const double*> lifts;
};

/// What follows of the derivatives of the weights of facets, by the nodes of a facet and then its masters,
/// (3 c): of the weight and of the traction of each of its nodes, and of the force on each master. Weights
/// have far more derivatives than what is kept of them, and these are put together while they are at hand.
class FacetRows {
 public:
  /// `chosen_at` has the number of the nodes of each facet among those that are chosen, -1 for none.
  FacetRows(const Nodes& n, const Chosen& chosen, const std::vector<std::int32_t>& chosen_at)
      : n_(n), chosen_(chosen), chosen_at_(chosen_at), first_{0} {
    const std::size_t slaves = n.in.slave.width();
    for (std::size_t f = 0; f < n.facets.size(); ++f)
      first_.push_back(first_.back() +
                       (any(f) ? (4 * slaves + 3 * n.facets[f].masters.size()) * width(f) : 0));
  }
  /// How many numbers there are, in memory that is handed over; what is read last ends behind them.
  std::size_t size() const { return first_.back() + column_size; }
  void use(double* memory) { memory_ = memory; }

  /// Whether a facet has masters and a node that is chosen.
  bool any(std::size_t f) const {
    const std::size_t slaves = n_.in.slave.width();
    const std::int32_t* const own = chosen_at_.data() + f * slaves;
    return !n_.facets[f].masters.empty() &&
           std::any_of(own, own + slaves, [](std::int32_t q) { return q >= 0; });
  }

  /// Keeps those of a facet with its weights.
  void put(std::size_t f, const DualWeights& own, RowMemory& memory) const {
    const std::size_t slaves = n_.in.slave.width(), masters = own.masters.size(), size = width(f);
    const double* const slope = own.d_weight.data();
    double* const to = memory_ + first_[f];
    std::copy_n(own.d_area.data(), own.d_area.size(), to);
    memory.lifts.resize(slaves * masters);
    std::array<detail::Outer, most> tractions;
    std::array<std::size_t, most> node;
    std::size_t count = 0;
    for (std::size_t s = 0; s < slaves; ++s)
      if (const std::int32_t q = chosen_at_[f * slaves + s]; q >= 0) {
        const auto chosen = static_cast<std::size_t>(q);
        lifts(chosen, own.masters, memory.lifts.data() + s * masters);
        tractions[count] = {chosen_.traction + 3 * chosen, slope + s * masters * size};
        node[count++] = s;
      }
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (std::size_t o = 0; o < count; ++o) {
        const std::size_t s = node[o];
        detail::sum_outers(
            masters,
            [&](std::size_t k) {
              return detail::Outer{memory.lifts[s * masters + k], tractions[o].row + k * size};
            },
            size, to + (slaves + 3 * s) * size);
      }
      for (std::size_t k = 0; k < masters; ++k)
        detail::sum_outers(
            count,
            [&](std::size_t o) {
              return detail::Outer{tractions[o].v, tractions[o].row + k * size};
            },
            size, to + (4 * slaves + 3 * k) * size);
    });
  }
  const double* area(std::size_t f, std::size_t s) const {
    return memory_ + first_[f] + s * width(f);
  }
  /// Has the rows of a node read that are needed soon.
  void prefetch_node(std::size_t f, std::size_t s) const {
    detail::prefetch(area(f, s), width(f));
    detail::prefetch(traction(f, s), 3 * width(f));
  }
  void prefetch_force(std::size_t f, std::size_t k) const {
    detail::prefetch(force(f, k), 3 * width(f));
  }
  /// Of the traction of a node, (3, 3 c).
  const double* traction(std::size_t f, std::size_t s) const {
    return area(f, n_.in.slave.width() + 3 * s);
  }
  /// Of the force of the chosen nodes of a facet on a master, (3, 3 c), less what follows of tractions.
  const double* force(std::size_t f, std::size_t k) const {
    return area(f, 4 * n_.in.slave.width() + 3 * k);
  }

 private:
  std::size_t width(std::size_t f) const {
    return 3 * (n_.in.slave.width() + n_.facets[f].masters.size());
  }
  /// Derivatives of a traction by the weights on some of the masters of its node, both ascending.
  void lifts(std::size_t q, const std::vector<std::int32_t>& masters, const double** to) const {
    const std::int32_t* const all = n_.masters(chosen_.node(q));
    const double* const lift = chosen_.lift + 3 * q * n_.weights.most;
    std::size_t at = 0;
    for (const std::int32_t node : masters) {
      while (all[at] != node) ++at;
      *to++ = lift + 3 * at;
    }
  }

  const Nodes& n_;
  const Chosen& chosen_;
  const std::vector<std::int32_t>& chosen_at_;
  std::vector<std::size_t> first_;
  double* memory_{nullptr};
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

  void prefetch(std::size_t q) const {
    const std::size_t used = n_.patches.width + n_.count(chosen_.node(q));
    for (std::size_t x = 0; x < 3; ++x)
      detail::prefetch(traction(q) + x * width(), column_size * used);
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
      for (std::size_t e = 0; e < n_.patches.facet.size(i); ++e)
        facets.prefetch_node(static_cast<std::size_t>(n_.patches.facet.begin(i)[e]),
                             static_cast<std::size_t>(n_.patches.local.begin(i)[e]));
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
                                     const RowMemory& memory) const {
    const std::size_t i = chosen_.node(q),
                      f = static_cast<std::size_t>(n_.patches.facet.begin(i)[e]),
                      s = static_cast<std::size_t>(n_.patches.local.begin(i)[e]);
    const auto& masters = n_.facets[f].masters;
    if (masters.empty()) return;
    const std::size_t slaves = n_.in.slave.width(), columns = slaves + masters.size();
    const auto place = [&](std::int32_t master) {
      return static_cast<std::size_t>(memory.place[static_cast<std::size_t>(master)]);
    };
    const double* const rows = facets.traction(f, s);
    double *const area = areas_ + q * width(), *const out = tractions_ + q * 3 * width();
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t to =
          column_size * (c < slaves ? n_.own_column(i, n_.in.slave.node(f, c))
                                    : n_.patches.width + place(masters[c - slaves]));
      add_three(1.0, Three::from(facets.area(f, s) + 3 * c), area + to);
      for (std::size_t x = 0; x < 3; ++x)
        add_three(1.0, Three::from(rows + 3 * (x * columns + c)), out + x * width() + to);
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
