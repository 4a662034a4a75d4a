#pragma once
// Shape functions of facets, with first and second derivatives, in closed form.
//
// Nodes are in the order of DOLFINx (basix, Lagrange): vertices, then edges, then the interior.
//   triangle       (0,0) (1,0) (0,1); edges 0: (1,2), 1: (0,2), 2: (0,1), edge k opposite vertex k
//   quadrilateral  (0,0) (1,0) (0,1) (1,1); edges 0: (0,1), 1: (0,2), 2: (1,3), 3: (2,3)
// quad8 is quad9 without its centre: the serendipity functions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace anisocontact::surface {

enum class Topology : std::uint8_t { tri3, tri6, quad4, quad8, quad9 };

inline constexpr std::size_t max_facet_nodes = 9;
inline constexpr std::array<std::string_view, 5> topology_names{"tri3", "tri6", "quad4", "quad8",
                                                                "quad9"};

constexpr std::size_t node_count(Topology t) {
  constexpr std::array<std::size_t, 5> n{3, 6, 4, 8, 9};
  return n[static_cast<std::size_t>(t)];
}
constexpr bool triangular(Topology t) { return t == Topology::tri3 || t == Topology::tri6; }
/// Number of sides, and of vertices.
constexpr std::size_t side_count(Topology t) { return triangular(t) ? 3 : 4; }

constexpr std::optional<Topology> topology_of(std::string_view name) {
  for (std::size_t i = 0; i < topology_names.size(); ++i)
    if (topology_names[i] == name) return static_cast<Topology>(i);
  return std::nullopt;
}

/// The two vertices of a side.
constexpr std::array<std::size_t, 2> side_vertices(Topology t, std::size_t side) {
  constexpr std::array<std::array<std::size_t, 2>, 3> tri{{{1, 2}, {0, 2}, {0, 1}}};
  constexpr std::array<std::array<std::size_t, 2>, 4> quad{{{0, 1}, {0, 2}, {1, 3}, {2, 3}}};
  return triangular(t) ? tri[side] : quad[side];
}

/// Whether a side runs clockwise from its first to its second vertex.
constexpr bool side_runs_back(std::size_t side) { return side % 2 == 1; }

/// Coordinates of a vertex on the reference facet.
constexpr std::array<double, 2> vertex_coordinates(std::size_t vertex) {
  return {static_cast<double>(vertex % 2), static_cast<double>(vertex / 2)};
}

/// Values N, first derivatives (along xi^1, xi^2) and second derivatives (11, 12, 22) of the shape
/// functions at a point; entries from node_count on are zero.
template <class S>
struct Shape {
  std::array<S, max_facet_nodes> N{};
  std::array<std::array<S, 2>, max_facet_nodes> dN{};
  std::array<std::array<S, 3>, max_facet_nodes> d2N{};
};

namespace detail {

/// Values, first and second derivatives of the functions of a line, at 0, 1 and (degree 2) 1/2.
template <class S>
struct Line {
  std::array<S, 3> f, d;
  std::array<double, 3> dd;
};

template <class S>
constexpr Line<S> line1(const S& t) {
  return {{S(1.0) - t, t, S(0.0)}, {S(-1.0), S(1.0), S(0.0)}, {0.0, 0.0, 0.0}};
}

template <class S>
constexpr Line<S> line2(const S& t) {
  const S one(1.0), two(2.0), four(4.0);
  return {{(one - t) * (one - two * t), t * (two * t - one), four * t * (one - t)},
          {four * t - S(3.0), four * t - one, four * (one - two * t)},
          {4.0, 4.0, -8.0}};
}

/// Zeros from a node on.
template <class S>
constexpr void clear(std::size_t first, Shape<S>& s) {
  for (std::size_t k = first; k < max_facet_nodes; ++k) {
    s.N[k] = S(0.0);
    s.dN[k] = {S(0.0), S(0.0)};
    s.d2N[k] = {S(0.0), S(0.0), S(0.0)};
  }
}

/// Functions of the line along xi^1 and xi^2 that make the function of a node of quad4 or quad9.
inline constexpr std::array<std::array<std::size_t, 2>, 9> tensor_index{
    {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0}, {0, 2}, {1, 2}, {2, 1}, {2, 2}}};

template <class S>
constexpr void tensor_product(const Line<S>& a, const Line<S>& b, std::size_t count, Shape<S>& s) {
  for (std::size_t k = 0; k < count; ++k) {
    const auto [i, j] = tensor_index[k];
    s.N[k] = a.f[i] * b.f[j];
    s.dN[k] = {a.d[i] * b.f[j], a.f[i] * b.d[j]};
    s.d2N[k] = {S(a.dd[i]) * b.f[j], a.d[i] * b.d[j], a.f[i] * S(b.dd[j])};
  }
}

/// A function of the serendipity family has at the centre -1/4 of its values at the vertices plus
/// 1/2 of those at the edges: this share of the bubble of quad9 goes to the eight nodes.
template <class S>
constexpr void drop_centre(Shape<S>& s) {
  for (std::size_t k = 0; k < 8; ++k) {
    const S share(k < 4 ? -0.25 : 0.5);
    s.N[k] += share * s.N[8];
    for (std::size_t i = 0; i < 2; ++i) s.dN[k][i] += share * s.dN[8][i];
    for (std::size_t i = 0; i < 3; ++i) s.d2N[k][i] += share * s.d2N[8][i];
  }
  s.N[8] = S(0.0);
  s.dN[8] = {S(0.0), S(0.0)};
  s.d2N[8] = {S(0.0), S(0.0), S(0.0)};
}

template <class S>
constexpr void triangle1(const S& u, const S& v, Shape<S>& s) {
  s.N[0] = S(1.0) - u - v;
  s.N[1] = u;
  s.N[2] = v;
  s.dN[0] = {S(-1.0), S(-1.0)};
  s.dN[1] = {S(1.0), S(0.0)};
  s.dN[2] = {S(0.0), S(1.0)};
}

template <class S>
constexpr void triangle2(const S& u, const S& v, Shape<S>& s) {
  const S one(1.0), two(2.0), four(4.0), zero(0.0);
  const S w = one - u - v;
  s.N[0] = w * (two * w - one);
  s.N[1] = u * (two * u - one);
  s.N[2] = v * (two * v - one);
  s.N[3] = four * u * v;
  s.N[4] = four * v * w;
  s.N[5] = four * u * w;
  s.dN[0] = {one - four * w, one - four * w};
  s.dN[1] = {four * u - one, zero};
  s.dN[2] = {zero, four * v - one};
  s.dN[3] = {four * v, four * u};
  s.dN[4] = {-four * v, four * (w - v)};
  s.dN[5] = {four * (w - u), -four * u};
  s.d2N[0] = {four, four, four};
  s.d2N[1] = {four, zero, zero};
  s.d2N[2] = {zero, zero, four};
  s.d2N[3] = {zero, four, zero};
  s.d2N[4] = {zero, -four, S(-8.0)};
  s.d2N[5] = {S(-8.0), -four, zero};
}

}  // namespace detail

/// Shape functions at the coordinates (u, v) of the reference facet.
template <class S>
constexpr void shape(Topology t, const S& u, const S& v, Shape<S>& s) noexcept {
  detail::clear(triangular(t) ? 0 : node_count(t), s);
  switch (t) {
    case Topology::tri3:
      return detail::triangle1(u, v, s);
    case Topology::tri6:
      return detail::triangle2(u, v, s);
    case Topology::quad4:
      return detail::tensor_product(detail::line1(u), detail::line1(v), 4, s);
    case Topology::quad9:
      return detail::tensor_product(detail::line2(u), detail::line2(v), 9, s);
    case Topology::quad8:
      detail::tensor_product(detail::line2(u), detail::line2(v), 9, s);
      return detail::drop_centre(s);
  }
}

}  // namespace anisocontact::surface
