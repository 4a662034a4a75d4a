#pragma once
// Orthonormal frame that places an analytic surface in space.

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::surface {

class Frame {
 public:
  Frame()
      : Frame(Vec3<double>::Zero(),
              {Vec3<double>::UnitX(), Vec3<double>::UnitY(), Vec3<double>::UnitZ()}) {}
  Frame(const Vec3<double>& origin, const std::array<Vec3<double>, 3>& axes)
      : origin_(origin), axes_(axes), reach_(origin.cwiseAbs().maxCoeff()) {}

  /// Third axis along `third`; first axis along `first` made orthogonal to it. Where `first` is
  /// zero the global axis least aligned with `third` is taken. The names are for the message.
  static Frame from(const std::vector<double>& origin, const std::vector<double>& third,
                    const std::vector<double>& first, const std::string& third_name,
                    const std::string& first_name) {
    const Vec3<double> o(origin[0], origin[1], origin[2]);
    Vec3<double> z(third[0], third[1], third[2]);
    Vec3<double> x(first[0], first[1], first[2]);
    if (!(z.norm() > 0.0)) throw std::invalid_argument(third_name + " must not be zero");
    z.normalize();
    if (x.norm() > 0.0) {
      x.normalize();
      if (x.cross(z).norm() < parallel_limit)
        throw std::invalid_argument(first_name + " is parallel to " + third_name);
    } else {
      Eigen::Index least = 0;
      z.cwiseAbs().minCoeff(&least);
      x = Vec3<double>::Unit(least);
    }
    x = (x - x.dot(z) * z).normalized();
    return {o, {x, z.cross(x), z}};
  }

  /// The frame with its second axis reversed. It is left-handed: the coordinate that runs from the
  /// first to the second axis runs the other way, and rho_1 x rho_2 points to the other side.
  Frame mirrored() const { return {origin_, {axes_[0], -axes_[1], axes_[2]}}; }

  /// The frame with its origin moved along its third axis.
  Frame raised(double height) const { return {origin_ + height * axes_[2], axes_}; }

  const Vec3<double>& origin() const { return origin_; }
  const Vec3<double>& axis(std::size_t i) const { return axes_[i]; }

  template <class S>
  Vec3<S> to_global(const Vec3<S>& local) const {
    return constant<S>(origin_) + rotate(local);
  }
  /// Global components of a direction.
  template <class S>
  Vec3<S> rotate(const Vec3<S>& local) const {
    return local[0] * constant<S>(axes_[0]) + local[1] * constant<S>(axes_[1]) +
           local[2] * constant<S>(axes_[2]);
  }
  Vec3<double> to_local(const Vec3<double>& x) const {
    const Vec3<double> r = x - origin_;
    return {r.dot(axes_[0]), r.dot(axes_[1]), r.dot(axes_[2])};
  }
  /// Length that local coordinates of x cannot resolve.
  double rounding(const Vec3<double>& x) const {
    constexpr double digits = 8.0 * std::numeric_limits<double>::epsilon();
    return digits * (reach_ + x.cwiseAbs().maxCoeff());
  }

 private:
  /// Sine of the angle below which two directions count as parallel: far above rounding, far
  /// below any direction a person means.
  static constexpr double parallel_limit = 1e-8;
  Vec3<double> origin_;
  std::array<Vec3<double>, 3> axes_;
  double reach_;
};

}  // namespace anisocontact::surface
