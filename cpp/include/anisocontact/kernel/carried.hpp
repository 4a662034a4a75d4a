#pragma once
// Axes of direction fields in the contact plane, carried there by the material of a body.

#include <optional>

#include "anisocontact/kernel/frame_law.hpp"

namespace anisocontact::kernel {

/// An axis in the contact plane. It lies along the part of v = c^i rho_i in this plane; its angle
/// changes by
///   d alpha = mu . (c^i d rho_i - (v . n) dn) + by_xi_j d xi^j,   mu = n x e / |v - (v . n) n|,
/// where rho_i are the tangents of the body that carries it.
struct PlaneAxis {
  Vec3<double> e{Vec3<double>::Zero()}, mu{Vec3<double>::Zero()};
  Flat c{}, by_xi{};
  double lift{0.0};  ///< v . n
};

struct PlaneAxes {
  std::array<PlaneAxis, 2> axis{};
  Side side{Side::master};
  bool valid{true};
};

/// A body at a point of its surface: where it is now, and where it was in the reference
/// configuration.
struct Carrier {
  surface::Jet<double> now{}, reference{};
  std::array<double, 2> xi{};
};

namespace detail {

/// The jet beside a point; S = Dual<2> has the two coordinates as variables.
template <class S>
surface::Jet<S> beside(const surface::Jet<double>& j) {
  if constexpr (std::is_same_v<S, double>) {
    return j;
  } else {
    surface::Jet<S> r;
    for (Eigen::Index k = 0; k < 3; ++k) {
      r.position[k] = S(j.position[k]);
      for (std::size_t i = 0; i < 2; ++i) {
        r.position[k].d[i] = j.d1[i][k];
        r.d1[i][k] = S(j.d1[i][k]);
        for (std::size_t m = 0; m < 2; ++m) r.d1[i][k].d[m] = j.second(i, m)[k];
      }
      for (std::size_t i = 0; i < 3; ++i) r.d2[i][k] = S(j.d2[i][k]);
    }
    return r;
  }
}

template <class S>
Vector<S> beside(const std::array<double, 2>& xi) {
  if constexpr (std::is_same_v<S, double>)
    return {xi};
  else
    return {{S::variable(xi[0], 0), S::variable(xi[1], 1)}};
}

/// The axis along c^i rho_i, with c and, in dual numbers, its derivatives along the coordinates.
template <class S>
std::optional<PlaneAxis> plane_axis(const surface::Jet<double>& now, const Vec3<double>& n,
                                    const Vector<S>& c) {
  PlaneAxis a;
  a.c = value(c).c;
  const Vec3<double> v = a.c[0] * now.d1[0] + a.c[1] * now.d1[1];
  a.lift = v.dot(n);
  const Vec3<double> flat = v - a.lift * n;
  const double length2 = flat.squaredNorm();
  constexpr double limit = anisotropy::parallel_limit;
  if (!(length2 > limit * limit * v.squaredNorm())) return std::nullopt;
  const double inverse = 1.0 / std::sqrt(length2);
  a.e = inverse * flat;
  a.mu = inverse * n.cross(a.e);
  if constexpr (!std::is_same_v<S, double>)
    for (std::size_t j = 0; j < 2; ++j) {
      const Vec3<double> dv = c[0].d[j] * now.d1[0] + c[1].d[j] * now.d1[1] +
                              a.c[0] * now.second(0, j) + a.c[1] * now.second(1, j);
      a.by_xi[j] = a.mu.dot(dv);
    }
  return a;
}

}  // namespace detail

/// On which side of the tangents of the slave the normal of the master is, which is inside it: 1 or
/// -1.
inline double orientation(const Carrier& own, const Vec3<double>& n) {
  return own.now.d1[0].cross(own.now.d1[1]).dot(n) < 0.0 ? -1.0 : 1.0;
}

/// Axes e, n x e.
inline PlaneAxes with_normal(const PlaneAxis& first, const Vec3<double>& n) {
  PlaneAxes r{{first, first}};
  r.axis[1].e = n.cross(first.e);
  return r;
}

/// A body with the tangent plane of its reference configuration; in S = Dual<2> its coordinates may
/// follow the projection, in double they are fixed.
template <class S>
struct ReferencePlane {
  const Carrier& body;
  surface::Geometry<S> plane;
  Vector<S> xi;

  /// `orientation`: on which side of the reference the normal is about which directions turn.
  ReferencePlane(const Carrier& b, double orientation)
      : body(b), plane{.jet = detail::beside<S>(b.reference)}, xi(detail::beside<S>(b.xi)) {
    surface::put_tangent_plane(plane);
    if (orientation < 0.0) plane.normal = -plane.normal;
  }
};

/// Axes of a field given in the reference configuration and carried by the material: components in
/// the basis of the body are kept, lengths normalised [Konyukhov Schweizerhof 2006, eq. (47)].
template <class S>
PlaneAxes carried(const anisotropy::AnyField& field, const ReferencePlane<S>& reference,
                  const Vec3<double>& n, Side side) {
  const auto axes = anisotropy::axes(field, reference.plane, reference.xi);
  PlaneAxes r;
  r.side = side;
  r.valid = axes.valid;
  for (std::size_t k = 0; k < 2 && r.valid; ++k) {
    const auto a =
        detail::plane_axis<S>(reference.body.now, n, reference.plane.project_contra(axes.e[k]));
    r.valid = a.has_value();
    if (a) r.axis[k] = *a;
  }
  return r;
}

/// Axes of adhesion and friction at a point; those of the second surface where it has a field.
struct LawAxes {
  PlaneAxes adhesion, friction, second;

  bool valid() const { return adhesion.valid && friction.valid && second.valid; }
};

/// `axes_at(directions)` gives those of one field.
template <class AxesAt>
LawAxes law_axes(const InterfaceLaw& l, AxesAt&& axes_at) {
  LawAxes a{axes_at(l.adhesion_directions), axes_at(l.friction_directions), {}};
  if (const auto& second = l.friction_directions_second; second.field) a.second = axes_at(second);
  return a;
}

inline void put_axes(const LawAxes& axes, std::array<Vec3<double>, 2>& adhesion,
                     std::array<Vec3<double>, 2>& friction) {
  for (std::size_t i = 0; i < 2; ++i) {
    adhesion[i] = axes.adhesion.axis[i].e;
    friction[i] = axes.friction.axis[i].e;
  }
}

}  // namespace anisocontact::kernel
