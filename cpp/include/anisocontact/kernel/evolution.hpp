#pragma once
// Evolution of the tangential force along the path of a point: how the committed history enters
// the current step. Discrete forms of dT/dt = B v [Konyukhov Schweizerhof 2006, eq. (28)].

#include <array>
#include <cmath>

#include "anisocontact/kernel/half_turn.hpp"
#include "anisocontact/kernel/state.hpp"
#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::kernel {

/// Where a point is on the master: its closest point, convective coordinates and signed gap.
template <class S>
struct Kinematics {
  surface::Geometry<S> now;
  surface::Geometry<S> before;  ///< at the committed coordinates, today's configuration
  Vector<S> xi;
  surface::Domain domain;
  S gap;
  double dt;
  std::array<Vec3<S>, 2> own{Vec3<S>::Zero(), Vec3<S>::Zero()};  ///< tangents of the slave
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

/// Stored force and elastic slip turned with the normal.
template <class S>
Transported<S> turned_history(const PointState& state, const Kinematics<S>& k) {
  const auto turned = [&](const Vec3<S>& v) {
    return turn_with_normal<S>(v, k.before.normal, k.now.normal);
  };
  const auto stored = constant<S>(Covector<double>{state.stored});
  const auto elastic = constant<S>(Vector<double>{state.elastic});
  return {k.now.project_co(turned(k.before.spatial(stored))),
          k.now.project_contra(turned(k.before.spatial(elastic))),
          {},
          unit<S, Place::co>()};
}

/// A pair of vectors of the committed tangent plane, kept by components and turned to here.
template <class S>
std::array<Vec3<S>, 2> kept_pair(const KeptPair& kept, const Kinematics<S>& k) {
  const auto turned = [&](double first, double second) {
    const Vector<S> c{{S(first), S(second)}};
    return turn_with_normal<S>(k.before.spatial(c), k.before.normal, k.now.normal);
  };
  return {turned(kept[0], kept[1]), turned(kept[2], kept[3])};
}

/// The turn of the slave about the normal against the master since the committed state: that of
/// the two tangents of the slave, by the rotation in the polar decomposition of their change.
template <class S>
S relative_spin(const PointState& state, const Kinematics<S>& k) {
  using std::atan2;
  if (!has_pair(state.slave)) return S(0.0);
  const auto old = kept_pair(state.slave, k);
  const Vec3<S>& n = k.now.normal;
  const auto across = [&](const Vec3<S>& u, const Vec3<S>& v) { return u.cross(v).dot(n); };
  const S sine = k.own[0].dot(old[1]) - k.own[1].dot(old[0]) -
                 (k.own[0].dot(n) * old[1].dot(n) - k.own[1].dot(n) * old[0].dot(n));
  const S cosine = across(k.own[0], old[1]) + across(old[0], k.own[1]);
  return value(across(old[0], old[1])) < 0.0 ? atan2(-sine, -cosine) : atan2(sine, cosine);
}

/// Slip as the vector from the committed point of the master to the projection, as the path that
/// this chord spans where the normal and the slave turn evenly; history turned with the normal.
/// Unchanged by reparametrisation and rigid motion.
class Transport {
 public:
  /// Whether the history is turned as vectors, and the step looks at both of its ends.
  static constexpr bool vectors = true, halfway = true;
  static Descriptor describe() {
    return {"transport",
            "Slip as the path that its chord spans, history turned with the normal (parallel "
            "transport), axes of adhesion halfway; second order, independent of the coordinates of "
            "the surface.",
            {}};
  }
  static Transport make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k, const CoCo<S>&) const {
    Transported<S> t = turned_history(state, k);
    const Vec3<S>&n0 = k.before.normal, &n = k.now.normal;
    const Vec3<S> d = k.now.jet.position - k.before.jet.position;
    const S c = n0.dot(n), rise = d.dot(n);
    const ArcOfNormals arc(value(c));
    const Vec3<S> nu = n0 - c * n;
    Vec3<S> u = d - rise * n -
                (lifted(c, arc.a, arc.da) * rise + lifted(c, arc.b, arc.db) * nu.dot(d)) * nu;
    const S spin = relative_spin(state, k);
    const HalfSpin half(std::sin(value(spin)), std::cos(value(spin)));
    u = lifted(spin, half.g, half.dg) * u + S(0.5) * spin * n.cross(u);
    t.increment = k.now.project_contra(u);
    return t;
  }
};

/// The same with the chord projected on the tangent plane of the end, and the axes there: exact
/// where nothing turns, else of first order.
class BackwardEuler {
 public:
  static constexpr bool vectors = true, halfway = false;
  static Descriptor describe() {
    return {"backward-euler",
            "Slip as the chord on the tangent plane of the end, history turned with the normal, "
            "axes of adhesion at the end; first order where axes or bodies turn.",
            {}};
  }
  static BackwardEuler make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k, const CoCo<S>&) const {
    Transported<S> t = turned_history(state, k);
    t.increment = k.now.project_contra(k.now.jet.position - k.before.jet.position);
    return t;
  }
};

/// Full covariant form, implicit: dT_i = (b_ij + Gamma^k_ij T_k) dxi^j - h_i^k T_k dxi^3
/// [Konyukhov Schweizerhof 2006, eq. (8), (10), (29)].
class Covariant {
 public:
  static constexpr bool vectors = false, halfway = false;
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
  static constexpr bool vectors = false, halfway = false;
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
  static constexpr bool vectors = false, halfway = false;
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

using EvolutionForms = Registry<Transport, BackwardEuler, Covariant, Incremental, Total>;
using AnyEvolution = EvolutionForms::Any;

/// Whether the history is turned as vectors.
inline bool in_vectors(const AnyEvolution& any) {
  return std::visit([](const auto& form) { return form.vectors; }, any);
}
/// Whether a step looks at both of its ends.
inline bool looks_back(const AnyEvolution& any) {
  return std::visit([](const auto& form) { return form.halfway; }, any);
}

}  // namespace anisocontact::kernel
