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

/// The same from which on a facet lies on the other one.
inline constexpr double lies_on = 0.5;

/// Distances from the middle of a facet up to which others are found, and up to which what goes on from
/// these in front of it is: where a surface rises steeply in front of a facet on which it lies, a part of
/// it that came and went at a distance would let what the facet meets jump.
struct Limits {
  double distance, farther;
};

/// Keeps those of the facets found for facet f that are within the distance and, where one of them lies on
/// it, those in front of it that hang together with them by nodes.
inline void keep_connected(const FacetSurface& surface, const Vec3<double>& middle,
                           const Vec3<double>& normal, const FacetBalls& theirs, double distance,
                           std::vector<std::int32_t>& found) {
  const auto far = std::stable_partition(found.begin(), found.end(), [&](std::int32_t g) {
    return surface.is_within(g, middle, distance);
  });
  if (far == found.end()) return;
  const auto lies = [&](std::int32_t g) {
    return -normal.dot(FacetBalls::row(theirs.normal, static_cast<std::size_t>(g))) > lies_on;
  };
  std::vector<std::int32_t> met;
  const auto meet = [&](std::int32_t g) {
    const auto nodes = surface.mesh().nodes(static_cast<std::size_t>(g));
    met.insert(met.end(), nodes.begin(), nodes.end());
  };
  std::for_each(found.begin(), far, meet);
  const auto joins = [&](std::int32_t g) {
    const auto nodes = surface.mesh().nodes(static_cast<std::size_t>(g));
    return std::find_first_of(nodes.begin(), nodes.end(), met.begin(), met.end()) != nodes.end();
  };
  const auto in_front = [&](std::int32_t g) {
    return normal.dot(FacetBalls::row(theirs.middle, static_cast<std::size_t>(g)) - middle) > 0.0;
  };
  auto kept = far;
  const bool meets = std::any_of(found.begin(), far, lies);
  const auto last = meets ? std::partition(far, found.end(), in_front) : far;
  for (auto next = std::partition(kept, last, joins); next != kept;
       next = std::partition(kept, last, joins)) {
    std::for_each(kept, next, meet);
    kept = next;
  }
  found.erase(kept, found.end());
  std::sort(found.begin(), found.end());
}

/// Facets of a surface, whose balls are `theirs`, that are within limits of the middle of facet f,
/// lie beside each other by no more than both radii, oppose it and are not left out (in ascending order).
inline void faced(const FacetSurface& surface, const FacetBalls& own, std::size_t f,
                  const FacetBalls& theirs, const Limits& limits,
                  std::span<const std::int32_t> left_out, std::vector<std::int32_t>& found) {
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
  surface.within(middle, std::max(limits.distance, limits.farther), wanted, found);
  if (limits.farther > limits.distance)
    keep_connected(surface, middle, normal, theirs, limits.distance, found);
}

}  // namespace anisocontact::search
