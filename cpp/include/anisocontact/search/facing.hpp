#pragma once
// Facets of a surface that face those of another one and can overlap them along their normals.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "anisocontact/search/facet_surface.hpp"

namespace anisocontact::search {

/// Balls about facets, with their outward unit normals.
struct FacetBalls {
  const double *middle, *radius, *normal;  ///< (n, 3), (n,), (n, 3)

  static Vec3<double> row(const double* p, std::size_t i) {
    return {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
  }
};

/// Least cosine between one normal and the other, reversed: of a facet that is seen edge-on rounding
/// says whether it faces another one, and it covers nothing.
inline constexpr double edge_on = 1e-3;

/// Facets of a surface, whose balls are `theirs`, that are within a distance of the middle of facet f,
/// lie beside each other by no more than both radii, oppose it and are not left out (in ascending order).
inline void faced(const FacetSurface& surface, const FacetBalls& own, std::size_t f,
                  const FacetBalls& theirs, double distance, std::span<const std::int32_t> left_out,
                  std::vector<std::int32_t>& found) {
  const Vec3<double> middle = FacetBalls::row(own.middle, f),
                     normal = FacetBalls::row(own.normal, f);
  const auto wanted = [&](std::int32_t facet) {
    const auto g = static_cast<std::size_t>(facet);
    if (!(normal.dot(FacetBalls::row(theirs.normal, g)) < -edge_on)) return false;
    const Vec3<double> apart = FacetBalls::row(theirs.middle, g) - middle;
    const double along = apart.dot(normal), both = own.radius[f] + theirs.radius[g];
    return apart.squaredNorm() - along * along <= both * both &&
           !std::binary_search(left_out.begin(), left_out.end(), facet);
  };
  surface.within(middle, distance, wanted, found);
}

}  // namespace anisocontact::search
