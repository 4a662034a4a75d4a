#pragma once
// Facets in Bezier form: the control points bound the facet, and products of control points are
// the coefficients of products of positions.

#include "anisocontact/surface/facet_shapes.hpp"
#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::surface {

/// Positions of the nodes of a facet; entries from node_count on are not used.
using FacetNodes = std::array<Vec3<double>, max_facet_nodes>;

/// Number of control points: those of a quadrilateral in rows of constant v, those of u^i v^j w^k of
/// a triangle in rows of constant j.
constexpr std::size_t control_count(Topology t) { return t == Topology::quad8 ? 9 : node_count(t); }

namespace detail {

/// From the value at the middle of a parabola to its control point.
inline Vec3<double> middle_control(const Vec3<double>& a, const Vec3<double>& middle,
                                   const Vec3<double>& b) {
  return 2.0 * middle - 0.5 * (a + b);
}

inline FacetNodes square_controls(const FacetNodes& x, const Vec3<double>& centre) {
  const Vec3<double> low = middle_control(x[0], x[4], x[1]),
                     high = middle_control(x[2], x[7], x[3]),
                     across = middle_control(x[5], centre, x[6]);
  return {x[0],
          low,
          x[1],
          middle_control(x[0], x[5], x[2]),
          middle_control(low, across, high),
          middle_control(x[1], x[6], x[3]),
          x[2],
          high,
          x[3]};
}

}  // namespace detail

/// Control points of a facet.
inline FacetNodes control_points(Topology t, const FacetNodes& x) noexcept {
  switch (t) {
    case Topology::tri3:
    case Topology::quad4:
      break;
    case Topology::tri6:
      return {x[0],
              detail::middle_control(x[0], x[5], x[1]),
              x[1],
              detail::middle_control(x[0], x[4], x[2]),
              detail::middle_control(x[1], x[3], x[2]),
              x[2]};
    case Topology::quad8:
      return detail::square_controls(
          x, 0.5 * (x[4] + x[5] + x[6] + x[7]) - 0.25 * (x[0] + x[1] + x[2] + x[3]));
    case Topology::quad9:
      return detail::square_controls(x, x[8]);
  }
  return x;
}

}  // namespace anisocontact::surface
