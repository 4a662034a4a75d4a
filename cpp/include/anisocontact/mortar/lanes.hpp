#pragma once
// Numbers side by side that share vector registers.

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::mortar {

/// Numbers side by side, one for each function of a slave facet, so that they share registers.
template <std::size_t L>
struct alignas(32) Lanes {
  std::array<double, L> v{};

  double& operator[](std::size_t l) { return v[l]; }
  double operator[](std::size_t l) const { return v[l]; }
  /// this += f other
  ANISOCONTACT_INLINE void add(double f, const Lanes& other) {
    each_register([&](std::size_t l, auto& x, auto& y) ANISOCONTACT_INLINE_LAMBDA {
      std::memcpy(&x, other.v.data() + l, sizeof x);
      std::memcpy(&y, v.data() + l, sizeof y);
      y += f * x;
      std::memcpy(v.data() + l, &y, sizeof y);
    });
  }
  ANISOCONTACT_INLINE friend Lanes operator*(double f, const Lanes& factor) {
    Lanes out;
    each_register([&](std::size_t l, auto& x, auto& y) ANISOCONTACT_INLINE_LAMBDA {
      std::memcpy(&x, factor.v.data() + l, sizeof x);
      y = f * x;
      std::memcpy(out.v.data() + l, &y, sizeof y);
    });
    return out;
  }
  ANISOCONTACT_INLINE friend Lanes operator+(const Lanes& x, const Lanes& y) {
    Lanes out = x;
    out.add(1.0, y);
    return out;
  }

 private:
#if defined(__GNUC__)
  using Register = double __attribute__((vector_size(32)));
#else
  using Register = double;
#endif
  template <class F>
  ANISOCONTACT_INLINE static void each_register(const F& f) {
    Register x, y;
    for (std::size_t l = 0; l < L; l += sizeof(Register) / sizeof(double)) f(l, x, y);
  }
};

/// Calls f with a number of lanes that so many functions fit in, as a constant.
template <class F>
auto with_lanes(std::size_t functions, const F& f) {
  using std::integral_constant;
  if (functions <= 4) return f(integral_constant<std::size_t, 4>{});
  if (functions <= 8) return f(integral_constant<std::size_t, 8>{});
  return f(integral_constant<std::size_t, 12>{});
}

}  // namespace anisocontact::mortar
