#pragma once
// Numbers side by side that share vector registers.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "anisocontact/tensor/inline.hpp"

/// Functions that are compiled once, not for all kinds of registers: they have nothing to gain.
#if defined(__GNUC__)
#define ANISOCONTACT_ONCE [[gnu::noinline]]
#else
#define ANISOCONTACT_ONCE
#endif

namespace anisocontact::mortar {

namespace detail {
template <std::size_t W>
struct RegisterOf {
#if defined(__GNUC__)
  using type [[gnu::vector_size(W * sizeof(double))]] = double;
  using anywhere [[gnu::vector_size(W * sizeof(double)), gnu::aligned(8), gnu::may_alias]] = double;
#else
  using type = double;
  using anywhere = double;
#endif
};
}  // namespace detail

/// L numbers in registers of W.
template <std::size_t L, std::size_t W = 4>
class alignas(W * sizeof(double)) Lanes {
 public:
  ANISOCONTACT_INLINE Lanes() : Lanes(0.0) {}
  ANISOCONTACT_INLINE explicit Lanes(double x) {
    for (auto& one : r_) one = Register{} + x;
  }
  /// Numbers in memory, registers `stride` apart. They are read as a whole: the halves of a register that
  /// were copied apart would have to wait for each other.
  ANISOCONTACT_INLINE static Lanes from(const double* p, std::size_t stride = W) {
    Lanes out;
    for (std::size_t c = 0; c < count; ++c)
      out.r_[c] = *reinterpret_cast<const Anywhere*>(p + c * stride);
    return out;
  }
  /// Writes them there.
  ANISOCONTACT_INLINE void to(double* p, std::size_t stride = W) const {
    for (std::size_t c = 0; c < count; ++c) *reinterpret_cast<Anywhere*>(p + c * stride) = r_[c];
  }
  ANISOCONTACT_INLINE double operator[](std::size_t l) const {
    double x;
    std::memcpy(&x, reinterpret_cast<const char*>(r_) + l * sizeof x, sizeof x);
    return x;
  }
  ANISOCONTACT_INLINE void set(std::size_t l, double x) {
    std::memcpy(reinterpret_cast<char*>(r_) + l * sizeof x, &x, sizeof x);
  }
  /// this += f other
  ANISOCONTACT_INLINE void add(double f, const Lanes& other) {
    for (std::size_t c = 0; c < count; ++c) r_[c] += f * other.r_[c];
  }
  ANISOCONTACT_INLINE Lanes& operator+=(const Lanes& y) { return *this = *this + y; }
  ANISOCONTACT_INLINE friend Lanes operator*(double f, const Lanes& x) {
    return each(x, x, [f](auto& a, const auto& b) ANISOCONTACT_INLINE_LAMBDA { a = f * b; });
  }
  ANISOCONTACT_INLINE friend Lanes operator+(const Lanes& x, const Lanes& y) {
    return each(x, y, [](auto& a, const auto& b) ANISOCONTACT_INLINE_LAMBDA { a += b; });
  }
  ANISOCONTACT_INLINE friend Lanes operator-(const Lanes& x, const Lanes& y) {
    return each(x, y, [](auto& a, const auto& b) ANISOCONTACT_INLINE_LAMBDA { a -= b; });
  }
  ANISOCONTACT_INLINE friend Lanes operator-(const Lanes& x) { return Lanes() - x; }
  ANISOCONTACT_INLINE friend Lanes operator*(const Lanes& x, const Lanes& y) {
    return each(x, y, [](auto& a, const auto& b) ANISOCONTACT_INLINE_LAMBDA { a *= b; });
  }
  ANISOCONTACT_INLINE friend Lanes operator/(const Lanes& x, const Lanes& y) {
    return each(x, y, [](auto& a, const auto& b) ANISOCONTACT_INLINE_LAMBDA { a /= b; });
  }
  ANISOCONTACT_INLINE friend Lanes sqrt(const Lanes& x) {
    std::array<double, L> roots;
    x.to(roots.data());
    for (double& one : roots) one = std::sqrt(one);
    return from(roots.data());
  }

 private:
  using Register = typename detail::RegisterOf<W>::type;
  using Anywhere = typename detail::RegisterOf<W>::anywhere;
  static constexpr std::size_t count = L * sizeof(double) / sizeof(Register);

  template <class F>
  ANISOCONTACT_INLINE static Lanes each(const Lanes& x, const Lanes& y, const F& f) {
    Lanes out = x;
    for (std::size_t c = 0; c < count; ++c) f(out.r_[c], y.r_[c]);
    return out;
  }

  Register r_[count];
};

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
