#pragma once
// Neighbours among scattered points: a balanced k-d tree without pointers.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::anisotropy {

class PointTree {
 public:
  PointTree() = default;
  explicit PointTree(std::vector<Vec3<double>> points)
      : points_(std::move(points)), order_(points_.size()), split_(points_.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    build(0, order_.size());
  }

  std::size_t size() const { return points_.size(); }
  const Vec3<double>& point(std::size_t i) const { return points_[i]; }

  /// Calls f(i) for every point within the radius of x.
  template <class F>
  void within(const Vec3<double>& x, double radius2, const F& f) const noexcept {
    const auto take = [&](std::size_t i, double d2) {
      if (d2 <= radius2) f(i);
    };
    visit(x, 0, order_.size(), [&] { return radius2; }, take);
  }

  struct Nearest {
    std::size_t index{0};
    double distance2{std::numeric_limits<double>::infinity()};
  };
  /// The nearest point that `accept(i)` takes; at an infinite distance where there is none.
  template <class Accept>
  Nearest nearest_of(const Vec3<double>& x, const Accept& accept) const noexcept {
    Nearest r;
    const auto take = [&](std::size_t i, double d2) {
      if (d2 < r.distance2 && accept(i)) r = {i, d2};
    };
    visit(x, 0, order_.size(), [&] { return r.distance2; }, take);
    return r;
  }
  std::size_t nearest(const Vec3<double>& x) const noexcept {
    return nearest_of(x, [](std::size_t) { return true; }).index;
  }

 private:
  /// The middle of a range splits the rest of it along the widest extent.
  void build(std::size_t low, std::size_t high) {
    if (low >= high) return;
    Vec3<double> least = points_[order_[low]], most = least;
    for (std::size_t k = low; k < high; ++k) {
      least = least.cwiseMin(points_[order_[k]]);
      most = most.cwiseMax(points_[order_[k]]);
    }
    Eigen::Index axis = 0;
    (most - least).maxCoeff(&axis);
    const std::size_t middle = low + (high - low) / 2;
    const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(low), at(middle), at(high), [&](std::size_t a, std::size_t b) {
      return points_[a][axis] < points_[b][axis];
    });
    split_[middle] = static_cast<std::uint8_t>(axis);
    build(low, middle);
    build(middle + 1, high);
  }

  /// Calls f(i, squared distance) for the points of a range, leaving out halves beyond `limit()`.
  template <class Limit, class F>
  void visit(const Vec3<double>& x, std::size_t low, std::size_t high, const Limit& limit,
             const F& f) const noexcept {
    if (low >= high) return;
    const std::size_t middle = low + (high - low) / 2;
    const Vec3<double>& p = points_[order_[middle]];
    f(order_[middle], (p - x).squaredNorm());
    const auto axis = static_cast<Eigen::Index>(split_[middle]);
    const double d = x[axis] - p[axis];
    if (d < 0.0) {
      visit(x, low, middle, limit, f);
      if (d * d <= limit()) visit(x, middle + 1, high, limit, f);
    } else {
      visit(x, middle + 1, high, limit, f);
      if (d * d <= limit()) visit(x, low, middle, limit, f);
    }
  }

  std::vector<Vec3<double>> points_;
  std::vector<std::size_t> order_;
  std::vector<std::uint8_t> split_;
};

}  // namespace anisocontact::anisotropy
