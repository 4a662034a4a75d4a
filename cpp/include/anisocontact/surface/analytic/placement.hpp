#pragma once
// What surfaces of revolution have in common: an origin, an axis, where the angle starts, and the
// side the material is on.

#include <numbers>

#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/surface/foot.hpp"
#include "anisocontact/surface/frame.hpp"

namespace anisocontact::surface {

inline constexpr double pi = std::numbers::pi;

inline Parameter axis_parameter(const std::string& doc) {
  return {"axis", Kind::vector, "1", doc, Bound::nonzero};
}
/// An axis that may be left out, where the shape does not depend on it.
inline Parameter pole_parameter() {
  return {"axis", Kind::vector,   "1", "direction of the poles", Bound::nonzero,
          false,  {0.0, 0.0, 1.0}};
}
inline Parameter start_parameter() {
  return {"start",
          Kind::vector,
          "1",
          "direction in which the angle is zero, made orthogonal to the axis; any if left out",
          Bound::any,
          false,
          {0.0, 0.0, 0.0}};
}
inline Parameter inside_parameter() {
  return {"inside",
          Kind::flag,
          "1",
          "whether the slave is inside (a bore): the normal points inwards and the angle runs the "
          "other way",
          Bound::any,
          false,
          {0.0}};
}

/// Frame with its third axis along `axis` and its first along `start`, mirrored for a bore.
inline Frame placed(const Values& v, const std::string& origin) {
  const Frame f =
      Frame::from(v.vector(origin), v.vector("axis"), v.vector("start"), "axis", "start");
  return v.flag("inside") ? f.mirrored() : f;
}

/// Cylindrical coordinates of a point in the frame of a surface of revolution.
struct Polar {
  double radius, angle, height;
  double unresolved;  ///< lengths below are rounding; there the angle is zero

  Polar(const Frame& frame, const Vec3<double>& x) : unresolved(frame.rounding(x)) {
    const Vec3<double> y = frame.to_local(x);
    radius = std::sqrt(y[0] * y[0] + y[1] * y[1]);
    angle = radius <= unresolved ? 0.0 : std::atan2(y[1], y[0]);
    height = y[2];
  }
  /// Whether a distance to an axis or a centre is as good as none for a surface of this radius.
  bool vanishes(double distance, double of_radius) const {
    return distance <= unresolved + focal_limit * of_radius;
  }
};

/// Foot at a longitude and latitude, kept off the poles.
inline Foot polar_foot(double longitude, double latitude) {
  constexpr double last = 0.5 * pi - fine_polar_cap;
  if (std::abs(latitude) <= last) return {{longitude, latitude}, Status::interior};
  return {{longitude, std::copysign(last, latitude)}, Status::singular};
}

}  // namespace anisocontact::surface
