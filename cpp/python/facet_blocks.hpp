#pragma once
// Blocks of the matrix of a batch, which points share.

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "facet_batch.hpp"
#include "stream.hpp"

namespace anisocontact::bindings {

/// Points of one slave facet that lie one after the other share a block where they meet the same
/// facet, and one more where their history is from the same other facet. Blocks belong to a run of
/// points, so that a run can be summed by one thread, in the same order whatever the threads.
struct Slots {
  static constexpr std::int32_t none = -1;
  std::vector<std::size_t> runs;   ///< first point of each run, and the end
  std::vector<std::size_t> order;  ///< points run by run, those of a block one after the other
  std::vector<std::int32_t> own, earlier;            ///< of each point
  std::vector<std::array<std::int32_t, 2>> facets;   ///< run and facet of each own block
  std::vector<std::array<std::int32_t, 2>> history;  ///< own block and facet of each earlier one

  Slots(const Batch& b, const States& states, const bool* near, std::size_t n)
      : order(n), own(n, none), earlier(n, none) {
    for (std::size_t p = 0; p < n; ++p) {
      if (p == 0 || !same_slave(b.slave, p - 1, p)) begin(p);
      if (near == nullptr || !near[p] || b.hits.feature[p] == off) continue;
      const std::array<std::int32_t, 2> key{static_cast<std::int32_t>(runs.size()) - 1,
                                            b.hits.facet[p]};
      own[p] = find(facets, first_own_, key);
      const auto committed = static_cast<std::int32_t>(states[p].facet);
      if (committed >= 0 && committed != b.hits.facet[p])
        earlier[p] = find(history, first_earlier_, {own[p], committed});
    }
    runs.push_back(n);
    sort();
  }

 private:
  static constexpr auto off = static_cast<std::int8_t>(kernel::Feature::off);

  static bool same_slave(const Slave& s, std::size_t p, std::size_t q) {
    return std::equal(s.nodes + p * s.width, s.nodes + (p + 1) * s.width, s.nodes + q * s.width);
  }
  void begin(std::size_t p) {
    runs.push_back(p);
    first_own_ = facets.size();
    first_earlier_ = history.size();
  }
  static std::int32_t find(std::vector<std::array<std::int32_t, 2>>& keys, std::size_t from,
                           const std::array<std::int32_t, 2>& key) {
    const auto at = std::find(keys.begin() + static_cast<std::ptrdiff_t>(from), keys.end(), key);
    const auto i = static_cast<std::int32_t>(at - keys.begin());
    if (at == keys.end()) keys.push_back(key);
    return i;
  }

  void sort() {
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    for (std::size_t k = 0; k + 1 < runs.size(); ++k)
      std::sort(at(runs[k]), at(runs[k + 1]), [&](std::size_t p, std::size_t q) {
        return std::tie(own[p], earlier[p], p) < std::tie(own[q], earlier[q], q);
      });
  }

  std::size_t first_own_{0}, first_earlier_{0};
};

/// Blocks of nodes in rows and columns, row by row; nodes that are -1 have none.
struct Blocks {
  std::size_t count, rows, columns;  ///< rows and columns: nodes
  Array<std::int32_t> row_nodes, column_nodes;
  Array<double> values;

  Blocks(std::size_t n, std::size_t r, std::size_t c, const std::shared_ptr<Pool>& pool)
      : count(n),
        rows(r),
        columns(c),
        row_nodes({n, r}),
        column_nodes({n, c}),
        values({n, 3 * r, 3 * c}, pool) {
    std::fill_n(row_nodes.data, n * r, -1);
    std::fill_n(column_nodes.data, n * c, -1);
  }

  double* at(std::int32_t slot) const {
    return slot < 0 ? nullptr : values.data + static_cast<std::size_t>(slot) * 9 * rows * columns;
  }
  std::int32_t* row_nodes_of(std::int32_t slot) const {
    return row_nodes.data + static_cast<std::size_t>(slot) * rows;
  }
  std::int32_t* column_nodes_of(std::int32_t slot) const {
    return column_nodes.data + static_cast<std::size_t>(slot) * columns;
  }
  bool fresh(std::int32_t slot) const { return *row_nodes_of(slot) < 0; }
  /// Blocks that no point was added to.
  void clear_rest() const {
    for (std::size_t i = 0; i < count; ++i)
      if (const auto slot = static_cast<std::int32_t>(i); fresh(slot))
        std::fill_n(at(slot), 9 * rows * columns, 0.0);
  }

  nb::tuple result() const {
    return nb::make_tuple(row_nodes.array, column_nodes.array, values.array);
  }
};

/// A block that points are being added to, one after the other. It is summed close to the processor
/// and goes to its place in memory, which takes longer than the sum, once and past all caches.
class OpenBlock {
 public:
  explicit OpenBlock(const Blocks& blocks) : blocks_(blocks) {}
  OpenBlock(const OpenBlock&) = delete;
  OpenBlock& operator=(const OpenBlock&) = delete;
  ~OpenBlock() {
    close();
    fence();
  }

  /// The block of a slot; the one before is closed.
  kernel::Block at(std::int32_t slot) {
    const bool fresh = slot != slot_;
    if (fresh) {
      close();
      slot_ = slot;
    }
    return {slot < 0 ? nullptr : values_.data(), fresh};
  }

 private:
  static constexpr std::size_t most = 3 * 2 * kernel::most_nodes;

  void close() const {
    if (slot_ >= 0) stream(values_.data(), 9 * blocks_.rows * blocks_.columns, blocks_.at(slot_));
  }

  const Blocks& blocks_;
  std::int32_t slot_{-1};
  alignas(64) std::array<double, most * most> values_;
};

/// Blocks of the facets that meet, and of those on which only the history was committed.
struct PairBlocks {
  Blocks own, earlier;
};

/// Adds points to blocks, those of a block one after the other.
class BlockWriter {
 public:
  BlockWriter(const Batch& batch, const Slots& slots, const PairBlocks& blocks)
      : batch_(batch), slots_(slots), blocks_(blocks), own_(blocks.own), earlier_(blocks.earlier) {}

  /// The nodes of a block are named with its first point.
  void add(std::size_t p, const kernel::PairResult& r, const kernel::PairSlopes& d, const Seen& s,
           std::int64_t committed) {
    const std::int32_t o = slots_.own[p], e = slots_.earlier[p];
    if (o < 0) return;
    const kernel::Block own = own_.at(o), earlier = earlier_.at(e);
    if (own.fresh) {
      name_rows(p, blocks_.own.row_nodes_of(o));
      name_rows(p, blocks_.own.column_nodes_of(o));
    }
    if (e >= 0 && earlier.fresh) {
      name_rows(p, blocks_.earlier.row_nodes_of(e));
      batch_.mesh.copy_nodes(committed, blocks_.earlier.column_nodes_of(e));
    }
    kernel::add_tangent(r, d, s.shapes, own, earlier);
  }

 private:
  void name_rows(std::size_t p, std::int32_t* to) const {
    const std::size_t ks = batch_.slave.width;
    to = std::copy_n(batch_.slave.nodes + p * ks, ks, to);
    batch_.mesh.copy_nodes(batch_.hits.facet[p], to);
  }

  const Batch& batch_;
  const Slots& slots_;
  const PairBlocks& blocks_;
  OpenBlock own_, earlier_;
};

}  // namespace anisocontact::bindings
