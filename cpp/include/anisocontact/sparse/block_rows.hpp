#pragma once
// Rows of 3 x 3 blocks in single precision, times a vector: bound by memory, of which they need 4.4
// bytes an entry, and rows of single entries in double precision 12.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::sparse {

/// Numbers of a block, by columns.
inline constexpr std::size_t block_size = 9;
/// Numbers that are read past the last block: columns are read four at a time.
inline constexpr std::size_t past_blocks = 1;

/// Rows of blocks, one for each node, by block rows.
struct BlockRows {
  std::span<const std::int32_t> starts;   ///< where the blocks of a row begin, rows + 1
  std::span<const std::int32_t> columns;  ///< node of each block
  const float* blocks;                    ///< with `past_blocks` more
};

namespace detail {
using Column = Eigen::Array4f;

ANISOCONTACT_INLINE void multiply(const BlockRows& a, const float* x, float* out) {
  for (std::size_t row = 0; row + 1 < a.starts.size(); ++row) {
    Column first = Column::Zero(), second = Column::Zero(), third = Column::Zero();
    const auto last = static_cast<std::size_t>(a.starts[row + 1]);
    for (auto k = static_cast<std::size_t>(a.starts[row]); k < last; ++k) {
      const float* b = a.blocks + block_size * k;
      const float* v = x + 3 * static_cast<std::size_t>(a.columns[k]);
      first += Eigen::Map<const Column>(b) * v[0];
      second += Eigen::Map<const Column>(b + 3) * v[1];
      third += Eigen::Map<const Column>(b + 6) * v[2];
    }
    const Column sum = first + second + third;
    for (Eigen::Index i = 0; i < 3; ++i) out[3 * row + static_cast<std::size_t>(i)] = sum[i];
  }
}
}  // namespace detail

/// out = A x; x has three numbers for each node, out three for each row.
inline void multiply(const BlockRows& a, const float* x, float* out) {
  with_widest([&] ANISOCONTACT_INLINE_LAMBDA { detail::multiply(a, x, out); });
}

}  // namespace anisocontact::sparse
