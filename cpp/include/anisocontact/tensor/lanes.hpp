#pragma once
// Numbers side by side that share vector registers.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "anisocontact/tensor/inline.hpp"

namespace anisocontact {

namespace detail {
/// Without vectors of the compiler a register is one number.
template <std::size_t W>
struct RegisterOf {
#if defined(__GNUC__) && !defined(ANISOCONTACT_NO_VECTORS)
  using type [[gnu::vector_size(W * sizeof(double))]] = double;
  using anywhere [[gnu::vector_size(W * sizeof(double)), gnu::aligned(8), gnu::may_alias]] = double;
#else
  using type = double;
  using anywhere = double;
#endif
};

/// Writes four numbers to a register, from halves that every processor has: one that is made before the
/// compiler knows of wide registers goes through memory.
template <class Register>
ANISOCONTACT_INLINE void join(double a, double b, double c, double d, Register& to) {
#if defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12)
  using Half [[gnu::vector_size(2 * sizeof(double))]] = double;
  to = __builtin_shufflevector(Half{a, b}, Half{c, d}, 0, 1, 2, 3);
#else
  to = Register{a, b, c, d};
#endif
}
}  // namespace detail

/// L numbers in registers of W.
template <std::size_t L, std::size_t W = 4>
class alignas(W * sizeof(double)) Lanes {
 public:
  ANISOCONTACT_INLINE Lanes() : Lanes(0.0) {}
  ANISOCONTACT_INLINE explicit Lanes(double x) {
    for (auto& one : r_) one = Register{} + x;
  }
  // Register by register: copied as bytes they would go in halves, and who reads the whole would wait.
  ANISOCONTACT_INLINE Lanes(const Lanes& x) { copy(x); }
  ANISOCONTACT_INLINE Lanes& operator=(const Lanes& x) {
    copy(x);
    return *this;
  }
  /// Of L numbers.
  template <class... Numbers>
    requires(sizeof...(Numbers) == L)
  ANISOCONTACT_INLINE static Lanes of(Numbers... x) {
    if constexpr (count == 1 && L == 4) {
      Lanes out;
      detail::join(x..., out.r_[0]);
      return out;
    } else {
      return from(std::array<double, L>{x...}.data());
    }
  }
  /// Numbers in memory, registers `stride` apart. They are read as a whole: the halves of a register that
  /// were copied apart would have to wait for each other.
  ANISOCONTACT_INLINE static Lanes from(const double* p, std::size_t stride = W) {
    Lanes out;
    for (std::size_t c = 0; c < count; ++c)
      out.r_[c] = *reinterpret_cast<const Anywhere*>(p + offset(c, stride));
    return out;
  }
  /// Writes them there.
  ANISOCONTACT_INLINE void to(double* p, std::size_t stride = W) const {
    for (std::size_t c = 0; c < count; ++c)
      *reinterpret_cast<Anywhere*>(p + offset(c, stride)) = r_[c];
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
  ANISOCONTACT_INLINE void copy(const Lanes& x) {
    for (std::size_t c = 0; c < count; ++c) r_[c] = x.r_[c];
  }

  using Register = typename detail::RegisterOf<W>::type;
  using Anywhere = typename detail::RegisterOf<W>::anywhere;
  static constexpr std::size_t count = L * sizeof(double) / sizeof(Register);
  /// Number of r_ in W numbers: one, or W without vectors.
  static constexpr std::size_t parts = W * sizeof(double) / sizeof(Register);

  /// Where r_[c] is in memory where W numbers follow those before in a distance of `stride`.
  ANISOCONTACT_INLINE static constexpr std::size_t offset(std::size_t c, std::size_t stride) {
    return c / parts * stride + c % parts;
  }

  template <class F>
  ANISOCONTACT_INLINE static Lanes each(const Lanes& x, const Lanes& y, const F& f) {
    Lanes out = x;
    for (std::size_t c = 0; c < count; ++c) f(out.r_[c], y.r_[c]);
    return out;
  }

  Register r_[count];
};

}  // namespace anisocontact
