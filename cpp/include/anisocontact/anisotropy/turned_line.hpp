#pragma once
// Axes along the tangential part of one vector in space, turned about the normal: most fields are of
// this kind, and their components in the basis of the surface need neither the normal nor a unit
// vector.

#include "anisocontact/anisotropy/field.hpp"

namespace anisocontact::anisotropy {

/// A vector in space, zero where there is no direction, and the turn of each axis from its
/// tangential part.
template <class S>
struct TurnedLine {
  Vec3<S> vector;
  std::array<Turn, 2> turns;
};

/// A field of this kind says so at any position.
template <class T, class S>
concept HasLine = requires(const T& f, const Vec3<S>& x) {
  { f.line(x) } -> std::same_as<TurnedLine<S>>;
};

/// Unit axes in space.
template <class S>
Axes<S> axes_along(const surface::Geometry<S>& g, const TurnedLine<S>& line) {
  const auto e = unit_tangent(g, line.vector);
  if (!e) return no_axes(g);
  return {{line.turns[0](g.normal, *e), line.turns[1](g.normal, *e)}, true};
}

/// Position and tangents of a surface, and what follows for lengths and areas.
template <class S>
struct TangentBasis {
  Vec3<S> position;
  std::array<Vec3<S>, 2> d1;
  CoCo<S> a_co;
  S area;  ///< sqrt(det a_ij), negative where axes turn about the normal -rho_1 x rho_2

  TangentBasis(const Vec3<S>& x, const std::array<Vec3<S>, 2>& tangents, double orientation)
      : position(x), d1(tangents) {
    using std::sqrt;
    const S mixed = d1[0].dot(d1[1]);
    a_co = {{{{d1[0].dot(d1[0]), mixed}, {mixed, d1[1].dot(d1[1])}}}};
    area = orientation * sqrt(det(a_co));
  }
};

/// Components of axes in the basis of a surface, of any length; not valid where the field has no
/// direction.
template <class S>
struct Components {
  std::array<Vector<S>, 2> c;
  bool valid{true};
};

/// v_i = v . rho_i of the tangential part v of a vector; times det a_ij the components of v are
/// adj(a)^ij v_j and those of n x v are sqrt(det a) (-v_2, v_1).
template <class S>
Components<S> components_along(const TangentBasis<S>& b, const TurnedLine<S>& line) {
  const Vec3<S>& w = line.vector;
  const Covector<S> lower{{w.dot(b.d1[0]), w.dot(b.d1[1])}};
  const Vector<S> along = adjugate(b.a_co) * lower,
                  across{{-(b.area * lower[1]), b.area * lower[0]}};
  const double size2 = value(w.dot(w)) * value(b.area) * value(b.area);
  return {{line.turns[0](along, across), line.turns[1](along, across)},
          dot(value(lower), value(along)) > parallel_limit * parallel_limit * size2};
}

}  // namespace anisocontact::anisotropy
