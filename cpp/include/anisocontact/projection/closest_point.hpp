#pragma once
// Closest point of a surface and its exact linearisation.

#include <array>
#include <cstdint>

#include "anisocontact/surface/registry.hpp"

namespace anisocontact::projection {

/// How a projection ended. `interior`: x - rho is normal to the surface; `edge`: the nearest point
/// is on an edge of the surface; `failed`: no closest point (singular or not converged).
enum class Status : std::int64_t { interior = 0, edge = 1, failed = 2 };

struct Projection {
  std::array<double, 2> xi{0.0, 0.0};
  Status status{Status::failed};
};

/// A surface that knows its closest point in closed form.
template <class T>
concept ClosedForm = requires(const T& s, const Vec3<double>& x) {
  { s.closest(x) } -> std::same_as<std::array<double, 2>>;
};

/// Closest point of `surface` to x.
template <ClosedForm T>
Projection closest_point(const T& surface, const Vec3<double>& x) noexcept {
  return {surface.closest(x), Status::interior};
}

inline Projection closest_point(const surface::AnySurface& s, const Vec3<double>& x) noexcept {
  return std::visit([&](const auto& t) { return closest_point(t, x); }, s);
}

/// Coordinates as functions of x: value xi, exact derivative d xi^i = (a_ij - xi^3 h_ij)^-1 rho_j . dx,
/// the implicit derivative of (x - rho(xi)) . rho_j = 0.
template <class S>
Vector<S> linearised(const surface::Geometry<double>& g, const std::array<double, 2>& xi,
                     const Vec3<S>& x) {
  const Vec3<double> r = value(x) - g.jet.position;
  const double gap = r.dot(g.normal);
  const ContraContra<double> inv = inverse(g.a_co - gap * g.h_co);
  const Vec3<S> dx = x - constant<S>(value(x));
  const Covector<S> rhs{{dx.dot(constant<S>(g.jet.d1[0])), dx.dot(constant<S>(g.jet.d1[1]))}};
  Vector<S> out;
  for (std::size_t i = 0; i < 2; ++i)
    out[i] = S(xi[i]) + S(inv(i, 0)) * rhs[0] + S(inv(i, 1)) * rhs[1];
  return out;
}

}  // namespace anisocontact::projection
