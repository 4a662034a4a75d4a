#pragma once
// The thread of a screw.

#include <numbers>

#include "anisocontact/anisotropy/axis.hpp"

namespace anisocontact::anisotropy {

/// First axis along the spiral of pitch H, second axis n x e_1 along the orthogonal spiral
/// [Konyukhov Schweizerhof 2006, eq. (64)-(77)].
///
/// The spiral is where the helicoid z = H phi/2 pi + const about the axis cuts the surface, so its
/// tangent is normal to both: e_1 ~ (R z - h e_phi) x n, h = H/2 pi. On a coaxial cylinder this is
/// R e_phi + h z, (68); on a coaxial cone, or any other surface, it is the line with the same
/// advance along the axis. Right-handed for H > 0. Singular on the axis and where the helicoid
/// touches the surface.
class Spiral {
 public:
  Spiral() = default;
  Spiral(const Axis& axis, double pitch) : axis_(axis), h_(pitch / (2.0 * std::numbers::pi)) {}

  static Descriptor describe() {
    return {
        "spiral",
        "Spiral of constant pitch about an axis (first axis) and the lines orthogonal to it.",
        {{"axis", Kind::axis, "length", "a point of the axis and its direction", Bound::nonzero},
         {"pitch", Kind::scalar, "length",
          "advance along the axis in one turn; > 0 right-handed, < 0 left-handed",
          Bound::nonzero}}};
  }
  static Spiral make(const Values& v) { return {Axis::from(v.axis("axis")), v.scalar("pitch")}; }

  /// The normal of the helicoid times R^2; the spiral is across it.
  template <class S>
  TurnedLine<S> line(const Vec3<S>& x) const {
    const Vec3<S> around = axis_.around(x);
    return {around.dot(around) * constant<S>(axis_.direction()) - S(h_) * around,
            {Turn{}.less_quarter(), Turn{}}};
  }
  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    return axes_along(g, line(g.jet.position));
  }

 private:
  Axis axis_;
  double h_{1.0};
};

static_assert(Field<Spiral>);

}  // namespace anisocontact::anisotropy
