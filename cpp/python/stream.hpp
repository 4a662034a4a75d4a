#pragma once
// Stores that go past the caches: for results that are written once and are larger than these.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "anisocontact/tensor/inline.hpp"

#if defined(ANISOCONTACT_HAS_WIDE)
#include <immintrin.h>
#endif

namespace anisocontact::bindings {

#if defined(ANISOCONTACT_HAS_WIDE)
ANISOCONTACT_WIDE inline void stream_wide(const double* from, std::size_t n, double* to) {
  constexpr std::size_t width = 4;
  for (std::size_t i = 0; i < n; i += width) _mm256_stream_pd(to + i, _mm256_loadu_pd(from + i));
  _mm256_zeroupper();
}
#endif

/// Copies n numbers; until `fence` other threads may not see them.
inline void stream(const double* from, std::size_t n, double* to) {
#if defined(ANISOCONTACT_HAS_WIDE)
  constexpr std::size_t numbers = 4, bytes = 32;
  if (wide_registers && n % numbers == 0 && reinterpret_cast<std::uintptr_t>(to) % bytes == 0)
    return stream_wide(from, n, to);
#endif
  std::copy_n(from, n, to);
}

inline void fence() {
#if defined(ANISOCONTACT_HAS_WIDE)
  _mm_sfence();
#endif
}

}  // namespace anisocontact::bindings
