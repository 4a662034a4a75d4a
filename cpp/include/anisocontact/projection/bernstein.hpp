#pragma once
// Polynomials in Bernstein form over a square or a triangle: the smallest coefficient is a lower
// bound, positive coefficients of the Hessian certify convexity, and halving sharpens both.
// Here they carry the squared distance of a point to a facet.

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

  /// Bounds of the second derivatives: min f_11, max |f_12|, min f_22, without the factors
  /// D (D - 1) and D^2.
  bool convex() const {
    double f11 = second(0, 0, 1), f22 = second(0, 0, row), f12 = 0.0;
    for (std::size_t j = 0; j <= D; ++j)
      for (std::size_t i = 0; i + 2 <= D; ++i) {
        f11 = std::min(f11, second(i, j, 1));
        f22 = std::min(f22, second(j, i, row));
      }
    for (std::size_t j = 0; j < D; ++j)
      for (std::size_t i = 0; i < D; ++i) {
        const double* p = &c[row * j + i];
        f12 = std::max(f12, std::abs(p[row + 1] - p[row] - p[1] + p[0]));
      }
    constexpr double d = static_cast<double>(D);
    return f11 > 0.0 && f22 > 0.0 && (d - 1.0) * (d - 1.0) * f11 * f22 > d * d * f12 * f12;
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
  double second(std::size_t i, std::size_t j, std::size_t stride) const {
    const double* p = &c[row * j + i];
    return p[2 * stride] - 2.0 * p[stride] + p[0];
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

  /// The Hessian is a convex combination of the six matrices of its coefficients.
  bool convex() const {
    for (std::size_t j = 0; j <= 2; ++j)
      for (std::size_t i = 0; i + j <= 2; ++i) {
        const double o = c[index(i, j)], a = c[index(i + 1, j)], b = c[index(i, j + 1)];
        const double f11 = c[index(i + 2, j)] - 2.0 * a + o, f22 = c[index(i, j + 2)] - 2.0 * b + o,
                     f12 = c[index(i + 1, j + 1)] - a - b + o;
        if (!(f11 > 0.0 && f11 * f22 > f12 * f12)) return false;
      }
    return true;
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
