#pragma once
// States of points as rows of bytes.

#include <cstring>
#include <stdexcept>

#include "anisocontact/kernel/point.hpp"
#include "arrays.hpp"

namespace anisocontact::bindings {

using Codes = nb::ndarray<const std::int8_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// Rows that begin with the state of a point; a law that is not in the core has its own variables
/// behind it, which are nobody's business here.
struct States {
  const std::uint8_t* data;
  std::size_t stride;

  States(const Bytes& rows, std::size_t n) : data(rows.data()), stride(rows.shape(1)) {
    if (rows.shape(0) != n || stride < sizeof(kernel::PointState))
      throw std::invalid_argument("state does not belong to these points");
  }

  kernel::PointState operator[](std::size_t i) const {
    kernel::PointState s;
    std::memcpy(&s, data + i * stride, sizeof(s));
    return s;
  }
  /// Asks memory for a state that is loaded soon.
  void prefetch([[maybe_unused]] std::size_t i) const {
#if defined(__GNUC__)
    constexpr std::size_t line = 64;
    for (std::size_t k = 0; k < sizeof(kernel::PointState); k += line)
      __builtin_prefetch(data + i * stride + k);
#endif
  }
};

inline void store(std::uint8_t* bytes, std::size_t i, const kernel::PointState& s) {
  std::memcpy(bytes + i * sizeof(s), &s, sizeof(s));
}

}  // namespace anisocontact::bindings
