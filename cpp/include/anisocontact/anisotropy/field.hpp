#pragma once
// Direction fields: two axes in the tangent plane at every point, and the tensors built on them.

#include <array>
#include <concepts>

#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::anisotropy {

/// Two unit axes e_1, e_2 in the tangent plane, not necessarily orthogonal. Not valid where the
/// field is singular (the pole of a polar field).
template <class S>
struct Axes {
  std::array<Vec3<S>, 2> e;
  bool valid{true};
};

template <class T>
concept Field = requires(const T& f, const surface::Geometry<double>& g,
                         const surface::Geometry<Dual<3>>& d, const Vector<double>& xi,
                         const Vector<Dual<3>>& eta) {
  { f.axes(g, xi) } -> std::same_as<Axes<double>>;
  { f.axes(d, eta) } -> std::same_as<Axes<Dual<3>>>;
  { T::describe() } -> std::same_as<Descriptor>;
};

/// Sine below which a direction counts as parallel to the normal.
inline constexpr double parallel_limit = 1e-8;

/// Axes from a spatial direction: projected on the tangent plane, turned by `angle` about n; the
/// second axis is n x e_1.
template <class S>
Axes<S> axes_from(const surface::Geometry<S>& g, const Vec3<S>& direction, double angle) {
  using std::sqrt;
  const Vec3<S> n = g.normal;
  const Vec3<S> t = direction - direction.dot(n) * n;
  const S t2 = t.dot(t);
  if (!(value(t2) > parallel_limit * parallel_limit * value(direction.dot(direction))))
    return {{n, n}, false};
  const Vec3<S> e = (S(1.0) / sqrt(t2)) * t;
  const Vec3<S> f = n.cross(e);
  const S c(std::cos(angle)), s(std::sin(angle));
  const Vec3<S> e1 = c * e + s * f;
  const Vec3<S> e2 = c * f - s * e;
  return {{e1, e2}, true};
}

/// b_ij = sum_a lambda_a (e_a . rho_i)(e_a . rho_j) [Konyukhov Schweizerhof 2006, eq. (48), (55)].
template <class S>
CoCo<S> pull_back_co(const surface::Geometry<S>& g, const Axes<S>& axes,
                     const std::array<double, 2>& lambda) {
  const auto u = g.project_co(axes.e[0]), v = g.project_co(axes.e[1]);
  return S(lambda[0]) * outer(u, u) + S(lambda[1]) * outer(v, v);
}

/// f^ij = sum_a lambda_a (e_a . rho^i)(e_a . rho^j) [Konyukhov Schweizerhof 2006, eq. (57)].
template <class S>
ContraContra<S> pull_back_contra(const surface::Geometry<S>& g, const Axes<S>& axes,
                                 const std::array<double, 2>& lambda) {
  const auto u = g.project_contra(axes.e[0]), v = g.project_contra(axes.e[1]);
  return S(lambda[0]) * outer(u, u) + S(lambda[1]) * outer(v, v);
}

}  // namespace anisocontact::anisotropy
