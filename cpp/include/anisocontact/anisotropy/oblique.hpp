#pragma once
// Two directions that need not be orthogonal, each at its angle to a reference.

#include <cmath>
#include <stdexcept>

#include "anisocontact/anisotropy/turned_line.hpp"

namespace anisocontact::anisotropy {

/// r_1 and r_2 at the angles alpha and beta to `vector` projected on the tangent plane
/// [Konyukhov Schweizerhof 2006, eq. (58)-(60)].
class Oblique {
 public:
  Oblique() = default;
  Oblique(const Vec3<double>& vector, double first, double second)
      : vector_(vector), first_(first), second_(second) {}

  static Descriptor describe() {
    return {
        "oblique",
        "Two directions, not necessarily orthogonal, at given angles to a direction in space "
        "projected on the surface.",
        {{"vector", Kind::vector, "1", "direction the angles are measured from", Bound::nonzero},
         {"angle_first", Kind::scalar, "angle", "angle of the first axis about the outward normal"},
         {"angle_second", Kind::scalar, "angle",
          "angle of the second axis about the outward normal"}}};
  }
  static Oblique make(const Values& v) {
    const auto& d = v.vector("vector");
    const double first = v.scalar("angle_first"), second = v.scalar("angle_second");
    if (!(std::abs(std::sin(second - first)) > parallel_limit))
      throw std::invalid_argument(
          "angle_second: the two axes are parallel, so no tensor on them is positive definite");
    return {Vec3<double>(d[0], d[1], d[2]), first, second};
  }

  template <class S>
  TurnedLine<S> line(const Vec3<S>&) const {
    return {constant<S>(vector_), {first_, second_}};
  }
  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    return axes_along(g, line(g.jet.position));
  }

 private:
  Vec3<double> vector_{Vec3<double>::UnitX()};
  Turn first_, second_;
};

static_assert(Field<Oblique>);

}  // namespace anisocontact::anisotropy
