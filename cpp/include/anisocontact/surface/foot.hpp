#pragma once
// The closest point of a surface, and how it was found.

#include <array>
#include <cstdint>

namespace anisocontact::surface {

/// How a projection ended.
/// interior:  x - rho is normal to the surface
/// edge:      the nearest point is on an edge, one coordinate is held there
/// corner:    the nearest point is a corner, both coordinates are held there
/// singular:  the nearest point is a pole or an apex, where the coordinates are singular; xi is
///            that of a point beside it, as far as `polar_cap` says
/// ambiguous: no differentiable closest point: others are as near, or x is a centre of curvature;
///            one of them, always the same, is given
/// failed:    none found, or x is not finite
enum class Status : std::int64_t {
  interior = 0,
  edge = 1,
  corner = 2,
  singular = 3,
  ambiguous = 4,
  failed = 5
};

struct Foot {
  std::array<double, 2> xi{0.0, 0.0};
  Status status{Status::failed};
  std::array<bool, 2> fixed{false, false};  ///< coordinates that do not follow x
};

/// Coordinates stay this far from a pole, as a fraction of their range. The closest point moves by
/// 1e-8 of the size and the gap by its square, while derivatives, whose rounding errors grow with
/// the reciprocal, keep seven digits.
inline constexpr double polar_cap = 1e-8;
/// The same where jets are sines and cosines, or a profile whose heights count from its pole, which
/// lose digits of curvatures alone. What is nearest to a point that moves around a pole goes around it
/// at this distance: slips that feel it in a stiff adhesion, where equilibrium is on the pole, let no
/// increment converge at 1e-8.
inline constexpr double fine_polar_cap = 1e-12;

/// 1 - xi^3 kappa (kappa a principal curvature) below which x counts as a centre of curvature: the
/// derivative of the closest point is its reciprocal and has no correct digit much below.
inline constexpr double focal_limit = 1e-12;

}  // namespace anisocontact::surface
