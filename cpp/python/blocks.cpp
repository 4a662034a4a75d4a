// Matrices of unknowns from blocks of pairs of nodes.

#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"

namespace anisocontact::bindings {

namespace {

using Nodes = nb::ndarray<const std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const std::int64_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/// Where blocks of pairs of nodes, which ascend with their rows, go in a sparse matrix by rows: the number
/// that each entry is among those of all blocks, columns, and where rows begin. An unknown of a node that
/// has the number -1 is left out.
nb::tuple block_entries(const Nodes& row, const Nodes& column, const Numbers& number,
                        std::size_t size) {
  const std::size_t n = row.shape(0);
  const auto unknown = [&](std::int64_t node, std::size_t i) {
    return number.data()[3 * static_cast<std::size_t>(node) + i];
  };
  struct Entry {
    std::int64_t column, number;
  };
  std::vector<Entry> entries;  // those of the first row of the blocks of a node
  const auto each_node = [&](const auto& put) {
    for (std::size_t first = 0, p = 0; first < n; first = p) {
      entries.clear();
      for (; p < n && row.data()[p] == row.data()[first]; ++p)
        for (std::size_t j = 0; j < 3; ++j)
          if (const std::int64_t c = unknown(column.data()[p], j); c >= 0)
            entries.push_back({c, static_cast<std::int64_t>(9 * p + j)});
      for (std::size_t i = 0; i < 3; ++i)
        if (const std::int64_t r = unknown(row.data()[first], i); r >= 0)
          put(static_cast<std::size_t>(r), static_cast<std::int64_t>(3 * i));
    }
  };
  Array<std::int32_t> begin({size + 1});
  each_node([&](std::size_t r, std::int64_t) {
    begin.data[r + 1] = static_cast<std::int32_t>(entries.size());
  });
  for (std::size_t r = 0; r < size; ++r) begin.data[r + 1] += begin.data[r];
  const auto total = static_cast<std::size_t>(begin.data[size]);
  Array<std::int32_t> columns({total}, unset);
  Array<std::int64_t> numbers({total}, unset);
  const auto before = [](const Entry& a, const Entry& b) { return a.column < b.column; };
  each_node([&](std::size_t r, std::int64_t shift) {
    if (!std::is_sorted(entries.begin(), entries.end(), before))
      std::sort(entries.begin(), entries.end(), before);
    auto to = static_cast<std::size_t>(begin.data[r]);
    for (const Entry& e : entries) {
      columns.data[to] = static_cast<std::int32_t>(e.column);
      numbers.data[to++] = e.number + shift;
    }
  });
  return nb::make_tuple(numbers.array, columns.array, begin.array);
}

}  // namespace

void bind_blocks(nb::module_& m) {
  m.def("block_entries", &block_entries, nb::arg("row"), nb::arg("column"), nb::arg("number"),
        nb::arg("size"));
}

}  // namespace anisocontact::bindings
