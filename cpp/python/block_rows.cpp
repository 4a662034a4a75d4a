// Products of rows of 3 x 3 blocks in single precision with vectors.

#include "anisocontact/sparse/block_rows.hpp"

#include <stdexcept>

#include "arrays.hpp"
#include "bindings.hpp"

namespace anisocontact::bindings {

namespace {

using Places = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Singles = nb::ndarray<const float, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

std::span<const std::int32_t> all(const Places& places) { return {places.data(), places.shape(0)}; }

/// A x for rows of blocks; see `BlockRows` for the arrays, nodes that `columns` name are those of x.
nb::ndarray<nb::numpy, float> multiply_block_rows(const Places& starts, const Places& columns,
                                                  const Singles& blocks, const Singles& x) {
  if (starts.shape(0) == 0 ||
      blocks.shape(0) != sparse::block_size * columns.shape(0) + sparse::past_blocks)
    throw std::invalid_argument("blocks: nine numbers for each column and one more needed");
  Array<float> out({3 * (starts.shape(0) - 1)}, unset);
  sparse::multiply({all(starts), all(columns), blocks.data()}, x.data(), out.data);
  return out.array;
}

}  // namespace

void bind_block_rows(nb::module_& m) {
  m.def("multiply_block_rows", &multiply_block_rows, nb::arg("starts"), nb::arg("columns"),
        nb::arg("blocks"), nb::arg("x"));
}

}  // namespace anisocontact::bindings
