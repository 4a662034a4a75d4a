#pragma once
// The sliding rules by themselves for many points: trial force to force, without a surface.

#include "anisocontact/law/registry.hpp"

namespace anisocontact::law {

/// Inputs of a batch of slides; what is left out is null.
struct SlideInput {
  const double *stiffness, *friction, *trial, *pressure;
  const double *metric, *axes, *increment;

  SlideProblem<double> problem(std::size_t i) const {
    SlideProblem<double> p;
    for (std::size_t k = 0; k < 4; ++k) {
      p.stiffness(k / 2, k % 2) = stiffness[4 * i + k];
      p.friction(k / 2, k % 2) = friction[4 * i + k];
      p.a_co(k / 2, k % 2) = metric ? metric[4 * i + k] : unit_[k];
      p.axes[k / 2][k % 2] = axes ? axes[4 * i + k] : unit_[k];
    }
    p.trial = {{trial[2 * i], trial[2 * i + 1]}};
    p.pressure = pressure[i];
    p.increment = increment ? Vector<double>{{increment[2 * i], increment[2 * i + 1]}}
                            : -slip_from_force(p, p.trial);
    p.elastic = p.increment;
    return p;
  }

 private:
  static constexpr std::array<double, 4> unit_{1.0, 0.0, 0.0, 1.0};
};

struct SlideOutput {
  double *traction, *stored, *slip, *d_trial, *d_pressure;
  bool *slides, *converged;
};

struct SlideBatch {
  SlideInput in;
  SlideOutput out;
};

/// What a rule makes of the trial forces of points [first, last); compiled with the laws.
void slide(const AnyRule& rule, const SlideBatch& batch, std::size_t first, std::size_t last,
           bool with_tangent) noexcept;

}  // namespace anisocontact::law
