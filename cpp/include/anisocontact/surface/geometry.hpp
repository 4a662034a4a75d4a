#pragma once
// Differential geometry of a surface from its position and first and second derivatives: the one
// piece of code behind every surface, analytic or facet.

#include <array>
#include <concepts>
#include <limits>

#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/tensor/dual.hpp"
#include "anisocontact/tensor/tangent.hpp"

namespace anisocontact::surface {

/// Position rho, first derivatives rho_i and second derivatives rho_11, rho_12, rho_22.
template <class S>
struct Jet {
  Vec3<S> position;
  std::array<Vec3<S>, 2> d1;
  std::array<Vec3<S>, 3> d2;

  const Vec3<S>& second(std::size_t i, std::size_t j) const { return d2[i + j]; }
};

/// Range of a surface's coordinates; a periodic coordinate wraps, an open one ends at an edge.
struct Domain {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 2> lower{-infinity, -infinity};
  std::array<double, 2> upper{infinity, infinity};
  std::array<bool, 2> periodic{false, false};

  /// What to take off a periodic coordinate to bring it between its ends.
  double turns(std::size_t i, double u) const {
    const double period = upper[i] - lower[i];
    return period * std::floor((u - lower[i]) / period);
  }
  /// Difference of two coordinates, on a periodic coordinate the shorter way round.
  double difference(std::size_t i, double to, double from) const {
    const double d = to - from;
    if (!periodic[i]) return d;
    const double period = upper[i] - lower[i];
    return d - period * std::round(d / period);
  }
};

/// A surface gives its jet at any coordinates, in doubles and in dual numbers.
template <class T>
concept Surface = requires(const T& s, double u, Dual<3> x) {
  { s.jet(u, u) } -> std::same_as<Jet<double>>;
  { s.jet(x, x) } -> std::same_as<Jet<Dual<3>>>;
  { s.domain() } -> std::same_as<Domain>;
  { T::describe() } -> std::same_as<Descriptor>;
};

/// Metric, normal, curvature and connection of a surface at a point.
template <class S>
struct Geometry {
  Jet<S> jet;
  CoCo<S> a_co{};                        ///< a_ij = rho_i . rho_j
  ContraContra<S> a_contra{};            ///< a^ij
  S area{};                              ///< sqrt(det a_ij)
  Vec3<S> normal{};                      ///< n = rho_1 x rho_2 / area
  CoCo<S> h_co{};                        ///< h_ij = rho_ij . n
  ContraCo<S> h_mixed{};                 ///< h^i_j = a^ik h_kj, n_j = -h^i_j rho_i (Weingarten)
  std::array<CoCo<S>, 2> christoffel{};  ///< Gamma^k_ij = rho_ij . rho^k, first index k

  /// rho^i = a^ij rho_j.
  Vec3<S> dual_basis(std::size_t i) const {
    return a_contra(i, 0) * jet.d1[0] + a_contra(i, 1) * jet.d1[1];
  }
  /// Covariant components v . rho_i of a spatial vector.
  Covector<S> project_co(const Vec3<S>& v) const { return {{v.dot(jet.d1[0]), v.dot(jet.d1[1])}}; }
  /// Contravariant components v . rho^i of a spatial vector.
  Vector<S> project_contra(const Vec3<S>& v) const { return a_contra * project_co(v); }
  /// Of two vectors.
  std::array<Vector<S>, 2> project_contra(const std::array<Vec3<S>, 2>& v) const {
    return {project_contra(v[0]), project_contra(v[1])};
  }
  /// T_i rho^i.
  Vec3<S> spatial(const Covector<S>& t) const { return spatial(a_contra * t); }
  /// v^i rho_i.
  Vec3<S> spatial(const Vector<S>& v) const { return v[0] * jet.d1[0] + v[1] * jet.d1[1]; }
};

/// Metric, area and normal from a jet; curvature and connection stay zero.
template <class S>
ANISOCONTACT_INLINE Geometry<S> tangent_plane(const Jet<S>& jet) {
  using std::sqrt;
  Geometry<S> g{.jet = jet};
  const auto& r = g.jet.d1;
  const S mixed = r[0].dot(r[1]);
  g.a_co = {{{{r[0].dot(r[0]), mixed}, {mixed, r[1].dot(r[1])}}}};
  g.a_contra = inverse(g.a_co);
  const Vec3<S> cross = r[0].cross(r[1]);
  g.area = sqrt(cross.dot(cross));
  g.normal = (S(1.0) / g.area) * cross;
  return g;
}

/// Metric, area, normal and curvature from a jet; the connection stays zero.
template <class S>
Geometry<S> curved_plane(const Jet<S>& jet) {
  Geometry<S> g = tangent_plane(jet);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) g.h_co(i, j) = jet.second(i, j).dot(g.normal);
  g.h_mixed = g.a_contra * g.h_co;
  return g;
}

/// Geometry from a jet [Konyukhov Schweizerhof 2006, eq. (3), (8)].
template <class S>
Geometry<S> geometry(const Jet<S>& jet) {
  Geometry<S> g = curved_plane(jet);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3<S> rho_k = g.dual_basis(k);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) g.christoffel[k](i, j) = jet.second(i, j).dot(rho_k);
  }
  return g;
}

/// The geometry in plain numbers.
template <class S>
Geometry<double> value(const Geometry<S>& g) {
  using anisocontact::value;
  Geometry<double> r;
  r.jet = {value(g.jet.position),
           {value(g.jet.d1[0]), value(g.jet.d1[1])},
           {value(g.jet.d2[0]), value(g.jet.d2[1]), value(g.jet.d2[2])}};
  r.a_co = value(g.a_co);
  r.a_contra = value(g.a_contra);
  r.area = value(g.area);
  r.normal = value(g.normal);
  r.h_co = value(g.h_co);
  r.h_mixed = value(g.h_mixed);
  r.christoffel = {value(g.christoffel[0]), value(g.christoffel[1])};
  return r;
}

/// Basis r_i = (a_i^k - h_i^k xi^3) rho_k, r_3 = n of the space around the surface
/// [Konyukhov Schweizerhof 2006, eq. (3)].
template <class S>
std::array<Vec3<S>, 3> spatial_basis(const Geometry<S>& g, const S& gap) {
  std::array<Vec3<S>, 3> r;
  for (std::size_t i = 0; i < 2; ++i)
    r[i] = g.jet.d1[i] - gap * (g.h_mixed(0, i) * g.jet.d1[0] + g.h_mixed(1, i) * g.jet.d1[1]);
  r[2] = g.normal;
  return r;
}

/// v^i_|j = v^i_,j + Gamma^i_jk v^k of a field with components v^i and derivatives v^i_,j.
template <class S>
ContraCo<S> covariant_derivative(const Geometry<S>& g, const Vector<S>& v,
                                 const ContraCo<S>& derivatives) {
  ContraCo<S> r = derivatives;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      r(i, j) += g.christoffel[i](j, 0) * v[0] + g.christoffel[i](j, 1) * v[1];
  return r;
}

/// T_i|j = T_i,j - Gamma^k_ij T_k of a field with components T_i and derivatives T_i,j.
template <class S>
CoCo<S> covariant_derivative(const Geometry<S>& g, const Covector<S>& t,
                             const CoCo<S>& derivatives) {
  CoCo<S> r = derivatives;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      r(i, j) -= g.christoffel[0](i, j) * t[0] + g.christoffel[1](i, j) * t[1];
  return r;
}

}  // namespace anisocontact::surface
