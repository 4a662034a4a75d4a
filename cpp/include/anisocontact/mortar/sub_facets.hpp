#pragma once
// Facets as parts with straight edges: those of order 1 are one part, those of order 2 four
// [Puso Laursen Solberg 2008]. Overlaps are cut between parts; shape functions stay those of the facet.

#include <array>
#include <cstddef>
#include <span>

#include "anisocontact/surface/facet_shapes.hpp"

namespace anisocontact::mortar {

/// Part of a facet between three or four of its nodes, once around.
struct SubFacet {
  std::size_t corners;
  std::array<std::size_t, 4> node;          ///< of the facet
  std::array<std::array<double, 2>, 4> at;  ///< coordinates of these nodes on the facet
};

/// Linear or bilinear functions of the corners of a part, with derivatives; (s, t) runs from the
/// first corner to the second, and to the last.
struct CornerShape {
  std::array<double, 4> N{};
  std::array<std::array<double, 2>, 4> dN{};

  CornerShape(std::size_t corners, double s, double t) {
    if (corners == 3) {
      N = {1.0 - s - t, s, t, 0.0};
      dN = {{{-1.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}, {0.0, 0.0}}};
      return;
    }
    N = {(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t};
    dN = {{{t - 1.0, s - 1.0}, {1.0 - t, -s}, {t, s}, {-t, 1.0 - s}}};
  }
};

namespace detail {
using At = std::array<std::array<double, 2>, 4>;
inline constexpr std::array<SubFacet, 1> tri3{
    {{3, {0, 1, 2, 0}, At{{{0, 0}, {1, 0}, {0, 1}, {0, 0}}}}}};
inline constexpr std::array<SubFacet, 1> quad4{
    {{4, {0, 1, 3, 2}, At{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}}}};
inline constexpr double h = 0.5;
inline constexpr std::array<SubFacet, 4> tri6{
    {{3, {0, 5, 4, 0}, At{{{0, 0}, {h, 0}, {0, h}, {0, 0}}}},
     {3, {5, 1, 3, 0}, At{{{h, 0}, {1, 0}, {h, h}, {0, 0}}}},
     {3, {4, 3, 2, 0}, At{{{0, h}, {h, h}, {0, 1}, {0, 0}}}},
     {3, {5, 3, 4, 0}, At{{{h, 0}, {h, h}, {0, h}, {0, 0}}}}}};
inline constexpr std::array<SubFacet, 4> quad9{
    {{4, {0, 4, 8, 5}, At{{{0, 0}, {h, 0}, {h, h}, {0, h}}}},
     {4, {4, 1, 6, 8}, At{{{h, 0}, {1, 0}, {1, h}, {h, h}}}},
     {4, {5, 8, 7, 2}, At{{{0, h}, {h, h}, {h, 1}, {0, 1}}}},
     {4, {8, 6, 3, 7}, At{{{h, h}, {1, h}, {1, 1}, {h, 1}}}}}};
}  // namespace detail

/// The parts of a facet; quad8, which has no node at its centre, is one part with its vertices.
inline std::span<const SubFacet> sub_facets(surface::Topology t) {
  switch (t) {
    case surface::Topology::tri3:
      return detail::tri3;
    case surface::Topology::tri6:
      return detail::tri6;
    case surface::Topology::quad9:
      return detail::quad9;
    default:
      return detail::quad4;
  }
}

}  // namespace anisocontact::mortar
