#pragma once
// Evolution of the tangential force along the path of a point: how the committed history enters
// the current step. Discrete forms of dT/dt = B v [Konyukhov Schweizerhof 2006, eq. (28)].

#include <array>
#include <cmath>
#include <optional>

#include "anisocontact/kernel/state.hpp"
#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::kernel {

/// Where a point is on the master: its closest point, convective coordinates and signed gap; in numbers
/// that may carry derivatives.
template <class S>
struct Kinematics {
  surface::Geometry<S> now;
  Vector<S> xi;
  surface::Domain domain;
  S gap;
};

/// History in the current convective basis, and the slip increment.
template <class S>
struct Transported {
  Covector<S> stored;
  Vector<S> elastic;
  Vector<S> increment;
  std::optional<CoContra<S>> connection{};  ///< G of the trial, if it is not the unit tensor
};

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

/// Slip as the vector from the committed point of the master to the projection, as the path that
/// this chord spans where the normal and the slave turn evenly; history turned with the normal.
/// Unchanged by reparametrisation and rigid motion.
class Transport {
 public:
  /// Whether the history is turned as vectors, the step looks at both of its ends, and the force is
  /// that of the whole elastic slip.
  static constexpr bool vectors = true, halfway = true, total = false;
  static Descriptor describe() {
    return {"transport",
            "Slip as the path that its chord spans, history turned with the normal (parallel "
            "transport), axes of adhesion halfway; second order, independent of the coordinates of "
            "the surface.",
            {}};
  }
  static Transport make(const Values&) { return {}; }
};

/// The same with the chord projected on the tangent plane of the end, and the axes there: exact
/// where nothing turns, else of first order.
class BackwardEuler {
 public:
  static constexpr bool vectors = true, halfway = false, total = false;
  static Descriptor describe() {
    return {"backward-euler",
            "Slip as the chord on the tangent plane of the end, history turned with the normal, "
            "axes of adhesion at the end; first order where axes or bodies turn.",
            {}};
  }
  static BackwardEuler make(const Values&) { return {}; }
};

/// Full covariant form, implicit: dT_i = (b_ij + Gamma^k_ij T_k) dxi^j - h_i^k T_k dxi^3
/// [Konyukhov Schweizerhof 2006, eq. (8), (10), (29)].
class Covariant {
 public:
  static constexpr bool vectors = false, halfway = false, total = false;
  static Descriptor describe() {
    return {"covariant",
            "Coordinates with Christoffel and curvature terms, eq. (8), (29), backward Euler.",
            {}};
  }
  static Covariant make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k) const {
    Transported<S> t;
    t.stored = constant<S>(Covector<double>{state.stored});
    t.increment = coordinate_increment(state, k);
    const S lift = k.gap - S(state.gap);
    CoContra<S> connection = unit<S, Place::co>();
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t m = 0; m < 2; ++m)
        connection(i, m) += lift * k.now.h_mixed(m, i) -
                            k.now.christoffel[m](i, 0) * t.increment[0] -
                            k.now.christoffel[m](i, 1) * t.increment[1];
    // D(T_i v^i) = d(T_i v^i): vectors turn against the covectors, to first order by 2 I - G^T
    const ContraCo<S> turn = S(2.0) * unit<S, Place::contra>() - transpose(connection);
    const ContraCo<S> turn_back =
        (S(1.0) / det(turn)) * (trace(turn) * unit<S, Place::contra>() - turn);
    t.elastic = turn_back * constant<S>(Vector<double>{state.elastic});
    t.connection = connection;
    return t;
  }
};

/// Components kept as they are: T_i = T_i^(n) + b_ij (xi^j - xi_n^j)
/// [Konyukhov Schweizerhof 2006, eq. (13), (112)].
class Incremental {
 public:
  static constexpr bool vectors = false, halfway = false, total = false;
  static Descriptor describe() {
    return {"incremental", "Components of the force kept from step to step, eq. (13), (112).", {}};
  }
  static Incremental make(const Values&) { return {}; }

  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k) const {
    return {constant<S>(Covector<double>{state.stored}), constant<S>(Vector<double>{state.elastic}),
            coordinate_increment(state, k)};
  }
};

/// Force from the elastic slip since the centre of the adhesion domain: T = B (xi - xi_c)
/// [Konyukhov Schweizerhof 2006, eq. (14), (113), (123)]; for elastic adhesion alone.
class Total {
 public:
  static constexpr bool vectors = false, halfway = false, total = true;
  static Descriptor describe() {
    return {"total", "Force from the coordinates relative to the centre, eq. (113), (123).", {}};
  }
  static Total make(const Values&) { return {}; }

  /// The force is that of the whole elastic slip in today's tensor, nothing is stored.
  template <class S>
  Transported<S> apply(const PointState& state, const Kinematics<S>& k) const {
    return {{}, constant<S>(Vector<double>{state.elastic}), coordinate_increment(state, k)};
  }
};

using EvolutionForms = Registry<Transport, BackwardEuler, Covariant, Incremental, Total>;
using AnyEvolution = EvolutionForms::Any;

/// Whether the history is turned as vectors; others keep components in the basis of the surface.
inline bool in_vectors(const AnyEvolution& any) {
  return std::visit([](const auto& form) { return form.vectors; }, any);
}
/// Whether a step looks at both of its ends.
inline bool looks_back(const AnyEvolution& any) {
  return std::visit([](const auto& form) { return form.halfway; }, any);
}
/// Whether the force is that of the whole elastic slip.
inline bool counts_all(const AnyEvolution& any) {
  return std::visit([](const auto& form) { return form.total; }, any);
}

}  // namespace anisocontact::kernel
