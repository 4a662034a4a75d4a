#pragma once
// Two directions in space, each projected on the surface.

#include <stdexcept>

#include "anisocontact/anisotropy/field.hpp"

namespace anisocontact::anisotropy {

/// e_a along the projections of two spatial vectors, not necessarily orthogonal
/// [Konyukhov Schweizerhof 2006, eq. (47)-(57)].
class FromVectors {
 public:
  FromVectors() = default;
  FromVectors(const Vec3<double>& first, const Vec3<double>& second)
      : first_(first), second_(second) {}

  static Descriptor describe() {
    return {"from-vectors",
            "Two directions in space, each projected on the surface; not necessarily orthogonal.",
            {{"first", Kind::vector, "1", "direction of the first axis", Bound::nonzero},
             {"second", Kind::vector, "1", "direction of the second axis", Bound::nonzero}}};
  }
  static FromVectors make(const Values& v) {
    const auto &a = v.vector("first"), &b = v.vector("second");
    const Vec3<double> first(a[0], a[1], a[2]), second(b[0], b[1], b[2]);
    if (!(first.cross(second).norm() > parallel_limit * first.norm() * second.norm()))
      throw std::invalid_argument(
          "second: parallel to first, so no tensor on them is positive definite");
    return {first, second};
  }

  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    return pair_axes(g, unit_tangent<S>(g, constant<S>(first_)),
                     unit_tangent<S>(g, constant<S>(second_)));
  }

 private:
  Vec3<double> first_{Vec3<double>::UnitX()}, second_{Vec3<double>::UnitY()};
};

static_assert(Field<FromVectors>);

}  // namespace anisocontact::anisotropy
