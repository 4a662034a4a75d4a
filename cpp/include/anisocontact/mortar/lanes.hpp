#pragma once
// Components of plane vectors at several points in vector registers.

#include <type_traits>

#include "anisocontact/tensor/lanes.hpp"

/// Functions that are compiled once, not for all kinds of registers: they have nothing to gain.
#if defined(__GNUC__)
#define ANISOCONTACT_ONCE [[gnu::noinline]]
#else
#define ANISOCONTACT_ONCE
#endif

namespace anisocontact::mortar {

/// Both components of L plane vectors: of four lanes the first components, then the second ones.
template <std::size_t L>
class Twins : public Lanes<2 * L, 8> {
 public:
  using Both = Lanes<2 * L, 8>;
  Twins() = default;
  ANISOCONTACT_INLINE Twins(const Both& both) : Both(both) {}

  ANISOCONTACT_INLINE static std::size_t place(std::size_t d, std::size_t l) {
    return 8 * (l / 4) + 4 * d + l % 4;
  }
  /// A component.
  ANISOCONTACT_INLINE Lanes<L> part(std::size_t d) const {
    return Lanes<L>::from(reinterpret_cast<const double*>(this) + place(d, 0), 8);
  }
  /// Adds to a component, in registers of half the width: a whole one waits for both halves.
  ANISOCONTACT_INLINE void add_part(std::size_t d, const Lanes<L>& x) {
    (part(d) + x).to(reinterpret_cast<double*>(this) + place(d, 0), 8);
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
