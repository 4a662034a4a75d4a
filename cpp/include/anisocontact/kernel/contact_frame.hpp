#pragma once
// The seam between kinematics and laws: a law sees one contact frame and answers one reaction, with
// the slopes of the tangential force by every number that it depends on. Whoever knows how these
// numbers change with positions has the exact tangent by the chain rule.
//
// The frame t_1, t_2, n is orthonormal and does not spin about n (dt_1 . t_2 = 0), so that a tangent
// vector v has d(v_a) = t_a . dv, and an axis changes by its angle d alpha = (n x e) . de.

#include <array>
#include <optional>

#include "anisocontact/kernel/state.hpp"
#include "anisocontact/tensor/tangent.hpp"

namespace anisocontact::kernel {

/// Components along t_1, t_2.
using Flat = std::array<double, 2>;

/// Numbers that the tangential force depends on. Pairs are components of vectors along t_1, t_2, or
/// the angles of the two axes of a field, of adhesion of those that its tensors have; the connection
/// is row after row.
enum class Slope : std::size_t {
  gap = 0,
  increment = 1,
  stored = 3,
  elastic = 5,
  adhesion = 7,
  friction = 9,
  second = 11,
  connection = 13
};
inline constexpr std::size_t slope_count = 17;

/// History, motion and axes at a point that is in contact.
struct ContactFrame {
  double gap, dt;
  double pressure, d_pressure;        ///< N and dN/dg
  Dual<1> fraction;                   ///< of the step in contact, by the gap
  double real;                        ///< share of the slip in contact that is no multiplier's
  Flat stored, elastic;               ///< committed, turned to here
  Flat increment;                     ///< of the slip over the whole step
  std::array<Flat, 2> adhesion_axes;  ///< unit vectors
  std::array<Flat, 2> friction_axes, second_axes;
  std::array<Flat, 2> rate_axes;  ///< of the tensors of adhesion: halfway, or those of now
  std::optional<CoContra<double>> connection{};  ///< G of the trial; none where history was turned
  bool total{false};  ///< whether the trial force is that of the whole elastic slip
};

/// What a law answers: force, sliding and what is stored, along t_1, t_2.
struct Reaction {
  Flat traction{}, stored{};
  Flat elastic{}, slip{};             ///< elastic slip at the end, sliding increment
  Flat increment{};                   ///< of the slip while in contact
  double dissipation{0.0};            ///< by friction in the step
  double viscous{0.0};                ///< by viscosity in the step
  double energy{0.0};                 ///< elastic energy at the end
  std::array<Flat, slope_count> d{};  ///< by input: d T_1, d T_2
  Contact status{Contact::open};      ///< stick or slip
  Failure failure{Failure::none};

  const Flat& slope(Slope s, std::size_t k) const { return d[static_cast<std::size_t>(s) + k]; }
  Flat& slope(Slope s, std::size_t k) { return d[static_cast<std::size_t>(s) + k]; }
};

/// A tangential law.
class Law {
 public:
  virtual Reaction evaluate(const PointState& committed, const ContactFrame& frame,
                            bool tangent) const noexcept = 0;

 protected:
  Law() = default;
  Law(const Law&) = default;
  Law& operator=(const Law&) = default;
  ~Law() = default;
};

}  // namespace anisocontact::kernel
