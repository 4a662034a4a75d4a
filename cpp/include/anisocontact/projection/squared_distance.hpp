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

/// |rho - x|^2 over a triangle of degree 2 from the control points relative to x.
inline TriangleBernstein triangle_distance(const FacetNodes& p) noexcept {
  TriangleBernstein f{{}, whole_facet};
  const auto multinomial = [](std::size_t n, std::size_t i, std::size_t j) {
    return binomial(n, i) * binomial(n - i, j);
  };
  for (std::size_t j = 0; j <= 2; ++j)
    for (std::size_t i = 0; i + j <= 2; ++i)
      for (std::size_t l = 0; l <= 2; ++l)
        for (std::size_t k = 0; k + l <= 2; ++k)
          f.c[TriangleBernstein::index(i + k, j + l)] +=
              multinomial(2, i, j) * multinomial(2, k, l) / multinomial(4, i + k, j + l) *
              p[surface::triangle_index(2, i, j)].dot(p[surface::triangle_index(2, k, l)]);
  return f;
}

}  // namespace anisocontact::projection
