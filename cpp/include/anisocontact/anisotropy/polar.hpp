#pragma once
// Rays and rings about an axis: a turned surface.

#include "anisocontact/anisotropy/axis.hpp"

namespace anisocontact::anisotropy {

/// Second axis around the axis, first axis across it, both turned by `angle` about the normal
/// [Konyukhov Schweizerhof 2006, eq. (61)-(63)]. The rings are what is projected on the surface:
/// they are tangent to every surface of revolution about the axis, its equator included, where a
/// projected ray would vanish. Singular on the axis.
class Polar {
 public:
  Polar() = default;
  Polar(const Axis& axis, double angle) : axis_(axis), turn_(angle) {}

  static Descriptor describe() {
    return {
        "polar",
        "Rays (first axis) and rings (second axis) about an axis; singular on the axis.",
        {{"axis", Kind::axis, "length", "a point of the axis and its direction", Bound::nonzero},
         Turn::parameter()}};
  }
  static Polar make(const Values& v) { return {Axis::from(v.axis("axis")), v.scalar("angle")}; }

  template <class S>
  TurnedLine<S> line(const Vec3<S>& x) const {
    return {axis_.around(x), {turn_.less_quarter(), turn_}};
  }
  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    return axes_along(g, line(g.jet.position));
  }

 private:
  Axis axis_;
  Turn turn_;
};

static_assert(Field<Polar>);

}  // namespace anisocontact::anisotropy
