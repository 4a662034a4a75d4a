#pragma once
// A facet seen from a point: rho - x and its derivatives as polynomials, for the many evaluations of
// a projection. Flips are not known here: coordinates are those of the reference facet.

#include "anisocontact/projection/local.hpp"
#include "anisocontact/surface/facet_bezier.hpp"

namespace anisocontact::projection {

using surface::FacetNodes;
using surface::Topology;

class RelativeFacet {
 public:
  RelativeFacet(Topology t, const FacetNodes& nodes, const Vec3<double>& x) noexcept : topology(t) {
    if (t == Topology::tri3 || t == Topology::quad4)
      std::copy_n(nodes.begin(), surface::node_count(t), controls.begin());
    else
      controls = surface::control_points(t, nodes);
    for (std::size_t i = 0; i < surface::control_count(t); ++i) controls[i] -= x;
    const auto& p = controls;
    switch (t) {
      case Topology::tri3:
        put({p[0], p[1] - p[0], p[2] - p[0]});
        return;
      case Topology::quad4:
        put({p[0], p[1] - p[0], p[2] - p[0], p[3] - p[2] - p[1] + p[0]});
        return;
      case Topology::tri6:
        put({p[0], 2.0 * (p[1] - p[0]), 2.0 * (p[3] - p[0]), 2.0 * (p[0] - p[1] - p[3] + p[4]),
             p[0] - 2.0 * p[1] + p[2], p[0] - 2.0 * p[3] + p[5]});
        return;
      case Topology::quad8:
      case Topology::quad9:
        square();
        return;
    }
  }

  bool triangular() const { return surface::triangular(topology); }

  Local at(const std::array<double, 2>& xi) const noexcept {
    const auto [u, v] = xi;
    Local l;
    if (topology == Topology::tri3) {
      l.r = c_[0] + u * c_[1] + v * c_[2];
      return derivatives(l, c_[1], c_[2]);
    }
    if (topology == Topology::quad4) {
      const Vec3<double> r1 = c_[1] + v * c_[3];
      l.r = c_[0] + v * c_[2] + u * r1;
      derivatives(l, r1, c_[2] + u * c_[3]);
      l.h12 += l.r.dot(c_[3]);
      return l;
    }
    if (topology == Topology::tri6) {
      const Vec3<double> a = c_[1] + v * c_[3] + u * c_[4], b = c_[2] + v * c_[5];
      l.r = c_[0] + u * a + v * b;
      derivatives(l, a + u * c_[4], b + v * c_[5] + u * c_[3]);
      return bend(l, 2.0 * c_[4], c_[3], 2.0 * c_[5]);
    }
    const Vec3<double> a0 = c_[0] + v * (c_[2] + v * c_[5]), a1 = c_[1] + v * (c_[3] + v * c_[7]),
                       a2 = c_[4] + v * (c_[6] + v * c_[8]);
    const Vec3<double> b0 = c_[2] + 2.0 * v * c_[5], b1 = c_[3] + 2.0 * v * c_[7],
                       b2 = c_[6] + 2.0 * v * c_[8];
    l.r = a0 + u * (a1 + u * a2);
    derivatives(l, a1 + 2.0 * u * a2, b0 + u * (b1 + u * b2));
    return bend(l, 2.0 * a2, b1 + 2.0 * u * b2, 2.0 * (c_[5] + u * (c_[7] + u * c_[8])));
  }

  Topology topology;
  FacetNodes controls;  ///< control points relative to x

 private:
  static Local& derivatives(Local& l, const Vec3<double>& r1, const Vec3<double>& r2) noexcept {
    l.r1 = r1;
    l.r2 = r2;
    l.f = 0.5 * l.r.squaredNorm();
    l.g1 = l.r.dot(r1);
    l.g2 = l.r.dot(r2);
    l.h11 = r1.squaredNorm();
    l.h12 = r1.dot(r2);
    l.h22 = r2.squaredNorm();
    return l;
  }

  /// Adds the second derivatives of r to those of f.
  static Local& bend(Local& l, const Vec3<double>& r11, const Vec3<double>& r12,
                     const Vec3<double>& r22) noexcept {
    l.h11 += l.r.dot(r11);
    l.h12 += l.r.dot(r12);
    l.h22 += l.r.dot(r22);
    return l;
  }

  template <std::size_t N>
  void put(const Vec3<double> (&c)[N]) noexcept {
    std::copy(std::begin(c), std::end(c), c_.begin());
  }

  /// From control points of degree 2 in both coordinates, one coordinate after the other.
  void square() noexcept {
    const auto line = [](const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
      return std::array<Vec3<double>, 3>{a, 2.0 * (b - a), a - 2.0 * b + c};
    };
    const auto& p = controls;
    const auto low = line(p[0], p[1], p[2]), middle = line(p[3], p[4], p[5]),
               high = line(p[6], p[7], p[8]);
    const auto k0 = line(low[0], middle[0], high[0]), k1 = line(low[1], middle[1], high[1]),
               k2 = line(low[2], middle[2], high[2]);
    put({k0[0], k1[0], k0[1], k1[1], k2[0], k0[2], k2[1], k1[2], k2[2]});
  }

  FacetNodes c_;  ///< of 1, u, v, uv, uu, vv, uuv, uvv, uuvv, as far as there are (tri3: 1, u, v)
};

}  // namespace anisocontact::projection
