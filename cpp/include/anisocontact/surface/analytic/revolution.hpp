#pragma once
// Surface of revolution of a profile; the coordinates are the angle about the axis and the share of
// the profile.

#include "anisocontact/surface/analytic/nurbs_pieces.hpp"
#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/analytic/profile.hpp"

namespace anisocontact::surface {

/// rho = (r(s) cos alpha, r(s) sin alpha, z(s)).
///
/// The profile is kept as a strip (r(s), y, z(s)) across its half plane: what is computed for
/// patches serves for its derivatives and, in the middle of the strip, for its closest points.
class Revolution {
 public:
  /// Where the profile is in the width of its strip.
  static constexpr double middle = 0.5;

  Revolution() : Revolution(Frame(), Segments({{1.0, 0.0}, {1.0, 1.0}}, {}, {}).take()) {}
  Revolution(const Frame& frame, const Profile& profile)
      : frame_(frame), strip_(strip(profile)), pole_(check_radii()) {}

  static Descriptor describe() {
    return {
        "revolution",
        "Surface of revolution of a profile; xi are the angle about the axis and the share of the "
        "profile, by its chords.",
        {{"point", Kind::vector, "length", "point of the axis, where z = 0"},
         axis_parameter("direction of the axis, along which z runs"),
         {"profile", Kind::array, "length",
          "points r, z of the profile one after the other, r >= 0; closed if the last one is "
          "the first"},
         {"arcs",
          Kind::array,
          "angle",
          "angle by which each segment turns to the left on its way; straight if left out",
          Bound::any,
          false,
          {}},
         {"rounding",
          Kind::array,
          "length",
          "radius at each inner point between straight segments, or one for all; sharp if left "
          "out",
          Bound::non_negative,
          false,
          {},
          {},
          {1.0}},
         {"spline",
          Kind::flag,
          "1",
          "whether a cubic spline goes through the points, in the place of segments; an end on the "
          "axis that is within 8 degrees of a right angle to it is made round",
          Bound::any,
          false,
          {0.0}},
         start_parameter(),
         {"inside",
          Kind::flag,
          "1",
          "whether the slave is on the left of the profile as it goes, r to the right and z "
          "upwards, and not on its right; the angle runs the other way then",
          Bound::any,
          false,
          {0.0}}}};
  }
  static Revolution make(const Values& v) {
    const auto& numbers = v.list("profile");
    const auto &arcs = v.list("arcs"), &rounding = v.list("rounding");
    if (numbers.size() % 2 != 0 || numbers.size() < 4)
      throw std::invalid_argument("profile has " + std::to_string(numbers.size()) +
                                  " numbers, needs pairs r, z of two points or more");
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < numbers.size(); i += 2)
      points.emplace_back(numbers[i], numbers[i + 1]);
    const double height = height_of_pole(points);
    for (auto& p : points) p[1] -= height;
    const Frame frame = placed(v, "point").raised(height);
    if (!v.flag("spline")) return {frame, Segments(points, arcs, rounding).take()};
    if (!arcs.empty() || !rounding.empty())
      throw std::invalid_argument("spline goes with neither arcs nor rounding");
    return {frame, SplineProfile(points).take()};
  }

  Domain domain() const {
    const Domain d = strip_.domain();
    return {{-pi, d.lower[0]}, {pi, d.upper[0]}, {true, d.periodic[0]}};
  }

  template <class S>
  Jet<S> jet(const S& alpha, const S& s) const {
    using std::cos, std::sin;
    const Jet<S> p = strip_.jet(s, S(middle));
    const S c = cos(alpha), t = sin(alpha), zero(0.0);
    const auto meridian = [&](const S& out, const S& up) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(out * c, out * t, up));
    };
    const auto parallel = [&](const S& along) -> Vec3<S> {
      return frame_.rotate(Vec3<S>(-along * t, along * c, zero));
    };
    const auto &x = p.position, &d1 = p.d1[0], &d2 = p.d2[0];
    return {constant<S>(frame_.origin()) + meridian(x[0], x[2]),
            {parallel(x[0]), meridian(d1[0], d1[2])},
            {meridian(-x[0], zero), parallel(d1[0]), meridian(d2[0], d2[2])}};
  }

  const Nurbs& strip() const { return strip_; }

  /// The closest point from that of the strip in the half plane of x.
  Foot foot(const Polar& p, const Foot& in_plane) const {
    if (in_plane.status == Status::failed) return {};
    double s = in_plane.xi[0];
    const bool held = in_plane.fixed[0];
    const Domain d = strip_.domain();
    const double cap = fine_polar_cap * (d.upper[0] - d.lower[0]);
    if ((pole_[0] && s < d.lower[0] + cap) || (pole_[1] && s > d.upper[0] - cap)) {
      s = std::clamp(s, d.lower[0] + cap, d.upper[0] - cap);
      const bool others = in_plane.status == Status::ambiguous;
      return {{p.angle, s},
              others ? Status::ambiguous : Status::singular,
              {held && p.radius <= p.unresolved, held}};
    }
    const double radius = strip_.jet(s, middle).position[0];
    const bool any_angle = p.vanishes(p.radius, radius);
    return {{p.angle, s}, any_angle ? Status::ambiguous : in_plane.status, {false, held}};
  }

  const Frame& frame() const { return frame_; }

 private:
  /// Height of an end on the axis, 0 if there is none. From there heights count: beside it they change
  /// by less than the rounding of what they may be above the point that was given.
  static double height_of_pole(const std::vector<Eigen::Vector2d>& points) {
    double size = 0.0;
    for (const auto& p : points) size = std::max(size, std::abs(p[0]));
    for (const auto& end : {points.front(), points.back()})
      if (std::abs(end[0]) <= 1e-12 * size) return end[1];
    return 0.0;
  }

  static Nurbs strip(const Profile& profile) {
    double half = 0.0;
    for (const auto& c : profile.control)
      half = std::max(half, (c - c[2] / profile.control[0][2] * profile.control[0]).norm());
    std::vector<Nurbs::Point> net;
    for (const auto& c : profile.control)
      for (const double y : {-half, half}) net.emplace_back(c[0], c[2] * y, c[1], c[2]);
    return {profile.along, Knots(1, {0.0, 0.0, 1.0, 1.0}, "width"), std::move(net)};
  }

  /// Which ends of the profile are on the axis; elsewhere it has to keep off.
  std::array<bool, 2> check_radii() const {
    const Knots& along = strip_.knots(0);
    const double size = strip_.pieces().size;
    const auto radius = [&](double s) { return strip_.jet(s, middle).position[0]; };
    const auto on_axis = [&](double r) { return std::abs(r) <= 1e-12 * size; };
    double least = Domain::infinity;
    constexpr int parts = 64;
    for (const std::size_t span : along.spans())
      for (int k = 0; k <= parts; ++k) {
        const double f = static_cast<double>(k) / parts;
        const double s = (1.0 - f) * along[span] + f * along[span + 1];
        if (s > along.lower() && s < along.upper()) least = std::min(least, radius(s));
      }
    const double ends[2] = {radius(along.lower()), radius(along.upper())};
    if (!(least > 0.0) || on_axis(least) || ends[0] < -1e-12 * size || ends[1] < -1e-12 * size)
      throw std::invalid_argument("profile meets the axis, must have r > 0 between its ends");
    return {on_axis(ends[0]), on_axis(ends[1])};
  }

  Frame frame_;
  Nurbs strip_;
  std::array<bool, 2> pole_;
};

}  // namespace anisocontact::surface
