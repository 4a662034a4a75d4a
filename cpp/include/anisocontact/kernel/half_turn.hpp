#pragma once
// A chord as the path that it spans: where a point turns evenly by an angle h on its way, the
// velocity at the end is the chord turned by h/2, times (h/2)/sin(h/2) for the arc.

#include <algorithm>
#include <array>
#include <cmath>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::kernel {

/// f at x as a number that carries the derivatives of x.
inline double lifted(double, double f, double) { return f; }
template <std::size_t N>
Dual<N> lifted(const Dual<N>& x, double f, double df) {
  return x.chain(f, df);
}

/// The turn of the normal from n_0 to n by the angle h, c = n_0 . n: a path along a circle that
/// spans the chord d ends with the tangent vector
///   d - (d . n) n - nu [a (d . n) + b (nu . d)],   nu = n_0 - c n,
///   a = h / (2 sin h),   b = [1 - a (1 + c)] / sin^2 h.
struct ArcOfNormals {
  double a{0.0}, b{0.0};    ///< none: the chord on the tangent plane
  double da{0.0}, db{0.0};  ///< by c

  ArcOfNormals() = default;
  explicit ArcOfNormals(double c) noexcept {
    constexpr double small = 0.02;  // below, powers of 1 - c; above, closed forms lose no more
    if (1.0 - c < small)            // than some 1e-12 in the derivatives
      near_one(1.0 - c);
    else
      closed(c);
  }

 private:
  static constexpr std::size_t most = 10;
  using Powers = std::array<double, most + 1>;
  /// a = sum_k p_k (1 - c)^k, p_k = k/(2k + 1) p_(k-1).
  static constexpr Powers powers() {
    Powers p{0.5};
    for (std::size_t k = 1; k <= most; ++k)
      p[k] = p[k - 1] * static_cast<double>(k) / static_cast<double>(2 * k + 1);
    return p;
  }

  /// With x = 1 - c: 1 - a (1 + c) = x sum_k (p_k - 2 p_(k+1)) x^k, sin^2 h = x (2 - x).
  void near_one(double x) noexcept {
    static constexpr Powers p = powers();
    constexpr double tiny = 1e-4;  // four powers are enough there
    double over = 0.0, d_over = 0.0;
    a = 0.0;
    for (std::size_t k = x < tiny ? 4 : most; k-- > 0;) {
      da = da * x + a;
      a = a * x + p[k];
      d_over = d_over * x + over;
      over = over * x + (p[k] - 2.0 * p[k + 1]);
    }
    b = over / (2.0 - x);
    db = -(d_over + b) / (2.0 - x);
    da = -da;
  }
  void closed(double c) noexcept {
    constexpr double least = 1e-12;  // normals that oppose each other have no plane to turn in
    const double squared = std::max(1.0 - c * c, least);
    a = 0.5 * std::acos(std::max(c, -1.0)) / std::sqrt(squared);
    da = (c * a - 0.5) / squared;
    b = (1.0 - a * (1.0 + c)) / squared;
    db = (2.0 * c * b - a - da * (1.0 + c)) / squared;
  }
};

/// A turn about the normal by the angle 2 h: the chord u ends with g u + h (n x u), g = h cot h.
struct HalfSpin {
  double half{0.0};  ///< h
  double g{1.0};
  double dg{0.0};  ///< by 2 h

  HalfSpin() = default;
  /// Of sine and cosine of the angle, times any positive number.
  HalfSpin(double sine, double cosine) noexcept : half(0.5 * std::atan2(sine, cosine)) {
    const double h2 = half * half;
    constexpr double small = 1e-2;  // series to rounding
    if (h2 < small * small) {
      g = 1.0 - h2 / 3.0 - h2 * h2 / 45.0;
      dg = -half * (1.0 / 3.0 + 2.0 * h2 / 45.0);
    } else {
      g = half / std::tan(half);
      dg = 0.5 * (g - g * g - h2) / half;
    }
  }
};

}  // namespace anisocontact::kernel
