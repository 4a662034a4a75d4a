#pragma once
// The squared distance of a point to a piece of a rational surface in Bernstein form.
//
// With rho = A/w the function G = |A - x w|^2 - d^2 w^2 is a polynomial, and |rho - x| < d is G < 0.
// Coefficients that are all positive exclude such points. Where d is the distance at a minimum over
// the piece, G vanishes there together with its slope, so that a convex G shows that it is the least.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "anisocontact/projection/bernstein.hpp"
#include "anisocontact/projection/squared_distance.hpp"
#include "anisocontact/surface/analytic/nurbs_pieces.hpp"

namespace anisocontact::projection {

/// Coefficients of a polynomial of degree n in the first and m in the second coordinate of a
/// square, c[i (m + 1) + j]; as many as are used.
struct BernsteinTable {
  static constexpr std::size_t most =
      (2 * surface::most_degree + 1) * (2 * surface::most_degree + 1);
  std::array<std::size_t, 2> degree;
  std::array<double, most> c;  // not initialised: the buffers are large

  std::size_t row() const noexcept { return degree[1] + 1; }
  std::size_t size() const noexcept { return (degree[0] + 1) * row(); }

  double lowest() const noexcept { return *std::min_element(c.begin(), c.begin() + end()); }
  double largest() const noexcept {
    double r = 0.0;
    for (std::size_t k = 0; k < size(); ++k) r = std::max(r, std::abs(c[k]));
    return r;
  }
  /// Where the least coefficient sits.
  std::array<double, 2> where_lowest() const noexcept {
    const auto k =
        static_cast<std::size_t>(std::min_element(c.begin(), c.begin() + end()) - c.begin());
    return {static_cast<double>(k / row()) / static_cast<double>(degree[0]),
            static_cast<double>(k % row()) / static_cast<double>(degree[1])};
  }

  /// Calls f with every second difference along coordinate k.
  template <class F>
  void second_differences(std::size_t k, const F& f) const noexcept {
    const std::size_t stride = k == 0 ? row() : 1, across = k == 0 ? 1 : row();
    for (std::size_t line = 0; line <= degree[1 - k]; ++line)
      for (std::size_t i = 0; i + 2 <= degree[k]; ++i) {
        const double* p = &c[line * across + i * stride];
        f(p[0] - 2.0 * p[stride] + p[2 * stride]);
      }
  }
  /// Whether the least f_11, the least f_22 and the largest |f_12| make a positive Hessian.
  bool convex() const noexcept {
    constexpr double none = std::numeric_limits<double>::infinity();
    std::array<double, 2> least{none, none};
    for (std::size_t k = 0; k < 2; ++k)
      second_differences(k, [&](double d) { least[k] = std::min(least[k], d); });
    if (!(least[0] > 0.0 && least[1] > 0.0)) return false;
    double mixed = 0.0;
    for (std::size_t i = 0; i < degree[0]; ++i)
      for (std::size_t j = 0; j < degree[1]; ++j) {
        const double* p = &c[i * row() + j];
        mixed = std::max(mixed, std::abs(p[row() + 1] - p[row()] - p[1] + p[0]));
      }
    const auto n = static_cast<double>(degree[0]), m = static_cast<double>(degree[1]);
    return (n - 1.0) * (m - 1.0) * least[0] * least[1] > n * m * mixed * mixed;
  }
  /// Whether a stationary point of the square is its least: the function is convex; or it rises from
  /// one side on, and is convex along that.
  bool settled() const noexcept {
    if (convex()) return true;
    for (std::size_t k = 0; k < 2; ++k)
      for (const bool rising : {true, false})
        if (monotone(k, rising) && convex_on(k, rising ? 0 : degree[k])) return true;
    return false;
  }
  double bend(std::size_t k) const noexcept {
    double sum = 0.0;
    second_differences(k, [&](double d) { sum += std::abs(d); });
    return sum;
  }
  /// Keeps the first half along coordinate k and puts the second one elsewhere.
  void halve(std::size_t k, BernsteinTable& second) noexcept {
    second.degree = degree;
    const std::size_t stride = k == 0 ? row() : 1, across = k == 0 ? 1 : row();
    for (std::size_t line = 0; line <= degree[1 - k]; ++line)
      halve_line(&c[line * across], &second.c[line * across], degree[k], stride);
  }

 private:
  bool monotone(std::size_t k, bool rising) const noexcept {
    const std::size_t stride = k == 0 ? row() : 1, across = k == 0 ? 1 : row();
    for (std::size_t line = 0; line <= degree[1 - k]; ++line)
      for (std::size_t i = 0; i < degree[k]; ++i) {
        const double* p = &c[line * across + i * stride];
        if (rising ? p[stride] < p[0] : p[stride] > p[0]) return false;
      }
    return true;
  }
  /// Whether the function is convex, or monotone, on a line of constant coordinate k.
  bool convex_on(std::size_t k, std::size_t i) const noexcept {
    const std::size_t stride = k == 0 ? row() : 1, across = k == 0 ? 1 : row();
    const double* p = &c[i * stride];
    bool convex = true, rises = true, falls = true;
    for (std::size_t j = 0; j < degree[1 - k]; ++j) {
      const double d = p[(j + 1) * across] - p[j * across];
      rises = rises && d >= 0.0;
      falls = falls && d <= 0.0;
      if (j > 0) convex = convex && d >= p[j * across] - p[(j - 1) * across];
    }
    return convex || rises || falls;
  }
  std::ptrdiff_t end() const noexcept { return static_cast<std::ptrdiff_t>(size()); }
};

/// |A - x w|^2 and w^2 over a part of a piece.
struct RationalDistance {
  BernsteinTable distance, weight;
  Part part;

  /// Over a whole piece. The coefficients of a product of two Bernstein polynomials are sums of
  /// products of theirs.
  void set(const surface::NurbsPiece& piece, const std::array<std::size_t, 2>& degree,
           const Vec3<double>& x) noexcept {
    const std::size_t p = degree[0], q = degree[1], row = 2 * q + 1;
    distance.degree = weight.degree = {2 * p, 2 * q};
    std::fill_n(distance.c.begin(), distance.size(), 0.0);
    std::fill_n(weight.c.begin(), weight.size(), 0.0);
    std::array<Vec3<double>, (surface::most_degree + 1) * (surface::most_degree + 1)> away;
    const std::size_t count = (p + 1) * (q + 1);
    for (std::size_t a = 0; a < count; ++a) away[a] = piece.net[a].head<3>() - piece.net[a][3] * x;
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = a; b < count; ++b) {
        const std::size_t i = a / (q + 1), j = a % (q + 1), k = b / (q + 1), l = b % (q + 1);
        const double share = (a == b ? 1.0 : 2.0) * share_of(p, i, k) * share_of(q, j, l);
        const std::size_t at = (i + k) * row + j + l;
        distance.c[at] += share * away[a].dot(away[b]);
        weight.c[at] += share * piece.net[a][3] * piece.net[b][3];
      }
    part = {piece.lower,
            {{{piece.upper[0] - piece.lower[0], 0.0}, {0.0, piece.upper[1] - piece.lower[1]}}}};
  }

  /// G for a distance d.
  void less(double d, BernsteinTable& g) const noexcept {
    g.degree = distance.degree;
    for (std::size_t k = 0; k < distance.size(); ++k) g.c[k] = distance.c[k] - d * d * weight.c[k];
  }

  /// Keeps the first half along coordinate k; the other goes elsewhere.
  void halve(std::size_t k, RationalDistance& second) noexcept {
    distance.halve(k, second.distance);
    weight.halve(k, second.weight);
    part.edge[k][k] *= 0.5;
    second.part = part;
    second.part.origin[k] += part.edge[k][k];
  }

 private:
  using Shares =
      std::array<std::array<std::array<double, surface::most_degree + 1>, surface::most_degree + 1>,
                 surface::most_degree + 1>;
  static constexpr Shares all_shares() {
    Shares t{};
    for (std::size_t n = 1; n <= surface::most_degree; ++n)
      for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t k = 0; k <= n; ++k)
          t[n][i][k] = binomial(n, i) * binomial(n, k) / binomial(2 * n, i + k);
    return t;
  }
  /// C(n, i) C(n, k) / C(2n, i + k).
  static double share_of(std::size_t n, std::size_t i, std::size_t k) noexcept {
    static constexpr Shares table = all_shares();
    return table[n][i][k];
  }
};

}  // namespace anisocontact::projection
