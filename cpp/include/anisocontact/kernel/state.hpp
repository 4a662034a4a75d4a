#pragma once
// What a contact point remembers from one accepted step to the next.

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::kernel {

enum class Contact : std::int64_t { open = 0, stick = 1, slip = 2 };

/// Why a point could not be updated.
enum class Failure : std::int64_t { none = 0, projection = 1, direction = 2, law = 3 };

/// Components of a vector of the tangent plane, and of two vectors one after the other.
using Components = std::array<double, 2>;
using KeptPair = std::array<double, 4>;

/// The fields of a state, the only list of them: type, name, value at the start.
///  xi, origin: coordinates of the projection, and of where the contact began, xi_(0); from the slip
///    of the first step, exact where coordinates are straight
///  traction, stored, elastic, slip: T_i in the basis at xi; elastic force the next trial starts
///    from, T_i; elastic slip and last sliding increment, xi^i
///  slave, axes: tangents of the slave, and axes of adhesion, in the basis at xi, xi^i; no axes
///    without directions
///  slave_rise: components of the tangents of the slave along the normal there
///  spin: turn of the slave against the master in the last slip
///  turn: last turn of normal, axes or slave: the largest angle
///  gap: xi^3 less the offset, the gap at which the surfaces count as touching
///  dissipation, dissipation_viscous: by friction, by the viscosity of the laws, per area
///  energy_adhesion, energy_normal: elastic energy of the tangential law and of the normal law, per
///    area; not a number where a law stores none, as what is viscous
///  multiplier: N at no gap, the normal multiplier of an augmented Lagrangian
///  stiffer: by what share penalties are stiffer at this point, the normal and the tangential one
///  facet: of a meshed master; -1 on an analytic one
#define ANISOCONTACT_POINT_STATE(FIELD)  \
  FIELD(Components, xi, {})              \
  FIELD(Components, origin, {})          \
  FIELD(Components, traction, {})        \
  FIELD(Components, stored, {})          \
  FIELD(Components, elastic, {})         \
  FIELD(Components, slip, {})            \
  FIELD(KeptPair, slave, {})             \
  FIELD(Components, slave_rise, {})      \
  FIELD(KeptPair, axes, {})              \
  FIELD(double, spin, {})                \
  FIELD(double, turn, {})                \
  FIELD(double, gap, {})                 \
  FIELD(double, pressure, {})            \
  FIELD(double, slip_accumulated, {})    \
  FIELD(double, dissipation, {})         \
  FIELD(double, dissipation_viscous, {}) \
  FIELD(double, energy_adhesion, {})     \
  FIELD(double, energy_normal, {})       \
  FIELD(double, offset, {})              \
  FIELD(double, multiplier, {})          \
  FIELD(Components, stiffer, {})         \
  FIELD(std::int64_t, status, {})        \
  FIELD(std::int64_t, facet, {-1})

/// Committed state of a point. Plain data of eight-byte fields, so that an array of states is one
/// block of memory which can be copied, compared and stored whole.
struct PointState {
#define ANISOCONTACT_FIELD(type, name, start) type name start;
  ANISOCONTACT_POINT_STATE(ANISOCONTACT_FIELD)
#undef ANISOCONTACT_FIELD
};

/// Where a field is in a state, and how many numbers it has.
struct StateField {
  const char* name;
  std::size_t offset, count;
  bool whole;  ///< whether its numbers are integers
};

inline constexpr auto state_fields = std::to_array<StateField>({
#define ANISOCONTACT_FIELD(type, name, start)                               \
  {#name, offsetof(PointState, name), sizeof(type) / sizeof(std::uint64_t), \
   std::is_integral_v<type>},
    ANISOCONTACT_POINT_STATE(ANISOCONTACT_FIELD)
#undef ANISOCONTACT_FIELD
});

inline bool has_pair(const KeptPair& p) { return p != KeptPair{}; }

/// Whether a point was in contact and has a history.
inline bool remembers(const PointState& s) {
  return s.status != static_cast<std::int64_t>(Contact::open);
}

/// What a point keeps whatever happens to it.
ANISOCONTACT_INLINE PointState lasting(const PointState& old) {
  PointState s;
  s.slip_accumulated = old.slip_accumulated;
  s.dissipation = old.dissipation;
  s.dissipation_viscous = old.dissipation_viscous;
  s.offset = old.offset;
  s.multiplier = old.multiplier;
  return s;
}

}  // namespace anisocontact::kernel
