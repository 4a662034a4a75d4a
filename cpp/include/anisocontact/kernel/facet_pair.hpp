#pragma once
// One slave point against a facet of a deforming master: kinematics -> law -> traction, and its
// exact derivatives with respect to everything that moves.
//
// The facet enters through its position and first derivatives at fixed coordinates, rho, rho_1,
// rho_2, which are linear in its nodes; so do the committed point of the master and the tangents of
// the slave. The coordinates of the projection follow from these by the implicit function theorem.

#include "anisocontact/kernel/couple.hpp"

namespace anisocontact::kernel {

struct PairResult {
  Vec3<double> traction{Vec3<double>::Zero()};  ///< on the slave
  /// m_j on the tangents of the master, see kernel/couple.hpp
  std::array<Vec3<double>, 2> couple{Vec3<double>::Zero(), Vec3<double>::Zero()};
  Vec3<double> normal{Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> adhesion_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> friction_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  PointState state{};
  Failure failure{Failure::none};
};

namespace detail {

/// Axes of fields at a point, with the reference planes of both bodies where they are needed.
template <bool tangent>
class PairAxes {
 public:
  PairAxes(const PairPoint& p, const Vec3<double>& n, const PlaneAxis& start) noexcept
      : point_(p), n_(n), start_(start), turns_(p.mirrored ? -1.0 : 1.0) {}

  /// Without a field, along the first direction.
  PlaneAxes operator()(const Directions& d) noexcept {
    if (!d.field) return with_normal(start_, n_);
    PlaneAxes r;
    with_widest([&]() ANISOCONTACT_INLINE_LAMBDA { r = of_field(d); });
    return r;
  }

 private:
  PlaneAxes of_field(const Directions& d) noexcept {
    if (d.side == Side::master) {
      if (!master_) master_.emplace(point_.master, turns_);
      return carried(*d.field, *master_, n_, d.side);
    }
    if (!own_) own_.emplace(point_.own, turns_ * orientation(point_.own, n_));
    return carried(*d.field, *own_, n_, d.side);
  }

  const PairPoint& point_;
  const Vec3<double>& n_;
  const PlaneAxis& start_;
  double turns_;
  std::optional<ReferencePlane<std::conditional_t<tangent, Dual<2>, double>>> master_;
  std::optional<ReferencePlane<double>> own_;
};

/// Writes all derivatives of a point that touches: of what `foot` and `committed` say of the
/// geometry and `r` of the law.
inline void put_slopes(const InterfaceLaw& law, Footing& foot, const PairPoint& p,
                       const Couple& couple, const Dual<1>& pressure, const FrameReaction& r,
                       const LawAxes& axes, const CommittedPoint* committed,
                       PairSlopes& d) noexcept {
  const ContactPlane& plane = foot.plane;
  foot.follow(p);
  foot.follow(d);
  put_friction_forms(law, r, axes, plane, committed, d.friction);
  for (Form& f : d.friction) foot.expand(f, d);
  d.along_friction[0] = plane.t;
  d.direction(0, NearForm::gap) = pressure.d[0] * plane.n;
  for (std::size_t a = 0; a < 2; ++a)
    d.direction(0, NearForm::turn, a) = pressure.v * plane.t[a] - r.traction[a] * plane.n;
  couple.differentiate(r.traction, d);
}

}  // namespace detail

/// What answers in the contact plane: adhesion and friction of the interface.
struct OwnReaction {
  template <bool tangent>
  FrameReaction at(const InterfaceLaw& law, const PointState& state,
                   const FrameInput& in) const noexcept {
    return react_in_frame<tangent>(law, state, in);
  }
};

/// Pure update of one slave point against a facet; where there are `slopes` to be written, all
/// derivatives of a point that touches. Those of others are not written.
template <bool tangent, class React = OwnReaction>
PairResult update_pair(const InterfaceLaw& law, const PointState& state, const PairPoint& p,
                       double dt, [[maybe_unused]] PairSlopes* d = nullptr,
                       const React& react = {}) noexcept {
  PairResult out;
  out.state = lasting(state);
  if (p.feature == Feature::off) return out;
  Footing foot(p);
  const ContactPlane& plane = foot.plane;
  out.normal = plane.n;
  out.state.facet = p.facet;
  out.state.xi = out.state.origin = p.master.xi;
  const double gap = foot.gap() - state.offset;
  out.state.gap = gap;
  const Dual<1> pressure = detail::pressure_of(law, state, gap, dt);
  if (!(pressure.v > 0.0)) return out;
  out.traction = pressure.v * plane.n;
  const auto fail = [&](Failure why) {
    out.failure = why;
    out.state = state;
    out.state.facet = p.facet;
    return out;
  };
  PlaneAxis start;
  if (!foot.start(p, start)) return fail(Failure::direction);
  detail::PairAxes<tangent> axes_at(p, plane.n, start);
  const LawAxes axes = law_axes(law, axes_at);
  if (!axes.valid()) return fail(Failure::direction);
  put_axes(axes, out.adhesion_axes, out.friction_axes);
  std::optional<CommittedPoint> history;
  if (state.facet >= 0)
    history.emplace(plane, surface::tangent_plane(p.before), p.master.now.position, state, &p.own,
                    looks_back(law.evolution));
  const CommittedPoint* committed = history ? &*history : nullptr;
  const FrameInput in = frame_input(law, gap, dt, pressure, committed, axes, plane);
  const FrameReaction r = react.template at<tangent>(law, state, in);
  if (r.failure != Failure::none) return fail(r.failure);
  out.state = in_basis(r, state, p.master.xi, plane, foot.facet(), committed,
                       companions(law, &p.own, axes));
  out.state.facet = p.facet;
  const Vec3<double> friction = plane.spatial(r.traction);
  const Couple couple(foot, friction);
  out.traction += friction;
  for (std::size_t j = 0; j < 2; ++j) out.couple[j] = couple.on_tangent(j);
  if constexpr (tangent)
    with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
      detail::put_slopes(law, foot, p, couple, pressure, r, axes, committed, *d);
    });
  return out;
}

}  // namespace anisocontact::kernel
