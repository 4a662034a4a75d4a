#pragma once
// What a contact point remembers from one accepted step to the next.

#include <array>
#include <cstdint>

namespace anisocontact::kernel {

enum class Contact : std::int64_t { open = 0, stick = 1, slip = 2 };

/// Why a point could not be updated.
enum class Failure : std::int64_t { none = 0, projection = 1, direction = 2, law = 3 };

/// Contravariant components of two vectors, one after the other.
using KeptPair = std::array<double, 4>;

/// Committed state of a point. Plain data of eight-byte fields, so that an array of states is one
/// block of memory which can be copied, compared and stored whole.
struct PointState {
  std::array<double, 2> xi{};        ///< coordinates of the projection
  std::array<double, 2> origin{};    ///< coordinates where the contact began, xi_(0); from the slip
                                     ///< of the first step, exact where coordinates are straight
  std::array<double, 2> traction{};  ///< T_i in the basis at xi
  std::array<double, 2> stored{};    ///< elastic force the next trial starts from, T_i
  std::array<double, 2> elastic{};   ///< elastic slip, xi^i
  std::array<double, 2> slip{};      ///< last sliding increment, xi^i
  KeptPair slave{};                  ///< tangents of the slave in the basis at xi, xi^i
  KeptPair axes{};                   ///< axes of adhesion, xi^i; none without directions
  double spin{0.0};                  ///< turn of the slave against the master in the last slip
  double turn{0.0};                  ///< last turn of normal, axes or slave: the largest angle
  double gap{0.0};                   ///< xi^3 less the offset
  double pressure{0.0};              ///< N
  double slip_accumulated{0.0};      ///< length of the sliding path
  double dissipation{0.0};           ///< by friction, per area
  double dissipation_viscous{0.0};   ///< by the viscosity of the laws, per area
  double energy_adhesion{0.0};       ///< elastic energy of the tangential law, per area; not a
                                     ///< number where the law stores none, as what is viscous
  double energy_normal{0.0};         ///< elastic energy of the normal law, per area
  double offset{0.0};                ///< gap at which the surfaces count as touching
  double multiplier{0.0};  ///< N at no gap: the normal multiplier of an augmented Lagrangian
  std::int64_t status{0};
  std::int64_t facet{-1};  ///< facet of a meshed master; -1 on an analytic one
};

inline bool has_pair(const KeptPair& p) { return p != KeptPair{}; }

/// What a point keeps whatever happens to it.
inline PointState lasting(const PointState& old) {
  PointState s;
  s.slip_accumulated = old.slip_accumulated;
  s.dissipation = old.dissipation;
  s.dissipation_viscous = old.dissipation_viscous;
  s.offset = old.offset;
  s.multiplier = old.multiplier;
  return s;
}

}  // namespace anisocontact::kernel
