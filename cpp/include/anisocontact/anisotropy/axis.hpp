#pragma once
// An axis in space and the position of points about it.

#include <vector>

#include "anisocontact/anisotropy/turned_line.hpp"

namespace anisocontact::anisotropy {

/// Straight line through a point; `direction` is of unit length.
class Axis {
 public:
  Axis() = default;
  Axis(const Vec3<double>& point, const Vec3<double>& direction)
      : point_(point), direction_(direction.normalized()) {}

  /// From the six numbers of a parameter of kind `axis`.
  static Axis from(const std::vector<double>& v) {
    return {Vec3<double>(v[0], v[1], v[2]), Vec3<double>(v[3], v[4], v[5])};
  }

  const Vec3<double>& direction() const { return direction_; }

  /// z x r = R e_phi, around the axis in the sense of a right-handed screw; zero on the axis
  /// itself, as near as the rounding of positions can tell.
  template <class S>
  Vec3<S> around(const Vec3<S>& x) const {
    const Vec3<S> r = constant<S>(direction_).cross(x - constant<S>(point_));
    const double size2 = value(x).squaredNorm() + point_.squaredNorm();
    if (!(value(r.dot(r)) > parallel_limit * parallel_limit * size2)) return Vec3<S>::Zero();
    return r;
  }

 private:
  Vec3<double> point_{Vec3<double>::Zero()};
  Vec3<double> direction_{Vec3<double>::UnitZ()};
};

}  // namespace anisocontact::anisotropy
