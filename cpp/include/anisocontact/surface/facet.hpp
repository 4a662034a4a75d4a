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

/// `count` is a constant where loops are to be written out.
template <class Count, class S, class Nodes>
ANISOCONTACT_INLINE void sum_nodes(Count count, const Nodes& nodes, const Shape<S>& s, bool curved,
                                   Jet<S>& j) noexcept {
  for (Eigen::Index c = 0; c < 3; ++c) {
    S position(0.0);
    std::array<S, 2> d1{S(0.0), S(0.0)};
    for (std::size_t i = 0; i < count; ++i) {
      const S x(nodes[i][c]);
      position += s.N[i] * x;
      d1[0] += s.dN[i][0] * x;
      d1[1] += s.dN[i][1] * x;
    }
    j.position[c] = position;
    j.d1[0][c] = d1[0];
    j.d1[1][c] = d1[1];
    if (!curved) continue;
    std::array<S, 3> d2{S(0.0), S(0.0), S(0.0)};
    for (std::size_t i = 0; i < count; ++i) {
      const S x(nodes[i][c]);
      d2[0] += s.d2N[i][0] * x;
      d2[1] += s.d2N[i][1] * x;
      d2[2] += s.d2N[i][2] * x;
    }
    for (std::size_t d = 0; d < 3; ++d) j.d2[d][c] = d2[d];
  }
}

}  // namespace detail

/// Jet of a facet; `nodes[i]` is the position of node i (Vec3<S>, or Vec3<double> for any S).
/// Without `curved` the second derivatives are not written.
template <class S, class Nodes>
void put_facet_jet(const FacetKind& k, const Nodes& nodes, const Shape<S>& s, bool curved,
                   Jet<S>& j) noexcept {
  if (k.topology == Topology::quad4)
    detail::sum_nodes(std::integral_constant<std::size_t, 4>{}, nodes, s, curved, j);
  else
    detail::sum_nodes(k.nodes(), nodes, s, curved, j);
}
template <class S, class Nodes>
Jet<S> facet_jet(const FacetKind& k, const Nodes& nodes, const Shape<S>& s) noexcept {
  Jet<S> j;
  put_facet_jet(k, nodes, s, true, j);
  return j;
}

/// Jet of a facet at the coordinates xi^1, xi^2.
template <class S, class Nodes>
Jet<S> facet_jet(const FacetKind& k, const Nodes& nodes, const S& xi1, const S& xi2) noexcept {
  Shape<S> s;
  shape(k, xi1, xi2, s);
  return facet_jet(k, nodes, s);
}

}  // namespace anisocontact::surface
