#pragma once
// The direction fields there are. A new one: its header, and its name here.

#include "anisocontact/anisotropy/constant.hpp"
#include "anisocontact/anisotropy/coordinate_lines.hpp"
#include "anisocontact/anisotropy/from_vectors.hpp"
#include "anisocontact/anisotropy/oblique.hpp"
#include "anisocontact/anisotropy/polar.hpp"
#include "anisocontact/anisotropy/spiral.hpp"
#include "anisocontact/anisotropy/tabulated_grid.hpp"
#include "anisocontact/anisotropy/tabulated_points.hpp"
#include "anisocontact/registry/descriptor.hpp"

namespace anisocontact::anisotropy {

using Fields = Registry<Constant, Oblique, Polar, Spiral, CoordinateLines, FromVectors,
                        TabulatedGrid, TabulatedPoints>;
using AnyField = Fields::Any;

template <class S>
Axes<S> axes(const AnyField& f, const surface::Geometry<S>& g, const Vector<S>& xi) {
  return std::visit([&](const auto& t) { return t.axes(g, xi); }, f);
}

/// Components of the axes of a field; `geometry()` gives the whole geometry to fields that need more
/// than a basis.
template <class S, class Whole>
Components<S> components(const AnyField& f, const TangentBasis<S>& b, const Vector<S>& xi,
                         const Whole& geometry) {
  return std::visit(
      [&]<class F>(const F& t) -> Components<S> {
        if constexpr (HasLine<F, S>) {
          return components_along(b, t.line(b.position));
        } else {
          const surface::Geometry<S> g = geometry();
          const Axes<S> axes = t.axes(g, xi);
          return {g.project_contra(axes.e), axes.valid};
        }
      },
      f);
}

}  // namespace anisocontact::anisotropy
