#pragma once
// A facet of a mesh as a surface: its jet from nodes and shape functions. Metric, curvature and
// connection then come from surface/geometry.hpp, as for every surface.
//
// Orientation. rho_1 x rho_2 of a facet with its nodes in the order of the mesh may point into the
// body. A facet with `flip` has its coordinates exchanged, xi = (v, u) of the reference facet: its
// normal turns round and everything stays right-handed. Nodes, vertices and sides keep the numbers
// of the mesh; only coordinates and derivatives are exchanged, here and nowhere else.

#include <type_traits>
#include <utility>

#include "anisocontact/surface/facet_shapes.hpp"
#include "anisocontact/surface/geometry.hpp"
#include "anisocontact/tensor/lanes.hpp"

namespace anisocontact::surface {

struct FacetKind {
  Topology topology{Topology::tri3};
  bool flip{false};

  constexpr std::size_t nodes() const { return node_count(topology); }
  constexpr std::size_t sides() const { return side_count(topology); }
};

/// Coordinates of the facet from those of the reference facet, and back.
constexpr std::array<double, 2> exchanged(const FacetKind& k, const std::array<double, 2>& xi) {
  return k.flip ? std::array<double, 2>{xi[1], xi[0]} : xi;
}

/// Shape functions at the coordinates xi^1, xi^2 of a facet.
template <class S>
constexpr void shape(const FacetKind& k, const S& xi1, const S& xi2, Shape<S>& s) noexcept {
  if (!k.flip) return shape(k.topology, xi1, xi2, s);
  shape(k.topology, xi2, xi1, s);
  for (std::size_t i = 0; i < k.nodes(); ++i) {
    std::swap(s.dN[i][0], s.dN[i][1]);
    std::swap(s.d2N[i][0], s.d2N[i][2]);
  }
}

/// Direction of a side in the coordinates of the facet, from its first to its second vertex.
constexpr std::array<double, 2> side_direction(const FacetKind& k, std::size_t side) {
  const auto [a, b] = side_vertices(k.topology, side);
  const auto p = vertex_coordinates(a), q = vertex_coordinates(b);
  return exchanged(k, {q[0] - p[0], q[1] - p[1]});
}

namespace detail {

/// Sums the nodes of a facet, all components at once: position and first derivatives, or where it is
/// `curved` second derivatives too. `count` is a constant where loops are to be written out.
template <bool curved, class Count, class Nodes>
ANISOCONTACT_INLINE void sum_nodes(Count count, const Nodes& nodes, const Shape<double>& s,
                                   Jet<double>& j) noexcept {
  constexpr std::size_t sums = curved ? 6 : 3;
  std::array<Lanes<4>, sums> sum{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = Lanes<4>::of(nodes[i][0], nodes[i][1], nodes[i][2], 0.0);
    sum[0].add(s.N[i], x);
    for (std::size_t d = 0; d < 2; ++d) sum[1 + d].add(s.dN[i][d], x);
    if constexpr (curved)
      for (std::size_t d = 0; d < 3; ++d) sum[3 + d].add(s.d2N[i][d], x);
  }
  const auto put = [&](std::size_t k, Vec3<double>& to)
                       ANISOCONTACT_INLINE_LAMBDA { to = {sum[k][0], sum[k][1], sum[k][2]}; };
  put(0, j.position);
  for (std::size_t d = 0; d < 2; ++d) put(1 + d, j.d1[d]);
  if constexpr (curved)
    for (std::size_t d = 0; d < 3; ++d) put(3 + d, j.d2[d]);
}

}  // namespace detail

/// Jet of `count` nodes, with components `nodes[i][c]`; without `curved` the second derivatives are
/// not written.
template <bool curved, class Nodes>
ANISOCONTACT_INLINE void put_jet(std::size_t count, const Nodes& nodes, const Shape<double>& s,
                                 Jet<double>& j) noexcept {
  if (count == 4)
    detail::sum_nodes<curved>(std::integral_constant<std::size_t, 4>{}, nodes, s, j);
  else
    detail::sum_nodes<curved>(count, nodes, s, j);
}

/// Jet of a facet at the coordinates xi^1, xi^2.
template <class Nodes>
Jet<double> facet_jet(const FacetKind& k, const Nodes& nodes, double xi1, double xi2) noexcept {
  Shape<double> s;
  shape(k, xi1, xi2, s);
  Jet<double> j;
  put_jet<true>(k.nodes(), nodes, s, j);
  return j;
}

}  // namespace anisocontact::surface
