#pragma once
// Flank of a screw thread: a straight generator that turns about an axis and rises along it; the
// coordinates are the angle and the depth below the outer edge. The first ones run along the thread.

#include "anisocontact/surface/analytic/placement.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

/// rho = (r cos alpha, r sin alpha, c alpha + t (r - inner)), r = outer - s >= inner, where 2 pi c is the
/// lead and t the tangent of the angle of the flank.
class Helicoid {
 public:
  Helicoid() = default;
  Helicoid(const Frame& frame, double lead, const std::array<double, 2>& radii, double flank)
      : frame_(frame), rise_(lead / (2.0 * pi)), slope_(std::tan(flank)), radii_(radii) {}

  static Descriptor describe() {
    return {
        "helicoid",
        "Flank of a screw thread, without ends; xi are the angle, along the thread, and the depth "
        "below the outer edge.",
        {{"point", Kind::vector, "length",
          "point of the axis, at the height of the inner edge where the angle is zero"},
         axis_parameter("direction of the axis, to which the flank looks"),
         {"lead", Kind::scalar, "length",
          "rise in a full turn, of all starts of the thread; right-handed if positive",
          Bound::nonzero},
         {"inner", Kind::scalar, "length", "radius of the inner edge", Bound::positive},
         {"outer", Kind::scalar, "length", "radius of the outer edge", Bound::positive},
         {"flank",
          Kind::scalar,
          "angle",
          "by which the generators rise outwards from a plane across the axis, less than a right "
          "angle; falling if negative",
          Bound::any,
          false,
          {0.0}},
         start_parameter(),
         {"below",
          Kind::flag,
          "1",
          "whether the slave is below the flank: the normal points against the axis and the angle "
          "runs the other way",
          Bound::any,
          false,
          {0.0}}}};
  }
  static Helicoid make(const Values& v) {
    const double lead = v.scalar("lead"), inner = v.scalar("inner"), outer = v.scalar("outer"),
                 flank = v.scalar("flank");
    if (!(outer > inner)) throw std::invalid_argument("outer must be more than inner");
    if (!(std::abs(flank) < 0.5 * pi))
      throw std::invalid_argument("flank must be less than a right angle");
    if (!((outer - inner) * std::abs(std::tan(flank)) <= most_leads * std::abs(lead)))
      throw std::invalid_argument("flank rises by more than " +
                                  std::to_string(static_cast<int>(most_leads)) +
                                  " leads between inner and outer");
    const Frame f =
        Frame::from(v.vector("point"), v.vector("axis"), v.vector("start"), "axis", "start");
    // in a mirrored frame the same screw has the other hand
    if (v.flag("below")) return {f.mirrored(), -lead, {inner, outer}, flank};
    return {f, lead, {inner, outer}, flank};
  }

  Domain domain() const {
    return {{-Domain::infinity, 0.0}, {Domain::infinity, radii_[1] - radii_[0]}, {false, false}};
  }

  template <class S>
  Jet<S> jet(const S& alpha, const S& depth) const {
    using std::cos, std::sin;
    const S r = S(radii_[1]) - depth, ca = cos(alpha), sa = sin(alpha), zero(0.0);
    const S height = S(rise_) * alpha + S(slope_) * (r - S(radii_[0]));
    return {frame_.to_global(Vec3<S>(r * ca, r * sa, height)),
            {frame_.rotate(Vec3<S>(-r * sa, r * ca, S(rise_))),
             frame_.rotate(Vec3<S>(-ca, -sa, S(-slope_)))},
            {frame_.rotate(Vec3<S>(-r * ca, -r * sa, zero)), frame_.rotate(Vec3<S>(sa, -ca, zero)),
             constant<S>(Vec3<double>::Zero())}};
  }

  const Frame& frame() const { return frame_; }
  double rise() const { return rise_; }    ///< by an angle of one
  double slope() const { return slope_; }  ///< rise of a generator by a length of one
  const std::array<double, 2>& radii() const { return radii_; }

 private:
  /// Most rise between the edges, in leads: the turns that the search for a closest point goes through.
  static constexpr double most_leads = 20.0;

  Frame frame_;
  double rise_{1.0}, slope_{0.0};
  std::array<double, 2> radii_{1.0, 2.0};
};

}  // namespace anisocontact::surface
