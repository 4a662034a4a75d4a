#pragma once
// Quadratic patches over linear facets from normals at their vertices.

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::surface {

/// Point at the middle of a parabola from x0 to x1 whose ends are normal to n0 and n1 (unit vectors).
///
/// x(t) = x0 + (d - c) t + c t^2 with n0 . (d - c) = 0 and n1 . (d + c) = 0 [Nagata 2005, eq. (5)]. Of
/// the solutions c in the plane of n0 and n1 this takes the part along n0 + n1, on which both
/// conditions agree for an arc; the part along n0 - n1, an inflection, is not bounded as the normals
/// become equal. Straight where the normals say so: where they are equal, and where they are nearly
/// opposite and no parabola is sensible.
template <class S>
Vec3<S> patch_middle(const Vec3<S>& x0, const Vec3<S>& x1, const Vec3<S>& n0, const Vec3<S>& n1) {
  constexpr double opposite = -0.9;
  const Vec3<S> straight = S(0.5) * (x0 + x1), d = x1 - x0, sum = n0 + n1, difference = n0 - n1;
  const S cosine = n0.dot(n1);
  if (cosine < S(opposite)) return straight;
  const S bend = d.dot(difference) / (S(2.0) * (S(1.0) + cosine));
  return straight - (S(0.25) * bend) * sum;
}

/// The normal at the other end of an arc over d that has the normal n at one end.
template <class S>
Vec3<S> mirrored_normal(const Vec3<S>& n, const Vec3<S>& d) {
  return n - (S(2.0) * n.dot(d) / d.dot(d)) * d;
}

/// Share of a facet in the normal at its corner between the edges a and b. The sum over the facets
/// around a point is exact where the point and its neighbours are on a sphere [Max 1999].
template <class S>
Vec3<S> corner_share(const Vec3<S>& a, const Vec3<S>& b) {
  return (S(1.0) / (a.dot(a) * b.dot(b))) * a.cross(b);
}

}  // namespace anisocontact::surface
