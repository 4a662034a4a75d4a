#pragma once
// Polynomials in Bernstein form over a square or a triangle: the smallest coefficient is a lower
// bound, coefficients of derivatives of one sign certify that there is one minimum alone, and
// halving sharpens both. Here they carry the squared distance of a point to a facet.
//
// `single()`: certainly one local minimum. Either the function is convex, or it grows everywhere
// along a side and is convex on the side (of another direction) from which it grows.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace anisocontact::projection {

/// Part of a reference facet: origin + s^1 edge_1 + s^2 edge_2 with s in the reference square or
/// triangle.
struct Part {
  std::array<double, 2> origin;
  std::array<std::array<double, 2>, 2> edge;

  std::array<double, 2> at(const std::array<double, 2>& s) const {
    return {origin[0] + s[0] * edge[0][0] + s[1] * edge[1][0],
            origin[1] + s[0] * edge[0][1] + s[1] * edge[1][1]};
  }
};

/// The whole reference facet.
inline constexpr Part whole_facet{{0.0, 0.0}, {{{1.0, 0.0}, {0.0, 1.0}}}};

/// Halves a polynomial of degree D on a line, coefficients c[0], c[stride], ...: the left half
/// stays in c, the right half goes to r (de Casteljau).
inline void halve_line(double* c, double* r, std::size_t degree, std::size_t stride) {
  r[degree * stride] = c[degree * stride];
  for (std::size_t level = 1; level <= degree; ++level) {
    for (std::size_t i = degree; i >= level; --i)
      c[i * stride] = 0.5 * (c[(i - 1) * stride] + c[i * stride]);
    r[(degree - level) * stride] = c[degree * stride];
  }
}

constexpr double binomial(std::size_t n, std::size_t k) {
  double b = 1.0;
  for (std::size_t i = 0; i < k; ++i) b *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  return b;
}

/// Adds `sign` times the product of polynomials with P x Q and R x S coefficients to rows of
/// `size`, each coefficient times its binomials.
template <std::size_t P, std::size_t Q, std::size_t R, std::size_t S>
void add_product(const double* f, const double* g, double sign, double* out, std::size_t size) {
  constexpr auto weights = []<std::size_t I, std::size_t J>() {
    std::array<double, I * J> w{};
    for (std::size_t j = 0; j < J; ++j)
      for (std::size_t i = 0; i < I; ++i) w[I * j + i] = binomial(I - 1, i) * binomial(J - 1, j);
    return w;
  };
  static constexpr auto u = weights.template operator()<P, Q>();
  static constexpr auto v = weights.template operator()<R, S>();
  std::array<double, R * S> scaled;
  for (std::size_t k = 0; k < R * S; ++k) scaled[k] = v[k] * g[k];
  for (std::size_t j = 0; j < Q; ++j)
    for (std::size_t i = 0; i < P; ++i) {
      const double a = sign * u[P * j + i] * f[P * j + i];
      for (std::size_t l = 0; l < S; ++l)
        for (std::size_t k = 0; k < R; ++k) out[size * (j + l) + i + k] += a * scaled[R * l + k];
    }
}

template <std::size_t D>
bool convex_line(const double* c, std::size_t stride) {
  for (std::size_t k = 0; k + 2 <= D; ++k)
    if (!(c[(k + 2) * stride] - 2.0 * c[(k + 1) * stride] + c[k * stride] > 0.0)) return false;
  return true;
}

/// Squared distance over a square, degree D in both coordinates; c[(D + 1) j + i].
template <std::size_t D>
struct SquareBernstein {
  static constexpr std::size_t row = D + 1;
  static constexpr bool triangular = false;
  std::array<double, row * row> c;
  Part part;

  double lower() const { return *std::min_element(c.begin(), c.end()); }

  /// Where the smallest coefficient sits: a good start for the minimum.
  std::array<double, 2> lowest() const {
    const auto k = static_cast<std::size_t>(std::min_element(c.begin(), c.end()) - c.begin());
    return {static_cast<double>(k % row) / D, static_cast<double>(k / row) / D};
  }

  bool single() const { return convex() || grows(1, row) || grows(row, 1); }

  /// f_11 > 0 and f_11 f_22 > f_12^2 everywhere: by the bounds of each, or by the coefficients of
  /// the determinant, which see that f_11, f_22 and f_12 go together.
  bool convex() const {
    const Hessian h = hessian();
    const double f11 = *std::min_element(h.f11.begin(), h.f11.end()),
                 f22 = *std::min_element(h.f22.begin(), h.f22.end());
    if (!(f11 > 0.0 && f22 > 0.0)) return false;
    double f12 = 0.0;
    for (const double f : h.f12) f12 = std::max(f12, std::abs(f));
    return f11 * f22 > f12 * f12 || h.determinant_positive();
  }

  /// Cuts across the coordinate along which the function bends more; this becomes the first half.
  SquareBernstein halve() {
    double bend1 = 0.0, bend2 = 0.0;
    for (std::size_t j = 0; j <= D; ++j)
      for (std::size_t i = 0; i + 2 <= D; ++i) {
        bend1 += std::abs(second(i, j, 1));
        bend2 += std::abs(second(j, i, row));
      }
    const std::size_t k = bend1 >= bend2 ? 0 : 1;
    SquareBernstein other;
    for (std::size_t line = 0; line <= D; ++line) {
      const std::size_t first = k == 0 ? row * line : line;
      halve_line(&c[first], &other.c[first], D, k == 0 ? 1 : row);
    }
    for (double& e : part.edge[k]) e *= 0.5;
    other.part = part;
    for (std::size_t i = 0; i < 2; ++i) other.part.origin[i] += part.edge[k][i];
    return other;
  }

 private:
  /// Whether f grows, or falls, along the coordinate with this stride everywhere, and is convex on
  /// the side where it is least.
  bool grows(std::size_t along, std::size_t across) const {
    bool up = true, down = true;
    for (std::size_t line = 0; line <= D && (up || down); ++line)
      for (std::size_t k = 0; k < D; ++k) {
        const double* p = &c[across * line + along * k];
        up = up && p[along] > p[0];
        down = down && p[along] < p[0];
      }
    return (up || down) && convex_line<D>(&c[up ? 0 : along * D], across);
  }

  double second(std::size_t i, std::size_t j, std::size_t stride) const {
    const double* p = &c[row * j + i];
    return p[2 * stride] - 2.0 * p[stride] + p[0];
  }

  /// Coefficients of the second derivatives over D (D - 1), rows of constant j; of degrees
  /// (D - 2, D), (D - 1, D - 1) and (D, D - 2).
  struct Hessian {
    std::array<double, (D - 1) * row> f11, f22;
    std::array<double, D * D> f12;

    /// Coefficients of f_11 f_22 - f_12^2, of degree 2 D - 2 in both coordinates, up to positive
    /// factors.
    bool determinant_positive() const {
      constexpr std::size_t size = 2 * D - 1;
      std::array<double, size * size> det{};
      add_product<D - 1, D + 1, D + 1, D - 1>(f11.data(), f22.data(), 1.0, det.data(), size);
      add_product<D, D, D, D>(f12.data(), f12.data(), -1.0, det.data(), size);
      return *std::min_element(det.begin(), det.end()) > 0.0;
    }
  };

  Hessian hessian() const {
    Hessian h;
    constexpr double mixed = static_cast<double>(D) / static_cast<double>(D - 1);
    for (std::size_t j = 0; j <= D; ++j)
      for (std::size_t i = 0; i + 2 <= D; ++i) {
        h.f11[(D - 1) * j + i] = second(i, j, 1);
        h.f22[row * i + j] = second(j, i, row);
      }
    for (std::size_t j = 0; j < D; ++j)
      for (std::size_t i = 0; i < D; ++i) {
        const double* p = &c[row * j + i];
        h.f12[D * j + i] = mixed * (p[row + 1] - p[row] - p[1] + p[0]);
      }
    return h;
  }
};

/// Squared distance over a triangle, degree 4; the coefficient of u^i v^j w^(4 - i - j) is
/// c[index(i, j)].
struct TriangleBernstein {
  static constexpr std::size_t degree = 4;
  static constexpr bool triangular = true;
  std::array<double, 15> c;
  Part part;

  /// Rows of constant j, one after the other.
  static constexpr std::size_t index(std::size_t i, std::size_t j) { return j * (11 - j) / 2 + i; }

  double lower() const { return *std::min_element(c.begin(), c.end()); }

  std::array<double, 2> lowest() const {
    std::array<std::size_t, 2> best{0, 0};
    for (std::size_t j = 0; j <= degree; ++j)
      for (std::size_t i = 0; i + j <= degree; ++i)
        if (c[index(i, j)] < c[index(best[0], best[1])]) best = {i, j};
    return {static_cast<double>(best[0]) / degree, static_cast<double>(best[1]) / degree};
  }

  bool single() const {
    if (convex()) return true;
    for (std::size_t from = 0; from < 3; ++from)
      for (std::size_t to = 0; to < 3; ++to)
        if (from != to && grows(from, to)) return true;
    return false;
  }

  /// f_11 > 0 and f_11 f_22 > f_12^2 everywhere, by the coefficients of both.
  bool convex() const {
    std::array<double, 15> det{};
    std::array<std::array<double, 3>, 6> h;
    constexpr std::array<double, 6> weight{1.0, 2.0, 1.0, 2.0, 2.0, 1.0};
    constexpr std::array<std::array<std::size_t, 2>, 6> at{
        {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {0, 2}}};
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [i, j] = at[k];
      const double o = c[index(i, j)], a = c[index(i + 1, j)], b = c[index(i, j + 1)];
      h[k] = {weight[k] * (c[index(i + 2, j)] - 2.0 * a + o),
              weight[k] * (c[index(i, j + 2)] - 2.0 * b + o),
              weight[k] * (c[index(i + 1, j + 1)] - a - b + o)};
      if (!(h[k][0] > 0.0)) return false;
    }
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t l = 0; l < 6; ++l)
        det[index(at[k][0] + at[l][0], at[k][1] + at[l][1])] +=
            h[k][0] * h[l][1] - h[k][2] * h[l][2];
    return *std::min_element(det.begin(), det.end()) > 0.0;
  }

  /// Cuts the side between the vertices 0 and 1. In both halves the side opposite the new vertex
  /// is the next to be cut: no half becomes a sliver.
  TriangleBernstein halve() {
    TriangleBernstein left = *this, right;
    for (std::size_t j = 0; j <= degree; ++j)
      halve_line(&left.c[index(0, j)], &right.c[index(0, j)], degree - j, 1);
    const auto& [e1, e2] = part.edge;
    right.part.origin = {part.origin[0] + 0.5 * e1[0], part.origin[1] + 0.5 * e1[1]};
    right.part.edge = {{{0.5 * e1[0], 0.5 * e1[1]}, {e2[0] - 0.5 * e1[0], e2[1] - 0.5 * e1[1]}}};
    left.part.edge[0] = {0.5 * e1[0], 0.5 * e1[1]};
    *this = left.turned().turned();
    return right.turned();
  }

 private:
  /// Whether f grows from one vertex towards another everywhere, and is convex on the side opposite
  /// the latter.
  bool grows(std::size_t from, std::size_t to) const {
    const auto at = [&](std::array<std::size_t, 3> exponent) {
      return c[index(exponent[1], exponent[2])];
    };
    for (std::size_t j = 0; j < degree; ++j)
      for (std::size_t i = 0; i + j < degree; ++i) {
        std::array<std::size_t, 3> low{degree - 1 - i - j, i, j}, high = low;
        ++low[from];
        ++high[to];
        if (!(at(high) > at(low))) return false;
      }
    const std::size_t last = 3 - from - to;
    std::array<double, degree + 1> side{};
    for (std::size_t k = 0; k <= degree; ++k) {
      std::array<std::size_t, 3> exponent{0, 0, 0};
      exponent[from] = degree - k;
      exponent[last] = k;
      side[k] = at(exponent);
    }
    return convex_line<degree>(side.data(), 1);
  }

  /// The same polynomial with the vertices 1, 2, 0 called 0, 1, 2.
  TriangleBernstein turned() const {
    TriangleBernstein t;
    for (std::size_t j = 0; j <= degree; ++j)
      for (std::size_t i = 0; i + j <= degree; ++i) t.c[index(i, j)] = c[index(degree - i - j, i)];
    const auto& [e1, e2] = part.edge;
    t.part.origin = {part.origin[0] + e1[0], part.origin[1] + e1[1]};
    t.part.edge = {{{e2[0] - e1[0], e2[1] - e1[1]}, {-e1[0], -e1[1]}}};
    return t;
  }
};

}  // namespace anisocontact::projection
