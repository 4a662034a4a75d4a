#pragma once
// Small operations that have to be part of the code that uses them: a compiler that counts
// instructions before it optimises would call many of them.

#include <cstddef>
#include <utility>

#if defined(__GNUC__)
#define ANISOCONTACT_INLINE [[gnu::always_inline]] inline
#define ANISOCONTACT_INLINE_LAMBDA __attribute__((always_inline))
#else
#define ANISOCONTACT_INLINE inline
#define ANISOCONTACT_INLINE_LAMBDA
#endif

namespace anisocontact {

/// Calls f(0) to f(N - 1), written out. Compilers keep a small array in registers where every index
/// is a constant before they look at loops.
template <std::size_t N, class F>
ANISOCONTACT_INLINE constexpr void each(const F& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>)
      ANISOCONTACT_INLINE_LAMBDA { (f(I), ...); }(std::make_index_sequence<N>{});
}

#if defined(__GNUC__) && defined(__x86_64__)
#define ANISOCONTACT_WIDE [[gnu::noinline, gnu::flatten, gnu::target("avx2,fma")]]
/// Without fused products, which round once where a product and a sum round twice.
#define ANISOCONTACT_UNFUSED [[gnu::noinline, gnu::flatten, gnu::target("avx2")]]
/// What other processors run: by itself too, for code that is compiled for wide registers holds code that
/// is compiled twice, and would hold this half of it again.
#define ANISOCONTACT_NARROW [[gnu::noinline]]
#define ANISOCONTACT_HAS_WIDE
/// Whether this processor has registers of four numbers. Which code runs depends on the machine
/// alone, so that results are the same from run to run.
inline const bool wide_registers = [] {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}();
#else
#define ANISOCONTACT_WIDE
#define ANISOCONTACT_UNFUSED
#define ANISOCONTACT_NARROW
inline constexpr bool wide_registers = false;
#endif

#if defined(ANISOCONTACT_HAS_WIDE) && !defined(__clang__)
#define ANISOCONTACT_LONG        \
  [[gnu::noinline, gnu::flatten, \
    gnu::target("avx2,fma,avx512f,avx512dq,avx512vl,prefer-vector-width=512")]]
/// Whether this processor has registers of eight numbers.
inline const bool long_registers = [] {
  __builtin_cpu_init();
  return wide_registers && __builtin_cpu_supports("avx512f") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
}();
#else
#define ANISOCONTACT_LONG
inline constexpr bool long_registers = false;
#endif

namespace detail {
template <class F>
ANISOCONTACT_WIDE void call_wide(const F& f) {
  f();
}
template <class F>
ANISOCONTACT_LONG void call_long(const F& f) {
  f();
}
template <class F>
ANISOCONTACT_UNFUSED void call_unfused(const F& f) {
  f();
}
template <class F>
ANISOCONTACT_NARROW void call_narrow(const F& f) {
  f();
}
}  // namespace detail

/// Calls f, which has to be inlined, compiled twice: for every processor, and for wide registers.
template <class F>
void with_widest(const F& f) {
  if (wide_registers)
    detail::call_wide(f);
  else
    detail::call_narrow(f);
}

/// The same with results that have the same digits whatever is compiled beside: where there are no
/// fused products to choose, a number does not depend on what else is asked for. Where the compiler
/// may fuse everywhere, as with ANISOCONTACT_NATIVE and beside x86-64, the last digits may.
template <class F>
void with_unfused(const F& f) {
  if (wide_registers)
    detail::call_unfused(f);
  else
    detail::call_narrow(f);
}

/// As `with_widest` for loops along rows of numbers, compiled once more for registers of eight.
template <class F>
void with_longest(const F& f) {
  if (long_registers)
    detail::call_long(f);
  else
    with_widest(f);
}

}  // namespace anisocontact
