#pragma once
// One slave point against a facet of a deforming master: kinematics -> law -> traction, and its
// exact derivatives with respect to everything that moves.
//
// The facet enters through its position and first derivatives at fixed coordinates, rho, rho_1,
// rho_2, which are linear in its nodes; so do the committed point of the master and the tangents of
// the slave. The coordinates of the projection follow from these by the implicit function theorem.

#include "anisocontact/kernel/advance.hpp"
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
      : point_(p), n_(n), start_(start) {}

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
      if (!master_) master_.emplace(point_.master, 1.0);
      return carried(*d.field, *master_, n_, d.side);
    }
    if (!own_) own_.emplace(point_.own, orientation(point_.own, n_));
    return carried(*d.field, *own_, n_, d.side);
  }

  const PairPoint& point_;
  const Vec3<double>& n_;
  const PlaneAxis& start_;
  std::optional<ReferencePlane<std::conditional_t<tangent, Dual<2>, double>>> master_;
  std::optional<ReferencePlane<double>> own_;
};

/// Supports hold slave and master along directions h of the contact plane: nothing slips along them,
///   (u - h (h . u))_a = (delta_ab - h_a h_b) u_b ,
/// and the directions are fixed, so that derivatives are projected alike.
class HeldDirections {
 public:
  HeldDirections(const double* held, const ContactPlane& plane) noexcept {
    for (std::size_t b = 0; held != nullptr && b < 2; ++b) {
      const Vec3<double>& t = plane.t[b];
      const Flat along = plane.along({t.dot(Vec3<double>(held)), t.dot(Vec3<double>(held + 3)),
                                      t.dot(Vec3<double>(held + 6))});
      for (std::size_t a = 0; a < 2; ++a) free_[a][b] -= along[a];
    }
  }
  Flat rest(const Flat& u) const noexcept {
    return {free_[0][0] * u[0] + free_[0][1] * u[1], free_[1][0] * u[0] + free_[1][1] * u[1]};
  }
  /// Slopes by the increment, from those by what is left of it.
  void pull_back(Reaction& r) const noexcept {
    const Flat first = r.slope(Slope::increment, 0), second = r.slope(Slope::increment, 1);
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t a = 0; a < 2; ++a)
        r.slope(Slope::increment, k)[a] = first[a] * free_[0][k] + second[a] * free_[1][k];
  }

 private:
  std::array<Flat, 2> free_{Flat{1.0, 0.0}, Flat{0.0, 1.0}};
};

/// Writes all derivatives of a point that touches: of what `frame` and `committed` say of the
/// geometry and `r` of the law.
inline void put_slopes(const InterfaceLaw& law, FacetFrame& frame, const PairPoint& p,
                       const Couple& couple, const Dual<1>& pressure, const Reaction& r,
                       const LawAxes& axes, const CommittedPoint* committed,
                       PairSlopes& d) noexcept {
  const ContactPlane& plane = frame.plane;
  frame.follow(p);
  frame.follow(d);
  // summed here: a compiler that cannot tell what a reference is to reads all again after each sum
  std::array<Form, 2> friction;
  put_friction_forms(law, r, axes, plane, committed, friction);
  for (Form& f : friction) frame.expand(f, d);
  d.friction = friction;
  d.along_friction[0] = plane.t;
  d.direction(0, NearForm::gap) = pressure.d[0] * plane.n;
  for (std::size_t a = 0; a < 2; ++a)
    d.direction(0, NearForm::turn, a) = pressure.v * plane.t[a] - r.traction[a] * plane.n;
  couple.differentiate(r.traction, d);
}

/// Writes what `update_pair` answers to `out`, which is new.
template <bool tangent>
ANISOCONTACT_INLINE void answer_pair(const InterfaceLaw& law, const Law& reacts,
                                     const PointState& state, const PairPoint& p, double dt,
                                     [[maybe_unused]] PairSlopes* slopes,
                                     PairResult& out) noexcept {
  if (p.feature == Feature::off) {
    out.state = lasting(state);
    return;
  }
  FacetFrame frame(p);
  const ContactPlane& plane = frame.plane;
  out.normal = plane.n;
  const double gap = frame.gap() - state.offset;
  out.state = opened(state, p.master.xi, gap, p.facet);
  const Dual<1> pressure = pressure_of(law, state, gap, dt);
  if (!(pressure.v > 0.0)) return;
  out.traction = pressure.v * plane.n;
  const auto fail = [&](Failure why) {
    out.failure = why;
    out.state = state;
    out.state.facet = p.facet;
  };
  PlaneAxis start;
  if (!frame.start(p, start)) return fail(Failure::direction);
  PairAxes<tangent> axes_at(p, plane.n, start);
  const LawAxes axes = law_axes(law, axes_at);
  if (!axes.valid()) return fail(Failure::direction);
  put_axes(axes, out.adhesion_axes, out.friction_axes);
  std::optional<CommittedPoint> history;
  if (state.facet >= 0)
    history.emplace(plane, surface::tangent_plane(p.before), p.master.now.position, state, &p.own,
                    looks_back(law.evolution));
  const CommittedPoint* committed = history ? &*history : nullptr;
  ContactFrame in = contact_frame(law, state, gap, dt, pressure, committed, axes, plane);
  const HeldDirections held(p.held, plane);
  in.increment = held.rest(in.increment);
  Reaction r = reacts.evaluate(state, in, tangent);
  if (r.failure != Failure::none) return fail(r.failure);
  if constexpr (tangent) {
    slopes->by_slip =
        slip_slopes(r, in.d_pressure * plane.n + plane.spatial(r.slope(Slope::gap, 0)), plane);
    held.pull_back(r);
  }
  advance(law, state, in, r, {plane, frame.facet(), committed, &p.own, moving_axes(law, axes)},
          out.state);
  const Vec3<double> friction = plane.spatial(r.traction);
  const Couple couple(frame, friction);
  out.traction += friction;
  for (std::size_t j = 0; j < 2; ++j) out.couple[j] = couple.on_tangent(j);
  if constexpr (tangent)
    with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
      put_slopes(law, frame, p, couple, pressure, r, axes, committed, *slopes);
    });
}

}  // namespace detail

/// Pure update of one slave point against a facet; `reacts` is the tangential law of `law`. Where there
/// are `slopes` to be written, all derivatives of a point that touches. Those of others are not
/// written.
template <bool tangent>
PairResult update_pair(const InterfaceLaw& law, const Law& reacts, const PointState& state,
                       const PairPoint& p, double dt,
                       [[maybe_unused]] PairSlopes* slopes = nullptr) noexcept {
  PairResult out;
  with_unfused([&]() ANISOCONTACT_INLINE_LAMBDA {
    detail::answer_pair<tangent>(law, reacts, state, p, dt, slopes, out);
  });
  return out;
}

}  // namespace anisocontact::kernel
