#pragma once
// The trial state of a point: what the law has answered, as components in the basis of a surface.

#include "anisocontact/kernel/forms.hpp"

namespace anisocontact::kernel {

/// State of a point that is not in contact, or before its law has answered: where it is.
ANISOCONTACT_INLINE PointState opened(const PointState& old, const std::array<double, 2>& xi,
                                      double gap, std::int64_t facet) {
  PointState s = lasting(old);
  s.xi = s.origin = xi;
  s.gap = gap;
  s.facet = facet;
  return s;
}

/// Where a point in contact is: contact plane and basis of the surface; and what moves with it, the
/// slave, if it is known, and the axes of adhesion, if it has directions.
struct Located {
  const ContactPlane& plane;
  const surface::Geometry<double>& basis;
  const CommittedPoint* committed;
  const Carrier* own;
  const PlaneAxes* adhesion;
};

/// The axes of adhesion, where they are directions.
inline const PlaneAxes* moving_axes(const InterfaceLaw& l, const LawAxes& axes) {
  return l.adhesion_directions.field ? &axes.adhesion : nullptr;
}

namespace detail {

/// Tangents of the slave, axes and turns.
ANISOCONTACT_INLINE void put_companions(const Located& at, PointState& s) {
  const auto keep = [&](const Vec3<double>& v, std::size_t i, KeptPair& kept) {
    const auto c = at.basis.project_contra(v);
    kept[2 * i] = c[0];
    kept[2 * i + 1] = c[1];
  };
  for (std::size_t i = 0; i < 2; ++i) {
    if (at.own != nullptr) {
      keep(at.own->now.d1[i], i, s.slave);
      s.slave_rise[i] = at.basis.normal.dot(at.own->now.d1[i]);
    }
    if (at.adhesion != nullptr) keep(at.adhesion->axis[i].e, i, s.axes);
  }
  if (at.committed == nullptr || !at.committed->remembers()) return;
  s.spin = at.committed->halfway() ? at.committed->spin() : 0.0;
  s.turn = at.committed->turn(at.adhesion != nullptr ? in_frame(at.plane, *at.adhesion)
                                                     : std::array<Flat, 2>{});
}

}  // namespace detail

/// Moves an `opened` state on by what a law has answered: the one place where a state advances.
ANISOCONTACT_INLINE void advance(const InterfaceLaw& l, const PointState& old,
                                 const ContactFrame& in, const Reaction& r, const Located& at,
                                 PointState& s) {
  const auto& g = at.basis;
  s.traction = g.project_co(at.plane.spatial(r.traction)).c;
  s.stored = g.project_co(at.plane.spatial(r.stored)).c;
  s.elastic = g.project_contra(at.plane.spatial(r.elastic)).c;
  s.slip = g.project_contra(at.plane.spatial(r.slip)).c;
  const Vector<double> way = g.project_contra(at.plane.spatial(r.increment));
  s.origin = remembers(old) && !(old.gap > 0.0) ? old.origin : (Vector<double>{s.xi} - way).c;
  const auto normal = normal_energies(law::normal_model(l.normal), old, in.gap, in.pressure, in.dt);
  s.pressure = in.pressure;
  s.slip_accumulated += std::sqrt(r.slip[0] * r.slip[0] + r.slip[1] * r.slip[1]);
  s.dissipation += r.dissipation;
  s.dissipation_viscous += r.viscous + normal.viscous;
  s.energy_adhesion = r.energy;
  s.energy_normal = normal.elastic;
  s.status = static_cast<std::int64_t>(r.status);
  detail::put_companions(at, s);
}

}  // namespace anisocontact::kernel
