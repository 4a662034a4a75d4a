#pragma once
// Direction fields: two axes in the tangent plane at every point, and the tensors built on them.

#include <array>
#include <cmath>
#include <concepts>
#include <optional>

#include "anisocontact/registry/descriptor.hpp"
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
concept Field =
    requires(const T& f, const surface::Geometry<double>& g, const surface::Geometry<Dual<3>>& d,
             const Vector<double>& xi, const Vector<Dual<3>>& eta) {
      { f.axes(g, xi) } -> std::same_as<Axes<double>>;
      { f.axes(d, eta) } -> std::same_as<Axes<Dual<3>>>;
      { T::describe() } -> std::same_as<Descriptor>;
    };

/// Sine below which two directions count as parallel.
inline constexpr double parallel_limit = 1e-8;

/// Rotation of the tangent plane about its normal [Konyukhov Schweizerhof 2006, eq. (40)].
class Turn {
 public:
  Turn() = default;
  explicit Turn(double angle) : c_(std::cos(angle)), s_(std::sin(angle)) {}

  /// How fields ask for one.
  static Parameter parameter() {
    return {"angle",    Kind::scalar, "angle", "turn of the axes about the outward normal",
            Bound::any, false,        {0.0}};
  }

  template <class S>
  Vec3<S> operator()(const Vec3<S>& normal, const Vec3<S>& e) const {
    const Vec3<S> f = normal.cross(e);
    return c_ * e + s_ * f;
  }
  /// The same from components of e and n x e.
  template <class S>
  Vector<S> operator()(const Vector<S>& e, const Vector<S>& f) const {
    return c_ * e + s_ * f;
  }

  /// This turn and a quarter more, or a quarter back.
  Turn and_quarter() const { return {-s_, c_}; }
  Turn less_quarter() const { return {s_, -c_}; }

 private:
  Turn(double c, double s) : c_(c), s_(s) {}

  double c_{1.0}, s_{0.0};
};

/// Unit vector along `v`; none where v is below parallel_limit times a size, given squared.
template <class S>
std::optional<Vec3<S>> unit_along(const Vec3<S>& v, double size2) {
  using std::sqrt;
  const S v2 = v.dot(v);
  if (!(value(v2) > parallel_limit * parallel_limit * size2)) return std::nullopt;
  return Vec3<S>((S(1.0) / sqrt(v2)) * v);
}

/// Unit vector along the projection of `v` on the tangent plane; none where v is along the normal.
template <class S>
std::optional<Vec3<S>> unit_tangent(const surface::Geometry<S>& g, const Vec3<S>& v) {
  return unit_along<S>(v - v.dot(g.normal) * g.normal, value(v.dot(v)));
}

/// What a field answers where it has no direction.
template <class S>
Axes<S> no_axes(const surface::Geometry<S>& g) {
  return {{g.normal, g.normal}, false};
}

/// Orthonormal axes e, n x e from a unit tangent, if there is one, turned about n.
template <class S>
Axes<S> orthonormal_axes(const surface::Geometry<S>& g, const std::optional<Vec3<S>>& e,
                         const Turn& turn) {
  if (!e) return no_axes(g);
  const Vec3<S> e1 = turn(g.normal, *e);
  return {{e1, g.normal.cross(e1)}, true};
}

/// Orthonormal axes from a spatial direction: projected on the tangent plane, turned about n; the
/// second axis is n x e_1.
template <class S>
Axes<S> axes_from(const surface::Geometry<S>& g, const Vec3<S>& direction, const Turn& turn) {
  return orthonormal_axes(g, unit_tangent(g, direction), turn);
}

/// Axes along two unit tangents, if there are such and they are not parallel.
template <class S>
Axes<S> pair_axes(const surface::Geometry<S>& g, const std::optional<Vec3<S>>& first,
                  const std::optional<Vec3<S>>& second) {
  if (!first || !second) return no_axes(g);
  if (!(value(*first).cross(value(*second)).norm() > parallel_limit)) return no_axes(g);
  return {{*first, *second}, true};
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
