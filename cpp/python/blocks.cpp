// Matrices of unknowns from blocks of pairs of nodes, and sums of fronts of a factorisation.

#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <vector>

#include "arrays.hpp"
#include "rooms.hpp"

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

using Front = nb::ndarray<double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Left = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// Add the lower triangle of what a front leaves to the next one: to the columns that are eliminated there, and
/// to the rest. Places, of rows and columns alike, ascend.
void add_front(const Front& columns, const Front& rest, const Left& left, const Places& places) {
  const std::size_t n = places.shape(0), width = columns.shape(1), size = rest.shape(1);
  const std::vector<std::size_t> place(places.data(), places.data() + n);
  const auto split =
      static_cast<std::size_t>(std::lower_bound(place.begin(), place.end(), width) - place.begin());
  for (std::size_t a = 0; a < n; ++a) {
    const double* from = left.data() + a * n;
    double* to = columns.data() + place[a] * width;
    for (std::size_t b = 0; b < std::min(split, a + 1); ++b) to[place[b]] += from[b];
    if (a < split) continue;
    to = rest.data() + (place[a] - width) * size;
    for (std::size_t b = split; b <= a; ++b) to[place[b] - width] += from[b];
  }
}

}  // namespace

void bind_blocks(nb::module_& m) {
  m.def("block_entries", &block_entries, nb::arg("row"), nb::arg("column"), nb::arg("number"),
        nb::arg("size"));
  m.def("add_front", &add_front, nb::arg("columns"), nb::arg("rest"), nb::arg("left"),
        nb::arg("places"));
}

}  // namespace anisocontact::bindings
