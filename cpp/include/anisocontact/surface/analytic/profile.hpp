#pragma once
// Profile of a surface of revolution: straight segments and arcs, or a smooth curve through points.

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include "anisocontact/surface/analytic/knots.hpp"

namespace anisocontact::surface {

/// A rational B-spline (w r, w z, w). Its parameter runs from 0 to 1 by the chords of its pieces, so
/// that segments that meet without a corner meet with the same first derivative.
struct Profile {
  Knots along;
  std::vector<Eigen::Vector3d> control;
};

/// Points r, z joined by segments that turn to the left by an angle each.
class Segments {
 public:
  using Point = Eigen::Vector2d;

  /// Of `points` r, z; `turns` of the segments (none: straight) and `radii` at the inner points
  /// (none: sharp, one: of all).
  Segments(std::vector<Point> points, std::vector<double> turns, std::vector<double> radii) {
    const std::size_t n = points.size() - 1;
    if (turns.empty()) turns.assign(n, 0.0);
    if (turns.size() != n)
      throw std::invalid_argument("arcs has " + std::to_string(turns.size()) +
                                  " numbers, the profile has " + std::to_string(n) + " segments");
    if (radii.size() == 1) radii.assign(n - 1, radii[0]);
    if (radii.empty()) radii.assign(n - 1, 0.0);
    if (radii.size() != n - 1)
      throw std::invalid_argument("rounding has " + std::to_string(radii.size()) +
                                  " numbers, the profile has " + std::to_string(n - 1) +
                                  " inner points");
    start(points[0]);
    double free = (points[1] - points[0]).norm();  // of the segment, before the next rounding
    for (std::size_t i = 0; i < n; ++i) {
      if (i + 1 < n && radii[i] > 0.0 && turns[i] == 0.0 && turns[i + 1] == 0.0)
        free = round(points[i + 1], points[i + 2], radii[i], free);
      else if (i + 1 < n && radii[i] > 0.0)
        throw std::invalid_argument("rounding is between straight segments alone");
      else {
        arc(points[i + 1], turns[i]);
        if (i + 1 < n) free = (points[i + 2] - points[i + 1]).norm();
      }
    }
  }

  Profile take() {
    knots_.push_back(knots_.back());
    const double length = knots_.back();
    for (double& k : knots_) k /= length;
    return {Knots(2, std::move(knots_), "profile"), std::move(control_)};
  }

 private:
  static double cross(const Point& a, const Point& b) { return a[0] * b[1] - a[1] * b[0]; }
  static Point turned(const Point& a, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * a[0] - s * a[1], s * a[0] + c * a[1]};
  }

  void start(const Point& p) {
    at_ = p;
    control_.emplace_back(p[0], p[1], 1.0);
    knots_.assign(3, 0.0);
  }

  /// A conic from where the profile is, with the weight of its middle.
  void piece(const Point& middle, double weight, const Point& end) {
    control_.emplace_back(weight * middle[0], weight * middle[1], weight);
    control_.emplace_back(end[0], end[1], 1.0);
    const double to = knots_.back() + (end - at_).norm();
    knots_.insert(knots_.end(), 2, to);
    at_ = end;
  }

  /// Goes on to a point, turning by an angle on the way; pieces of a quarter of a circle at most.
  void arc(const Point& end, double turn) {
    const Point chord = end - at_, from = at_;
    const double length = chord.norm(), size = std::max(end.norm(), at_.norm());
    if (!(length > 1e-12 * size)) {
      if (turn == 0.0 && control_.size() > 1) return;  // roundings that meet
      throw std::invalid_argument("profile has a segment without length");
    }
    if (turn == 0.0) return piece(0.5 * (from + end), 1.0, end);
    if (!(std::abs(turn) < 2.0 * std::numbers::pi))
      throw std::invalid_argument("arcs must be less than a full turn");
    const double radius = 0.5 * length / std::sin(0.5 * turn);  // negative to the right
    const Point tangent = turned(chord / length, -0.5 * turn);
    const Point centre = from + radius * Point(-tangent[1], tangent[0]);
    const auto pieces = std::ceil(std::abs(turn) / (0.5 * std::numbers::pi) - 1e-9);
    const double part = turn / pieces;
    for (double k = 1.0; k <= pieces; ++k) {
      const Point along = turned(tangent, (k - 1.0) * part);
      const Point to = k < pieces ? centre + turned(from - centre, k * part) : end;
      piece(at_ + radius * std::tan(0.5 * part) * along, std::cos(0.5 * part), to);
    }
  }

  /// Straight on to the rounding of a corner and along it; what is left of the segment after it.
  double round(const Point& corner, const Point& next, double radius, double free) {
    const Point in = (corner - at_).normalized(), out = next - corner;
    const double length = out.norm();
    const double turn = std::atan2(cross(in, out), in.dot(out));
    const double cut = radius * std::tan(0.5 * std::abs(turn));
    constexpr double room = 1.0 + 1e-9;
    if (!(cut <= room * free && cut <= room * length))
      throw std::invalid_argument("rounding is too large for the segments of the profile at (" +
                                  std::to_string(corner[0]) + ", " + std::to_string(corner[1]) +
                                  ")");
    arc(corner - cut * in, 0.0);
    if (cut > 0.0) arc(corner + (cut / length) * out, turn);
    return length - cut;
  }

  Point at_;
  std::vector<Eigen::Vector3d> control_;
  std::vector<double> knots_;
};

/// Cubic spline through points, by their chords: without a knot at the second and the last but one
/// [de Boor 2001, ch. IV]; where the last point is the first, the two ends have the same derivatives.
///
/// An end on the axis that is nearly at a right angle to it is at one, as the end of a curve that goes on
/// as its mirror image beyond the axis: z' = 0 and r'' = 0 there. Else it has a tip.
class SplineProfile {
 public:
  explicit SplineProfile(const std::vector<Eigen::Vector2d>& points)
      : points_(points), closed_(points.size() > 3 && points.front() == points.back()) {
    at_.assign(points.size(), 0.0);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double chord = (points[i] - points[i - 1]).norm();
      if (!(chord > 0.0)) throw std::invalid_argument("profile has a segment without length");
      at_[i] = at_[i - 1] + chord;
    }
    const double length = at_.back();
    for (double& t : at_) t /= length;
    for (auto* end : {&points_.front(), &points_.back()})
      if (std::abs((*end)[0]) <= 1e-12 * length) (*end)[0] = 0.0;
  }

  Profile take() const {
    Profile made = through({false, false});
    if (closed_ || points_.size() < 3) return made;
    const std::array<bool, 2> round{is_round(made, 0), is_round(made, 1)};
    return round[0] || round[1] ? through(round) : made;
  }

 private:
  /// Sine of the angle between the end of a spline and a plane across the axis, 8 degrees, up to which
  /// it is meant to be round there: four points of a dome leave it up to 4 degrees, tips have more.
  static constexpr double blunt = 0.139;

  /// Whether an end is on the axis and nearly at a right angle to it.
  bool is_round(const Profile& made, std::size_t end) const {
    const auto& c = made.control;
    const Eigen::Vector3d& tip = end == 0 ? c.front() : c.back();
    const Eigen::Vector3d along = (end == 0 ? c[1] : c[c.size() - 2]) - tip;
    return tip[0] == 0.0 && std::abs(along[1]) < blunt * along.norm();
  }

  /// The spline, round at ends on the axis or without conditions there.
  Profile through(const std::array<bool, 2>& round) const {
    const std::size_t n = points_.size();
    const auto ends = static_cast<std::size_t>(round[0]) + static_cast<std::size_t>(round[1]);
    const std::size_t degree = std::min<std::size_t>(3, n - 1 + ends);
    std::vector<double> knots(degree + 1, 0.0);
    const std::size_t first = closed_ || round[0] ? 1 : 2, last = closed_ || round[1] ? 1 : 2;
    for (std::size_t i = first; i + last < n; ++i) knots.push_back(at_[i]);
    knots.insert(knots.end(), degree + 1, at_.back());
    Profile made{Knots(degree, std::move(knots), "profile"), {}};
    const Eigen::VectorXd r = component(made.along, 0, round), z = component(made.along, 1, round);
    for (Eigen::Index i = 0; i < r.size(); ++i) made.control.emplace_back(r[i], z[i], 1.0);
    made.control.front().head<2>() = points_.front();
    made.control.back().head<2>() = points_.back();
    if (round[0]) made.control[1][1] = points_.front()[1];
    if (round[1]) made.control[made.control.size() - 2][1] = points_.back()[1];
    return made;
  }

  /// Control points of r or z, which is odd or even across the axis at a round end.
  Eigen::VectorXd component(const Knots& along, Eigen::Index which,
                            const std::array<bool, 2>& round) const {
    const auto size = static_cast<Eigen::Index>(along.count());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
    const auto add = [&](Eigen::Index row, double t, std::size_t derivative, double sign) {
      const std::size_t span = along.span(t), degree = along.degree();
      const auto basis = along.basis(span, t);
      for (std::size_t k = 0; k <= degree; ++k)
        matrix(row, static_cast<Eigen::Index>(span - degree + k)) += sign * basis[derivative][k];
    };
    Eigen::Index row = 0;
    for (; row < static_cast<Eigen::Index>(points_.size()); ++row) {
      const auto i = static_cast<std::size_t>(row);
      add(row, at_[i], 0, 1.0);
      values[row] = points_[i][which];
    }
    for (std::size_t d = 1; closed_ && d <= 2; ++d, ++row) {
      add(row, 0.0, d, 1.0);
      add(row, at_.back(), d, -1.0);
    }
    for (std::size_t end = 0; end < 2; ++end)
      if (round[end]) add(row++, end == 0 ? 0.0 : at_.back(), which == 0 ? 2 : 1, 1.0);
    return matrix.partialPivLu().solve(values);
  }

  std::vector<Eigen::Vector2d> points_;
  std::vector<double> at_;  ///< parameter of each point
  bool closed_;
};

}  // namespace anisocontact::surface
