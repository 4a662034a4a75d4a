#pragma once
// How the history of a point is brought to where the point is now.

#include <array>

#include "anisocontact/kernel/state.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::kernel {

/// History in the current convective basis, and the slip increment.
template <class S>
struct Transported {
  Covector<S> stored;
  Vector<S> elastic;
  Vector<S> increment;
  CoContra<S> connection;  ///< G of the trial: unit where the history was turned with the surface
};

/// Turns a tangent vector of n_0 with the least rotation that takes n_0 to n
/// (parallel transport along the geodesic of the sphere of normals).
template <class S>
Vec3<S> turn_with_normal(const Vec3<S>& v, const Vec3<S>& n0, const Vec3<S>& n) {
  const S c = v.dot(n) / (S(1.0) + n0.dot(n));
  return v - c * (n0 + n);
}

/// Slip as the vector from the committed point of the master to the projection, projected on the
/// tangent plane; history turned with the normal. Unchanged by reparametrisation and rigid motion.
template <class S>
Transported<S> transport(const PointState& state, const surface::Geometry<double>& before,
                         const surface::Geometry<S>& now) {
  const Vec3<S> n0 = constant<S>(before.normal);
  const auto turned = [&](const Vec3<double>& v) {
    return turn_with_normal<S>(constant<S>(v), n0, now.normal);
  };
  const Covector<double> stored{state.stored};
  const Vector<double> elastic{state.elastic};
  return {now.project_co(turned(before.spatial(stored))),
          now.project_contra(turned(before.spatial(elastic))),
          now.project_contra(now.jet.position - constant<S>(before.jet.position)),
          unit<S, Place::co>()};
}

}  // namespace anisocontact::kernel
