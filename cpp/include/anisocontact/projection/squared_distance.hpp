#pragma once
// The squared distance of a point to a facet as a polynomial in Bernstein form.

#include "anisocontact/projection/bernstein.hpp"
#include "anisocontact/surface/facet_bezier.hpp"

namespace anisocontact::projection {

using surface::FacetNodes;

namespace distance_detail {

/// A product of two control points, the coefficient that it belongs to, and its weight there.
struct Term {
  std::size_t a, b, to;
  double weight;
};

/// The products of N control points, each pair once; `term(a, b)` has the weight of an ordered one.
template <std::size_t N, class F>
constexpr auto pairs(const F& term) {
  std::array<Term, N*(N + 1) / 2> terms{};
  std::size_t next = 0;
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = a; b < N; ++b) {
      terms[next] = term(a, b);
      if (a != b) terms[next].weight *= 2.0;
      ++next;
    }
  return terms;
}

/// Of a quadrilateral of degree P.
template <std::size_t P>
inline constexpr auto square = pairs<(P + 1) * (P + 1)>([](std::size_t a, std::size_t b) {
  constexpr std::size_t row = P + 1, D = 2 * P;
  const std::size_t i = a % row, j = a / row, k = b % row, l = b / row;
  return Term{a, b, (D + 1) * (j + l) + i + k,
              binomial(P, i) * binomial(P, j) * binomial(P, k) * binomial(P, l) /
                  (binomial(D, i + k) * binomial(D, j + l))};
});

/// Of a triangle of degree 2, with the exponents of u and v of its control points.
inline constexpr auto triangle = pairs<6>([](std::size_t a, std::size_t b) {
  constexpr std::array<std::array<std::size_t, 2>, 6> exponent{
      {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {0, 2}}};
  const auto multinomial = [](std::size_t n, std::size_t i, std::size_t j) {
    return binomial(n, i) * binomial(n - i, j);
  };
  const auto [i, j] = exponent[a];
  const auto [k, l] = exponent[b];
  return Term{a, b, TriangleBernstein::index(i + k, j + l),
              multinomial(2, i, j) * multinomial(2, k, l) / multinomial(4, i + k, j + l)};
});

template <class Polynomial, std::size_t N>
Polynomial sum(const std::array<Term, N>& terms, const FacetNodes& p) noexcept {
  Polynomial f{{}, whole_facet};
  for (const Term& t : terms) f.c[t.to] += t.weight * p[t.a].dot(p[t.b]);
  return f;
}

}  // namespace distance_detail

/// |rho - x|^2 over a quadrilateral of degree P from the control points relative to x.
template <std::size_t P>
SquareBernstein<2 * P> square_distance(const FacetNodes& p) noexcept {
  return distance_detail::sum<SquareBernstein<2 * P>>(distance_detail::square<P>, p);
}

/// |rho - x|^2 over a triangle of degree 2 from the control points relative to x.
inline TriangleBernstein triangle_distance(const FacetNodes& p) noexcept {
  return distance_detail::sum<TriangleBernstein>(distance_detail::triangle, p);
}

}  // namespace anisocontact::projection
