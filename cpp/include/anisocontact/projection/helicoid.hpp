#pragma once
// Closest point of a helicoid: one equation in one unknown, the angle, with many roots.

#include <algorithm>
#include <cmath>
#include <optional>

#include "anisocontact/surface/analytic/helicoid.hpp"

namespace anisocontact::projection {

/// The nearest points of the generators of a helicoid to a point x, as functions of their angle.
class NearestOfGenerators {
 public:
  enum class Edge { none, inner, outer };

  /// The nearest point of a generator, with the derivatives along the angle of half its squared distance,
  /// from which the radius is eliminated.
  struct Nearest {
    double angle, radius, distance, slope, curvature, size;
    Edge edge;
    bool falls() const { return slope < 0.0; }
    bool focal() const { return curvature <= surface::focal_limit * size; }
  };

  NearestOfGenerators(const surface::Helicoid& s, const Vec3<double>& x) noexcept
      : p_(s.frame(), x), rise_(s.rise()), slope_(s.slope()), radii_(s.radii()) {}

  const surface::Polar& point() const { return p_; }
  /// Coordinate of a radius.
  double depth(double radius) const { return radii_[1] - radius; }

  Nearest at(double angle) const {
    const double c = p_.radius * std::cos(angle - p_.angle);
    const double s = p_.radius * std::sin(angle - p_.angle);
    const double above = p_.height - rise_ * angle, stretch = 1.0 + slope_ * slope_;
    const double free = (c + slope_ * (above + slope_ * radii_[0])) / stretch;
    const double r = std::clamp(free, radii_[0], radii_[1]);
    const double up = above - slope_ * (r - radii_[0]), out = r - c;
    const Edge edge = r > free ? Edge::inner : r < free ? Edge::outer : Edge::none;
    const double coupled = edge == Edge::none ? s + rise_ * slope_ : 0.0;
    return {angle,
            r,
            std::sqrt(out * out + s * s + up * up),
            r * s - rise_ * up,
            r * c + rise_ * rise_ - coupled * coupled / stretch,
            r * r + rise_ * rise_,
            edge};
  }

  /// Angles between which the edges are as high as x.
  std::array<double, 2> of_equal_height() const {
    const double inner = p_.height / rise_;
    const double outer = (p_.height - slope_ * (radii_[1] - radii_[0])) / rise_;
    return {std::min(inner, outer), std::max(inner, outer)};
  }

  /// Bound from below of the distance to the lines of generators within `half` of an angle.
  double height_apart(double middle, double half) const {
    const double here = p_.height - rise_ * middle - slope_ * (p_.radius - radii_[0]);
    const double change =
        std::abs(rise_) * half + std::abs(slope_) * p_.radius * (1.0 - std::cos(half));
    return (std::abs(here) - change) / std::sqrt(1.0 + slope_ * slope_);
  }

 private:
  surface::Polar p_;
  double rise_, slope_;
  const std::array<double, 2>& radii_;
};

/// Finds all minima of the distance in some ranges of angles, and keeps the least.
class HelicoidSearch {
 public:
  using Nearest = NearestOfGenerators::Nearest;

  explicit HelicoidSearch(const NearestOfGenerators& of) noexcept
      : of_(of), unresolved_(of.point().unresolved) {}

  /// By which ranges should overlap; minima that are as near to each other are one.
  static constexpr double overlap = 1e-6;

  /// All within `half` of an angle.
  void within(double middle, double half) noexcept {
    const auto parts = static_cast<int>(std::ceil(2.0 * half / step));
    Nearest begin = of_.at(middle - half);
    for (int k = 1; k <= parts; ++k) {
      const Nearest end = of_.at(middle + half * (2.0 * k / parts - 1.0));
      between(begin, end, most_halvings);
      begin = end;
    }
  }

  surface::Foot foot() const noexcept {
    using surface::Status;
    if (!best_) return {};
    const bool held = best_->edge != NearestOfGenerators::Edge::none;
    const Status regular = held ? Status::edge : Status::interior;
    return {{best_->angle, of_.depth(best_->radius)},
            twice_ || best_->focal() ? Status::ambiguous : regular,
            {false, held}};
  }

 private:
  /// Angle in which the slope of the distance turns back once at most.
  static constexpr double step = surface::pi / 36.0;
  static constexpr int most_halvings = 20;

  /// The curvature jumps where the nearest point comes to an edge, and what is on both sides of there is
  /// searched apart.
  void between(const Nearest& begin, const Nearest& end, int halvings) noexcept {
    if (begin.edge != end.edge && halvings > 0) {
      const Nearest middle = of_.at(0.5 * (begin.angle + end.angle));
      between(begin, middle, halvings - 1);
      between(middle, end, halvings - 1);
    } else if (begin.falls() && !end.falls()) {
      consider(minimum(begin.angle, end.angle));
    } else if (begin.falls() == end.falls() && turns_back(begin, end)) {
      const Nearest middle = extreme_slope(begin, end);
      if (middle.falls() != begin.falls())
        consider(begin.falls() ? minimum(begin.angle, middle.angle)
                               : minimum(middle.angle, end.angle));
    }
  }

  /// Whether a slope of the same sign at both ends comes nearer to zero between them.
  static bool turns_back(const Nearest& begin, const Nearest& end) {
    const double towards = begin.falls() ? 1.0 : -1.0;
    return towards * begin.curvature > 0.0 && towards * end.curvature < 0.0;
  }

  /// Where the slope has the other sign, or is next to zero if it has not, by halving.
  Nearest extreme_slope(const Nearest& begin, const Nearest& end) const noexcept {
    const bool falls = begin.falls(), rising = begin.curvature > 0.0;
    double from = begin.angle, to = end.angle;
    Nearest here = of_.at(0.5 * (from + to));
    for (int k = 1; k < most_halvings && here.falls() == falls; ++k) {
      ((here.curvature > 0.0) == rising ? from : to) = here.angle;
      here = of_.at(0.5 * (from + to));
    }
    return here;
  }

  /// Where the slope changes its sign between two angles, by Newton's method, or halving where that
  /// leaves them.
  Nearest minimum(double from, double to) const noexcept {
    constexpr double resolution = 2.0 * std::numeric_limits<double>::epsilon();
    constexpr int most_steps = 100;
    Nearest here = of_.at(0.5 * (from + to));
    for (int k = 0; k < most_steps; ++k) {
      (here.falls() ? from : to) = here.angle;
      const double newton = here.angle - here.slope / here.curvature;
      const bool inside = here.curvature > 0.0 && newton > from && newton < to;
      const double next = inside ? newton : 0.5 * (from + to);
      const double way = std::abs(next - here.angle);
      here = of_.at(next);
      if (way <= resolution * (1.0 + std::abs(next))) break;
    }
    return here;
  }

  /// Of two as near it keeps that with the lesser angle, which comes first.
  void consider(const Nearest& found) noexcept {
    if (best_ && std::abs(found.angle - best_->angle) < 2.0 * overlap) return;
    if (!best_ || found.distance < best_->distance - unresolved_) {
      best_ = found;
      twice_ = false;
    } else if (found.distance <= best_->distance + unresolved_) {
      twice_ = true;
    }
  }

  const NearestOfGenerators& of_;
  double unresolved_;
  std::optional<Nearest> best_;
  bool twice_{false};
};

/// Where a point of the flank is more than half a turn from where it is as high as x, a whole turn
/// towards there brings it nearer: the closest point is within half a turn of these angles. A generator
/// is as far from x as x is from its half plane at least: where one in the half plane of x is nearer than
/// the axis, only those of a small angle beside it can be nearer still.
inline surface::Foot closest_point(const surface::Helicoid& s, const Vec3<double>& x,
                                   const std::array<double, 2>*) noexcept {
  using surface::pi;
  const NearestOfGenerators of(s, x);
  const surface::Polar& p = of.point();
  const auto ends = of.of_equal_height();
  const double first = std::round((ends[0] - pi - p.angle) / (2.0 * pi));
  const double last = std::round((ends[1] + pi - p.angle) / (2.0 * pi));
  double reach = std::numeric_limits<double>::infinity();
  for (double k = first; k <= last; ++k)
    reach = std::min(reach, of.at(p.angle + 2.0 * pi * k).distance);
  constexpr double rounding_of_angles = 1.01;
  double half = pi;
  if (p.radius > reach) half = std::min(pi, rounding_of_angles * std::asin(reach / p.radius));
  half += HelicoidSearch::overlap;
  HelicoidSearch search(of);
  for (double k = first; k <= last; ++k) {
    const double middle = p.angle + 2.0 * pi * k;
    if (of.height_apart(middle, half) <= reach + p.unresolved) search.within(middle, half);
  }
  return search.foot();
}

}  // namespace anisocontact::projection
