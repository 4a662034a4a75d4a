#pragma once
// Derivatives at a slave point as sums of directions times linear forms: few forms carry everything.

#include "anisocontact/kernel/forms.hpp"

namespace anisocontact::kernel {

/// A linear form in the slave point, and in position and tangents of the master: the first inputs.
struct Near {
  static constexpr std::size_t inputs = 4;
  std::array<Vec3<double>, inputs> by;

  void clear() { by.fill(Vec3<double>::Zero()); }
  void add(double k, const Near& f) {
    for (std::size_t i = 0; i < inputs; ++i) by[i] += k * f.by[i];
  }
};

/// The forms: d xi^i, dg, nu_a = t_a . dn, and those of the couples. Beside a facet, on edges and
/// vertices, there are more of them.
enum class NearForm : std::size_t { xi = 0, gap = 2, turn = 3, lift = 5, bend = 7, beside = 9 };

/// Derivatives of what acts: 0 the traction, 1 and 2 the couples on the tangents of the master.
struct PairSlopes {
  static constexpr std::size_t acting = 3, near_forms = 11;
  bool interior;
  std::array<Form, 2> friction;  ///< t_a . dT
  std::array<Near, near_forms> near;
  std::array<std::array<Vec3<double>, 2>, acting> along_friction;
  std::array<std::array<Vec3<double>, near_forms>, acting> along;

  Near& form(NearForm f, std::size_t k = 0) { return near[static_cast<std::size_t>(f) + k]; }
  Vec3<double>& direction(std::size_t acts, NearForm f, std::size_t k = 0) {
    return along[acts][static_cast<std::size_t>(f) + k];
  }
  /// Derivative of what acts by an input.
  Eigen::Matrix3d matrix(std::size_t acts, std::size_t input) const {
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    for (std::size_t a = 0; a < 2; ++a)
      m += along_friction[acts][a] * friction[a].by[input].transpose();
    if (input >= Near::inputs) return m;
    for (const std::size_t f : terms(acts))
      if (f < (interior ? first_beside : near_forms))
        m += along[acts][f] * near[f].by[input].transpose();
    return m;
  }

  /// The forms of near that something acting has, those beside a facet last.
  static constexpr std::size_t first_beside = static_cast<std::size_t>(NearForm::bend);
  static constexpr std::array<std::size_t, 6> terms(std::size_t acts) {
    constexpr std::size_t nothing = near_forms;
    if (acts == 0) return {2, 3, 4, nothing, nothing, nothing};
    return {3, 4, 4 + acts, 7, 8, 8 + acts};
  }
};

}  // namespace anisocontact::kernel
