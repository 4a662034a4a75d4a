#pragma once
// Axes of direction fields in the contact plane, carried there by the material of a body.

#include <optional>

#include "anisocontact/kernel/contact_frame.hpp"
#include "anisocontact/kernel/interface.hpp"

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

/// x beside a point, with its derivatives along the coordinates; S = Dual<2> has the two coordinates
/// as variables.
template <class S>
Vec3<S> beside(const Vec3<double>& x, [[maybe_unused]] const Vec3<double>& d1,
               [[maybe_unused]] const Vec3<double>& d2) {
  Vec3<S> r = constant<S>(x);
  if constexpr (!std::is_same_v<S, double>)
    for (Eigen::Index k = 0; k < 3; ++k) r[k].d = {d1[k], d2[k]};
  return r;
}
template <class S>
Vec3<S> position_beside(const surface::Jet<double>& j) {
  return beside<S>(j.position, j.d1[0], j.d1[1]);
}
template <class S>
std::array<Vec3<S>, 2> tangents_beside(const surface::Jet<double>& j) {
  return {beside<S>(j.d1[0], j.d2[0], j.d2[1]), beside<S>(j.d1[1], j.d2[1], j.d2[2])};
}
template <class S>
surface::Jet<S> beside(const surface::Jet<double>& j) {
  return {position_beside<S>(j),
          tangents_beside<S>(j),
          {constant<S>(j.d2[0]), constant<S>(j.d2[1]), constant<S>(j.d2[2])}};
}

template <class S>
Vector<S> beside(const std::array<double, 2>& xi) {
  if constexpr (std::is_same_v<S, double>)
    return {xi};
  else
    return {{S::variable(xi[0], 0), S::variable(xi[1], 1)}};
}

/// Writes the axis along c^i rho_i, with c and, in dual numbers, its derivatives along the
/// coordinates; returns whether there is one.
template <class S>
bool put_axis(const surface::Jet<double>& now, const Vec3<double>& n, const Vector<S>& c,
              PlaneAxis& a) {
  a.c = value(c).c;
  const Vec3<double> v = a.c[0] * now.d1[0] + a.c[1] * now.d1[1];
  a.lift = v.dot(n);
  const Vec3<double> flat = v - a.lift * n;
  const double length2 = flat.squaredNorm();
  constexpr double limit = anisotropy::parallel_limit;
  if (!(length2 > limit * limit * v.squaredNorm())) return false;
  const double inverse = 1.0 / std::sqrt(length2);
  a.e = inverse * flat;
  a.mu = inverse * n.cross(a.e);
  if constexpr (!std::is_same_v<S, double>)
    for (std::size_t j = 0; j < 2; ++j) {
      const Vec3<double> dv = c[0].d[j] * now.d1[0] + c[1].d[j] * now.d1[1] +
                              a.c[0] * now.second(0, j) + a.c[1] * now.second(1, j);
      a.by_xi[j] = a.mu.dot(dv);
    }
  return true;
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

/// A body with the basis of its reference configuration; in S = Dual<2> its coordinates may follow
/// the projection, in double they are fixed.
template <class S>
struct ReferencePlane {
  const Carrier& body;
  double orientation;
  anisotropy::TangentBasis<S> basis;

  /// `side`: on which side of the reference the normal is about which directions turn, 1 or -1.
  ReferencePlane(const Carrier& b, double side)
      : body(b),
        orientation(side),
        basis(detail::position_beside<S>(b.reference), detail::tangents_beside<S>(b.reference),
              side) {}

  surface::Geometry<S> geometry() const {
    auto g = surface::tangent_plane(detail::beside<S>(body.reference));
    if (orientation < 0.0) g.normal = -g.normal;
    return g;
  }
};

/// Axes of a field given in the reference configuration and carried by the material: components in
/// the basis of the body are kept, lengths normalised [Konyukhov Schweizerhof 2006, eq. (47)].
template <class S>
PlaneAxes carried(const anisotropy::AnyField& field, const ReferencePlane<S>& reference,
                  const Vec3<double>& n, Side side) {
  const auto c =
      anisotropy::components(field, reference.basis, detail::beside<S>(reference.body.xi),
                             [&] { return reference.geometry(); });
  PlaneAxes r;
  r.side = side;
  r.valid = c.valid;
  for (std::size_t k = 0; k < 2 && r.valid; ++k)
    r.valid = detail::put_axis<S>(reference.body.now, n, c.c[k], r.axis[k]);
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
