#pragma once
// Closest point projection onto a surface.

#include <cmath>
#include <concepts>

#include "anisocontact/projection/ellipsoid.hpp"
#include "anisocontact/projection/helicoid.hpp"
#include "anisocontact/projection/nurbs.hpp"
#include "anisocontact/projection/revolution.hpp"
#include "anisocontact/surface/foot.hpp"
#include "anisocontact/surface/registry.hpp"

namespace anisocontact::projection {

using surface::Status;
using Projection = surface::Foot;
using Coordinates = std::array<double, 2>;

/// A surface that knows its closest point in closed form.
template <class T>
concept ClosedForm = requires(const T& s, const Vec3<double>& x) {
  { s.closest(x) } -> std::same_as<surface::Foot>;
};

/// Closest point of `surface` to x. A guess, such as the committed coordinates, may save time; it
/// never changes the result, and closed forms have no use for it.
template <ClosedForm T>
Projection closest_point(const T& surface, const Vec3<double>& x, const Coordinates*) noexcept {
  return surface.closest(x);
}

inline Projection closest_point(const surface::AnySurface& s, const Vec3<double>& x,
                                const Coordinates* guess = nullptr) noexcept {
  if (!x.allFinite()) return {};
  const Projection p = std::visit([&](const auto& t) { return closest_point(t, x, guess); }, s);
  return std::isfinite(p.xi[0]) && std::isfinite(p.xi[1]) ? p : Projection{};
}

}  // namespace anisocontact::projection
