#pragma once
// How the numbers that a law sees change with what moves: linear forms in the slave point, the
// master at the projection, the master at the committed point, and the tangents of the slave.

#include "anisocontact/kernel/committed.hpp"

namespace anisocontact::kernel {

inline std::array<Flat, 2> in_frame(const ContactPlane& p, const PlaneAxes& a) {
  return {p.along(a.axis[0].e), p.along(a.axis[1].e)};
}

/// Adds the changes of both angles of a field, if they change anything; a share of them, where the
/// axes of a law follow those of now by a share.
inline void add_angles(const Reaction& r, Slope s, const PlaneAxes& axes, const ContactPlane& p,
                       double share, std::array<Form, 2>& f) {
  for (std::size_t k = 0; k < 2; ++k)
    if (const Flat& slope = r.slope(s, k); slope != Flat{})
      p.add_angle({share * slope[0], share * slope[1]}, axes.axis[k], axes.side, f);
}

/// Whether the tensors of adhesion have axes halfway along the step.
inline bool has_halfway_axes(const InterfaceLaw& l, const CommittedPoint* committed) {
  return committed != nullptr && committed->looks_back() && law::linear_model(l.adhesion).w != 0.0;
}

/// The slopes of T_a by the two components of a vector.
inline Flat slopes_of(const Reaction& r, Slope s, std::size_t a) {
  return {r.slope(s, 0)[a], r.slope(s, 1)[a]};
}

/// What the law sees of a point. Without a committed point there is no history and no slip.
ANISOCONTACT_INLINE ContactFrame contact_frame(const InterfaceLaw& l, const PointState& state,
                                               double gap, double dt, const Dual<1>& pressure,
                                               const CommittedPoint* committed, const LawAxes& axes,
                                               const ContactPlane& p) {
  const law::NormalModel& m = law::normal_model(l.normal);
  ContactFrame in{gap,
                  dt,
                  pressure.v,
                  pressure.d[0],
                  contact_fraction(m, state, Dual<1>::variable(gap, 0)),
                  share_of_penetration(m, state, gap),
                  {},
                  {},
                  {},
                  in_frame(p, axes.adhesion),
                  in_frame(p, axes.friction),
                  in_frame(p, axes.second),
                  {}};
  in.rate_axes =
      has_halfway_axes(l, committed) ? committed->axes_halfway(in.adhesion_axes) : in.adhesion_axes;
  if (committed == nullptr) return in;
  in.increment = committed->increment();
  if (!committed->remembers()) return in;
  in.stored = committed->stored();
  in.elastic = committed->elastic();
  return in;
}

/// Writes the forms of t_1 . dT and t_2 . dT for T = T_a t_a.
inline void put_friction_forms(const InterfaceLaw& l, const Reaction& r, const LawAxes& axes,
                               const ContactPlane& p, const CommittedPoint* committed,
                               std::array<Form, 2>& f) {
  for (std::size_t a = 0; a < 2; ++a) {
    f[a].clear();
    p.add_gap(r.slope(Slope::gap, 0)[a], f[a]);
  }
  const double share = has_halfway_axes(l, committed) ? 0.5 : 1.0;
  add_angles(r, Slope::adhesion, axes.adhesion, p, share, f);
  add_angles(r, Slope::friction, axes.friction, p, 1.0, f);
  add_angles(r, Slope::second, axes.second, p, 1.0, f);
  if (committed == nullptr) return;
  for (std::size_t a = 0; a < 2; ++a) {
    const Flat by_axes = slopes_of(r, Slope::adhesion, a);
    const double rest = 1.0 - share;
    committed->add({slopes_of(r, Slope::increment, a),
                    slopes_of(r, Slope::stored, a),
                    slopes_of(r, Slope::elastic, a),
                    {rest * by_axes[0], rest * by_axes[1]}},
                   f[a]);
  }
}

/// Slopes of the traction by slip of a point that stays where it is, so that normal and axes do: those
/// of the law, and along the normal those by the gap.
inline Eigen::Matrix3d slip_slopes(const Reaction& r, const Vec3<double>& by_gap,
                                   const ContactPlane& p) {
  Eigen::Matrix3d by = by_gap * p.n.transpose();
  for (std::size_t k = 0; k < 2; ++k)
    by += p.spatial(r.slope(Slope::increment, k)) * p.t[k].transpose();
  return by;
}

/// The forms of t_1 . dt, t_2 . dt and n . dt for t = N n + T_a t_a.
inline std::array<Form, 3> traction_forms(const std::array<Form, 2>& friction, const Reaction& r,
                                          const ContactFrame& in, const ContactPlane& p) {
  std::array<Form, 3> f{friction[0], friction[1], {}};
  f[2].clear();
  for (std::size_t a = 0; a < 2; ++a) {
    f[a].turn[a] += in.pressure;
    f[2].turn[a] -= r.traction[a];
  }
  p.add_gap(in.d_pressure, f[2]);
  return f;
}

}  // namespace anisocontact::kernel
