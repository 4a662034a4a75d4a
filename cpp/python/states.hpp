#pragma once
// States of points as rows of bytes.

#include <cstring>
#include <stdexcept>

#include "anisocontact/kernel/point.hpp"
#include "arrays.hpp"

namespace anisocontact::bindings {

using Codes = nb::ndarray<const std::int8_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

inline kernel::PointState load(const std::uint8_t* bytes, std::size_t i) {
  kernel::PointState s;
  std::memcpy(&s, bytes + i * sizeof(s), sizeof(s));
  return s;
}

/// Asks memory for a state that is loaded soon.
inline void prefetch([[maybe_unused]] const std::uint8_t* bytes, [[maybe_unused]] std::size_t i) {
#if defined(__GNUC__)
  constexpr std::size_t line = 64, size = sizeof(kernel::PointState);
  for (std::size_t k = 0; k < size; k += line) __builtin_prefetch(bytes + i * size + k);
#endif
}

inline void store(std::uint8_t* bytes, std::size_t i, const kernel::PointState& s) {
  std::memcpy(bytes + i * sizeof(s), &s, sizeof(s));
}

inline void check_states(const Bytes& state, std::size_t n) {
  if (state.shape(0) != n || state.shape(1) != sizeof(kernel::PointState))
    throw std::invalid_argument("state does not belong to these points");
}

/// States before the first step, and which points have no projection.
inline nb::dict initial_states(const surface::AnySurface& surface, const Points& x) {
  const std::size_t n = x.shape(0);
  Array<std::uint8_t> state({n, sizeof(kernel::PointState)});
  Array<std::int8_t> failure({n});
  for (std::size_t i = 0; i < n; ++i) {
    auto f = kernel::Failure::none;
    store(state.data, i, kernel::initial_state(surface, row3(x.data(), i), f));
    failure.data[i] = static_cast<std::int8_t>(f);
  }
  nb::dict r;
  r["state"] = state.array;
  r["failure"] = failure.array;
  return r;
}

}  // namespace anisocontact::bindings
