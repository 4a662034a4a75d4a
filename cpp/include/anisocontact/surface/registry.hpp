#pragma once
// The surfaces there are. A new one: its header in analytic/, and its name here.

#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/surface/analytic/cone.hpp"
#include "anisocontact/surface/analytic/cylinder.hpp"
#include "anisocontact/surface/analytic/ellipsoid.hpp"
#include "anisocontact/surface/analytic/helicoid.hpp"
#include "anisocontact/surface/analytic/nurbs_pieces.hpp"
#include "anisocontact/surface/analytic/plane.hpp"
#include "anisocontact/surface/analytic/revolution.hpp"
#include "anisocontact/surface/analytic/sphere.hpp"
#include "anisocontact/surface/analytic/torus.hpp"

namespace anisocontact::surface {

using Surfaces =
    Registry<Plane, Cylinder, Sphere, Cone, Torus, Ellipsoid, Nurbs, Revolution, Helicoid>;
using AnySurface = Surfaces::Any;

inline Domain domain(const AnySurface& s) {
  return std::visit([](const auto& t) { return t.domain(); }, s);
}

template <class S>
Jet<S> jet(const AnySurface& s, const S& u, const S& v) {
  return std::visit([&](const auto& t) { return t.jet(u, v); }, s);
}

}  // namespace anisocontact::surface
