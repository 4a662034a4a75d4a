#pragma once
// Box in any orientation about a set of points.

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::surface {

struct OrientedBox {
  Vec3<double> centre{Vec3<double>::Zero()};
  Eigen::Matrix3d axes{Eigen::Matrix3d::Identity()};  ///< unit vectors in rows
  Vec3<double> half{Vec3<double>::Zero()};

  OrientedBox() = default;
  /// The least box with these axes, and room for rounding.
  OrientedBox(const Eigen::Matrix3d& directions, const std::vector<Vec3<double>>& points)
      : axes(directions) {
    Vec3<double> low = axes * points.front(), high = low;
    for (const auto& p : points) {
      low = low.cwiseMin(axes * p);
      high = high.cwiseMax(axes * p);
    }
    centre = axes.transpose() * (0.5 * (low + high));
    const double reach = low.cwiseAbs().maxCoeff() + high.cwiseAbs().maxCoeff();
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    half = (0.5 * (high - low)).array() + rounding * reach;
  }

  /// Squared distance of a point, zero inside.
  double distance2(const Vec3<double>& x) const noexcept {
    const Vec3<double> d = (axes * (x - centre)).cwiseAbs() - half;
    return d.cwiseMax(0.0).squaredNorm();
  }
  std::vector<Vec3<double>> corners() const {
    std::vector<Vec3<double>> r;
    for (int i = 0; i < 8; ++i) {
      const Vec3<double> sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
      r.emplace_back(centre + axes.transpose() * half.cwiseProduct(sign));
    }
    return r;
  }
};

/// Axes along u, across it in the plane of u and v, and normal to both; any where they are none.
inline Eigen::Matrix3d axes_along(const Vec3<double>& u, const Vec3<double>& v) {
  const Vec3<double> n = u.cross(v);
  if (!(n.norm() > 1e-6 * (u.squaredNorm() + v.squaredNorm()))) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d axes;
  axes.row(0) = u.normalized();
  axes.row(2) = n.normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes;
}

}  // namespace anisocontact::surface
