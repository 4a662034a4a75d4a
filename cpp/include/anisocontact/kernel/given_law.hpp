#pragma once
// Tangential laws that are not in the core. They are evaluated between two batches: the first records
// the law input of all points, in the axes e_1, e_2 = n x e_1 of the law; in the second its output
// stands for it behind the seam, so that forces and tangent come from it as from the laws of the core.

#include "anisocontact/kernel/contact_frame.hpp"
#include "anisocontact/kernel/interface.hpp"

namespace anisocontact::kernel {

/// What a law sees of a point, in its axes; nothing where the point is not in contact.
struct LawInput {
  double gap{0.0}, pressure{0.0};
  Flat increment{}, stored{}, elastic{};
};

/// What a law answers, in its axes. Derivatives are rows: d T_1, then d T_2.
struct LawOutput {
  Flat traction, stored, slip;
  std::array<Flat, 2> by_increment, by_stored, by_elastic;
  Flat by_pressure;
  double dissipation, energy;
};

namespace detail {

inline Flat times(const std::array<Flat, 2>& m, const Flat& v) {
  return {m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]};
}
inline Flat plus(const Flat& a, const Flat& b) { return {a[0] + b[0], a[1] + b[1]}; }
inline Flat scaled(double k, const Flat& v) { return {k * v[0], k * v[1]}; }
/// A quarter of a turn about n.
inline Flat quarter(const Flat& v) { return {-v[1], v[0]}; }

/// The axes of a law in the contact plane: the first one of the friction axes, and n x e_1.
struct OwnAxes {
  Flat e;

  explicit OwnAxes(const ContactFrame& in) : e(in.friction_axes[0]) {}
  Flat in_axes(const Flat& v) const {
    return {e[0] * v[0] + e[1] * v[1], e[0] * v[1] - e[1] * v[0]};
  }
  Flat in_plane(const Flat& v) const {
    return {e[0] * v[0] - e[1] * v[1], e[1] * v[0] + e[0] * v[1]};
  }
};

inline LawInput law_input(const ContactFrame& in, const OwnAxes& axes) {
  return {in.gap, in.pressure, axes.in_axes(scaled(in.fraction.v, in.increment)),
          axes.in_axes(in.stored), axes.in_axes(in.elastic)};
}

/// Slopes in the contact plane from those in the axes of the law, which turn by an angle of their
/// own: vectors then change in the axes by minus a quarter of a turn, the force in the plane by one.
inline void put_slopes_of(const LawOutput& a, const ContactFrame& in, const OwnAxes& axes,
                          const LawInput& seen, Reaction& r) {
  const auto put = [&](Slope s, const std::array<Flat, 2>& by) {
    for (std::size_t j = 0; j < 2; ++j)
      r.slope(s, j) =
          axes.in_plane(times(by, axes.in_axes({j == 0 ? 1.0 : 0.0, j == 0 ? 0.0 : 1.0})));
  };
  put(Slope::increment, a.by_increment);
  put(Slope::stored, a.by_stored);
  put(Slope::elastic, a.by_elastic);
  const Flat turned = plus(
      times(a.by_increment, quarter(seen.increment)),
      plus(times(a.by_stored, quarter(seen.stored)), times(a.by_elastic, quarter(seen.elastic))));
  r.slope(Slope::friction, 0) =
      plus(quarter(axes.in_plane(a.traction)), axes.in_plane(scaled(-1.0, turned)));
  Flat& by_gap = r.slope(Slope::gap, 0);
  by_gap = scaled(in.d_pressure, axes.in_plane(a.by_pressure));
  for (std::size_t j = 0; j < 2; ++j) {
    Flat& by = r.slope(Slope::increment, j);
    by_gap = plus(by_gap, scaled(in.increment[j] * in.fraction.d[0], by));
    by = scaled(in.fraction.v, by);
  }
}

}  // namespace detail

/// Records what a law sees, and answers nothing.
class Recorder final : public Law {
 public:
  explicit Recorder(LawInput& to) noexcept : to_(to) {}

  Reaction evaluate(const PointState&, const ContactFrame& in, bool) const noexcept override {
    to_ = detail::law_input(in, detail::OwnAxes(in));
    return {};
  }

 private:
  LawInput& to_;
};

/// Stands for a law whose output is known.
class GivenLaw final : public Law {
 public:
  explicit GivenLaw(const LawOutput& output) noexcept : output_(output) {}

  Reaction evaluate(const PointState&, const ContactFrame& in,
                    bool tangent) const noexcept override {
    const detail::OwnAxes axes(in);
    const LawInput seen = detail::law_input(in, axes);
    const Flat elastic = detail::plus(detail::plus(seen.elastic, seen.increment),
                                      detail::scaled(-1.0, output_.slip));
    Reaction r;
    r.traction = axes.in_plane(output_.traction);
    r.stored = axes.in_plane(output_.stored);
    r.slip = axes.in_plane(output_.slip);
    r.elastic = axes.in_plane(elastic);
    r.increment = axes.in_plane(seen.increment);
    r.dissipation = output_.dissipation;
    r.energy = output_.energy;
    r.status = output_.slip == Flat{} ? Contact::stick : Contact::slip;
    if (tangent) detail::put_slopes_of(output_, in, axes, seen, r);
    return r;
  }

 private:
  const LawOutput& output_;
};

}  // namespace anisocontact::kernel
