#pragma once
// Forward-mode dual numbers: a value with N exact first derivatives.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "anisocontact/tensor/inline.hpp"

namespace anisocontact {

/// A value `v` with its N partial derivatives `d`. Comparisons look at the value alone, so a branch
/// taken with dual numbers is the branch taken with doubles.
template <std::size_t N>
struct Dual {
  double v{0.0};
  std::array<double, N> d{};

  constexpr Dual() = default;
  constexpr Dual(double value) : v(value) {}  // a constant; implicit so that literals mix in

  /// The i-th independent variable.
  static constexpr Dual variable(double value, std::size_t i) {
    Dual x(value);
    x.d[i] = 1.0;
    return x;
  }

  ANISOCONTACT_INLINE constexpr Dual operator-() const { return chain(-v, -1.0); }
  ANISOCONTACT_INLINE constexpr Dual& operator+=(const Dual& b) {
    v += b.v;
    each<N>([&](std::size_t i) ANISOCONTACT_INLINE_LAMBDA { d[i] += b.d[i]; });
    return *this;
  }
  ANISOCONTACT_INLINE constexpr Dual& operator-=(const Dual& b) {
    v -= b.v;
    each<N>([&](std::size_t i) ANISOCONTACT_INLINE_LAMBDA { d[i] -= b.d[i]; });
    return *this;
  }
  ANISOCONTACT_INLINE constexpr Dual& operator*=(const Dual& b) {
    each<N>([&](std::size_t i) ANISOCONTACT_INLINE_LAMBDA { d[i] = d[i] * b.v + v * b.d[i]; });
    v *= b.v;
    return *this;
  }
  ANISOCONTACT_INLINE constexpr Dual& operator/=(const Dual& b) {
    const double inv = 1.0 / b.v;
    v *= inv;
    each<N>([&](std::size_t i) ANISOCONTACT_INLINE_LAMBDA { d[i] = (d[i] - v * b.d[i]) * inv; });
    return *this;
  }

  ANISOCONTACT_INLINE friend constexpr Dual operator+(Dual a, const Dual& b) { return a += b; }
  ANISOCONTACT_INLINE friend constexpr Dual operator-(Dual a, const Dual& b) { return a -= b; }
  ANISOCONTACT_INLINE friend constexpr Dual operator*(Dual a, const Dual& b) { return a *= b; }
  ANISOCONTACT_INLINE friend constexpr Dual operator/(Dual a, const Dual& b) { return a /= b; }
  ANISOCONTACT_INLINE friend constexpr Dual operator*(double a, const Dual& b) {
    return b.chain(a * b.v, a);
  }
  ANISOCONTACT_INLINE friend constexpr Dual operator*(const Dual& a, double b) { return b * a; }
  friend constexpr bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend constexpr bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend constexpr bool operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend constexpr bool operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
  friend constexpr bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
  friend constexpr bool operator!=(const Dual& a, const Dual& b) { return a.v != b.v; }

  /// f(x) with value `f` and derivative `df` at x (chain rule).
  ANISOCONTACT_INLINE constexpr Dual chain(double f, double df) const {
    Dual r(f);
    each<N>([&](std::size_t i) ANISOCONTACT_INLINE_LAMBDA { r.d[i] = df * d[i]; });
    return r;
  }

  friend Dual sqrt(const Dual& x) {
    const double s = std::sqrt(x.v);
    return x.chain(s, 0.5 / s);
  }
  friend Dual sin(const Dual& x) { return x.chain(std::sin(x.v), std::cos(x.v)); }
  friend Dual cos(const Dual& x) { return x.chain(std::cos(x.v), -std::sin(x.v)); }
  friend Dual exp(const Dual& x) {
    const double e = std::exp(x.v);
    return x.chain(e, e);
  }
  friend Dual abs(const Dual& x) { return x.v < 0.0 ? -x : x; }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double r2 = x.v * x.v + y.v * y.v;
    Dual r(std::atan2(y.v, x.v));
    each<N>([&](std::size_t i)
                ANISOCONTACT_INLINE_LAMBDA { r.d[i] = (x.v * y.d[i] - y.v * x.d[i]) / r2; });
    return r;
  }
};

/// The value of a scalar, dual or not.
constexpr double value(double x) { return x; }
template <std::size_t N>
constexpr double value(const Dual<N>& x) {
  return x.v;
}

template <class S>
using Vec3 = Eigen::Matrix<S, 3, 1>;

/// The values of a spatial vector.
template <class S>
Vec3<double> value(const Vec3<S>& x) {
  return {value(x[0]), value(x[1]), value(x[2])};
}

/// A spatial vector of constants in the scalar type S.
template <class S>
Vec3<S> constant(const Vec3<double>& x) {
  return {S(x[0]), S(x[1]), S(x[2])};
}

}  // namespace anisocontact

namespace Eigen {
template <std::size_t N>
struct NumTraits<anisocontact::Dual<N>> : NumTraits<double> {
  using Real = anisocontact::Dual<N>;
  using NonInteger = anisocontact::Dual<N>;
  using Nested = anisocontact::Dual<N>;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
};
template <std::size_t N, class Op>
struct ScalarBinaryOpTraits<anisocontact::Dual<N>, double, Op> {
  using ReturnType = anisocontact::Dual<N>;
};
template <std::size_t N, class Op>
struct ScalarBinaryOpTraits<double, anisocontact::Dual<N>, Op> {
  using ReturnType = anisocontact::Dual<N>;
};
}  // namespace Eigen
