#pragma once
// Evolution of the tangential force along the path of a point: how the committed history enters
// the current step. Four discrete forms of dT/dt = B v [Konyukhov Schweizerhof 2006, eq. (28)].

#include <array>
#include <cmath>

#include "anisocontact/kernel/state.hpp"
#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::kernel {

/// Where a point is on the master.
template <class S>
struct Kinematics {
  surface::Geometry<S> now;
  surface::Geometry<S> before;  ///< at the committed coordinates, today's configuration
  Vector<S> xi;
  surface::Domain domain;
  S gap;
  double dt;
};

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

/// xi_{n+1} - xi_n [Konyukhov Schweizerhof 2006, eq. (84)], the shorter way round on a periodic
/// coordinate.
template <class S>
Vector<S> coordinate_increment(const PointState& state, const Kinematics<S>& k) {
  Vector<S> d;
  for (std::size_t i = 0; i < 2; ++i) {
    const double plain = value(k.xi[i]) - state.xi[i];
    const double wrapped = k.domain.difference(i, value(k.xi[i]), state.xi[i]);
    d[i] = k.xi[i] - S(state.xi[i]) + S(wrapped - plain);
  }
  return d;
}

/// Slip as the vector from the committed point of the master to the projection, projected on the
/// tangent plane; history turned with the normal. Unchanged by reparametrisation and rigid motion.
class Transport {
 public:
  static Descriptor describe() {
    return {"transport",
            "Slip as a vector, history turned with the normal (parallel transport); independent of "
            "the coordinates of the surface.",
            {}};
  }
  static Transport make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k, const CoCo<S>&) const {
    const auto turned = [&](const Vec3<S>& v) {
      return turn_with_normal<S>(v, k.before.normal, k.now.normal);
    };
    const auto stored = constant<S>(Covector<double>{state.stored});
    const auto elastic = constant<S>(Vector<double>{state.elastic});
    return {k.now.project_co(turned(k.before.spatial(stored))),
            k.now.project_contra(turned(k.before.spatial(elastic))),
            k.now.project_contra(k.now.jet.position - k.before.jet.position), unit<S, Place::co>()};
  }
};

/// Full covariant form, implicit: dT_i = (b_ij + Gamma^k_ij T_k) dxi^j - h_i^k T_k dxi^3
/// [Konyukhov Schweizerhof 2006, eq. (8), (10), (29)].
class Covariant {
 public:
  static Descriptor describe() {
    return {"covariant",
            "Coordinates with Christoffel and curvature terms, eq. (8), (29), backward Euler.",
            {}};
  }
  static Covariant make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k, const CoCo<S>&) const {
    Transported<S> t;
    t.stored = constant<S>(Covector<double>{state.stored});
    t.increment = coordinate_increment(state, k);
    const S lift = k.gap - S(state.gap);
    t.connection = unit<S, Place::co>();
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t m = 0; m < 2; ++m)
        t.connection(i, m) += lift * k.now.h_mixed(m, i) -
                              k.now.christoffel[m](i, 0) * t.increment[0] -
                              k.now.christoffel[m](i, 1) * t.increment[1];
    // D(T_i v^i) = d(T_i v^i): vectors turn against the covectors, to first order by 2 I - G^T
    const ContraCo<S> turn = S(2.0) * unit<S, Place::contra>() - transpose(t.connection);
    const ContraCo<S> turn_back =
        (S(1.0) / det(turn)) * (trace(turn) * unit<S, Place::contra>() - turn);
    t.elastic = turn_back * constant<S>(Vector<double>{state.elastic});
    return t;
  }
};

/// Components kept as they are: T_i = T_i^(n) + b_ij (xi^j - xi_n^j)
/// [Konyukhov Schweizerhof 2006, eq. (13), (112)].
class Incremental {
 public:
  static Descriptor describe() {
    return {"incremental", "Components of the force kept from step to step, eq. (13), (112).", {}};
  }
  static Incremental make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k, const CoCo<S>&) const {
    return {constant<S>(Covector<double>{state.stored}), constant<S>(Vector<double>{state.elastic}),
            coordinate_increment(state, k), unit<S, Place::co>()};
  }
};

/// Force from the elastic slip since the centre of the adhesion domain: T = B (xi - xi_c)
/// [Konyukhov Schweizerhof 2006, eq. (14), (113), (123)]; for elastic adhesion alone.
class Total {
 public:
  static Descriptor describe() {
    return {"total", "Force from the coordinates relative to the centre, eq. (113), (123).", {}};
  }
  static Total make(const Values&) { return {}; }

  /// `adhesion` is b_ij: the stored force is that of the committed elastic slip in today's tensor.
  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k,
                       const CoCo<S>& adhesion) const {
    const Vector<S> elastic = constant<S>(Vector<double>{state.elastic});
    return {adhesion * elastic, elastic, coordinate_increment(state, k), unit<S, Place::co>()};
  }
};

using EvolutionForms = Registry<Transport, Covariant, Incremental, Total>;
using AnyEvolution = EvolutionForms::Any;

}  // namespace anisocontact::kernel
