#pragma once
// The squared distance of a point to a facet as a polynomial in Bernstein form.

#include "anisocontact/projection/bernstein.hpp"
#include "anisocontact/surface/facet_bezier.hpp"

namespace anisocontact::projection {

using surface::FacetNodes;

/// |rho - x|^2 over a quadrilateral of degree P from the control points relative to x.
template <std::size_t P>
SquareBernstein<2 * P> square_distance(const FacetNodes& p) noexcept {
  constexpr std::size_t row = P + 1, D = 2 * P;
  SquareBernstein<D> f{{}, whole_facet};
  for (std::size_t a = 0; a < row * row; ++a)
    for (std::size_t b = a; b < row * row; ++b) {
      const std::size_t i = a % row, j = a / row, k = b % row, l = b / row;
      const double weight = (a == b ? 1.0 : 2.0) * binomial(P, i) * binomial(P, j) *
                            binomial(P, k) * binomial(P, l) /
                            (binomial(D, i + k) * binomial(D, j + l));
      f.c[(D + 1) * (j + l) + i + k] += weight * p[a].dot(p[b]);
    }
  return f;
}

namespace triangle_detail {

/// Exponents of u and v of the control points of a triangle of degree 2.
inline constexpr std::array<std::array<std::size_t, 2>, 6> exponent{
    {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {0, 2}}};

/// Weight of the product of two control points in the coefficient of degree 4 it belongs to.
inline constexpr auto weight = [] {
  const auto multinomial = [](std::size_t n, std::size_t i, std::size_t j) {
    return binomial(n, i) * binomial(n - i, j);
  };
  std::array<std::array<double, 6>, 6> w{};
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b) {
      const auto [i, j] = exponent[a];
      const auto [k, l] = exponent[b];
      w[a][b] = multinomial(2, i, j) * multinomial(2, k, l) / multinomial(4, i + k, j + l);
    }
  return w;
}();

}  // namespace triangle_detail

/// |rho - x|^2 over a triangle of degree 2 from the control points relative to x.
inline TriangleBernstein triangle_distance(const FacetNodes& p) noexcept {
  using triangle_detail::exponent, triangle_detail::weight;
  TriangleBernstein f{{}, whole_facet};
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = a; b < 6; ++b)
      f.c[TriangleBernstein::index(exponent[a][0] + exponent[b][0],
                                   exponent[a][1] + exponent[b][1])] +=
          (a == b ? 1.0 : 2.0) * weight[a][b] * p[a].dot(p[b]);
  return f;
}

}  // namespace anisocontact::projection
