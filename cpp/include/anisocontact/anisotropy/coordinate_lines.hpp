#pragma once
// Directions along the surface's own coordinate lines.

#include <algorithm>

#include "anisocontact/anisotropy/field.hpp"

namespace anisocontact::anisotropy {

/// e_i = rho_i/sqrt(a_ii), turned by `angle` about the normal
/// [Konyukhov Schweizerhof 2006, eq. (47) with the coordinates of the surface itself]. Orthogonal
/// where the coordinate lines are.
class CoordinateLines {
 public:
  CoordinateLines() = default;
  explicit CoordinateLines(double angle) : turn_(angle) {}

  static Descriptor describe() {
    return {"coordinate-lines",
            "Along the two coordinate lines of the surface, turned about its normal.",
            {Turn::parameter()}};
  }
  static CoordinateLines make(const Values& v) { return CoordinateLines(v.scalar("angle")); }

  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    const double l0 = value(g.jet.d1[0]).norm(), l1 = value(g.jet.d1[1]).norm();
    if (!(std::min(l0, l1) > pole_limit * std::max(l0, l1))) return no_axes(g);
    const auto lines =
        pair_axes(g, unit_along<S>(g.jet.d1[0], 0.0), unit_along<S>(g.jet.d1[1], 0.0));
    if (!lines.valid) return lines;
    return {{turn_(g.normal, lines.e[0]), turn_(g.normal, lines.e[1])}, true};
  }

 private:
  /// Ratio of |rho_1| and |rho_2| below which a coordinate line has shrunk to a point: far above
  /// the rounding of zero, far below what the units of the two coordinates make of it.
  static constexpr double pole_limit = 1e-14;
  Turn turn_;
};

static_assert(Field<CoordinateLines>);

}  // namespace anisocontact::anisotropy
