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

}  // namespace anisocontact::anisotropy
