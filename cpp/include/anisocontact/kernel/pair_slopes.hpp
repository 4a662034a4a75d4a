#pragma once
// Derivatives at a slave point as sums of directions times linear forms: few forms carry everything.

#include "anisocontact/kernel/forms.hpp"

namespace anisocontact::kernel {

/// A linear form in the slave point, and in position and tangents of the master: the first inputs.
struct Near {
  static constexpr std::size_t inputs = 4;
  std::array<Padded, inputs> by;

  void add(double k, const Near& f) {
    for (std::size_t i = 0; i < inputs; ++i) by[i].add(k, f.by[i]);
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
  Eigen::Matrix3d by_slip;  ///< of the traction, see `slip_slopes`

  Near& form(NearForm f, std::size_t k = 0) { return near[static_cast<std::size_t>(f) + k]; }
  Vec3<double>& direction(std::size_t acts, NearForm f, std::size_t k = 0) {
    return along[acts][static_cast<std::size_t>(f) + k];
  }
  /// Writes a form: what it has of the inputs, and through the coordinates of the projection.
  void put(NearForm f, std::size_t k, const std::array<Padded, Near::inputs>& direct,
           const std::array<double, 2>& by_xi) {
    Near& to = form(f, k);
    for (std::size_t i = 0; i < Near::inputs; ++i)
      to.by[i] = direct[i] + by_xi[0] * near[0].by[i] + by_xi[1] * near[1].by[i];
  }
  /// |dt/dx|, of the traction by the slave point.
  double size() const {
    constexpr std::size_t x = 0, gap = static_cast<std::size_t>(NearForm::gap);
    const auto& t = along_friction[0];
    const auto& u = along[0];
    double squares = 0.0;
    each<3>([&](auto i) ANISOCONTACT_INLINE_LAMBDA {
      const auto k = static_cast<Eigen::Index>(i);
      const Padded row = t[0][k] * friction[0].by[x] + t[1][k] * friction[1].by[x] +
                         u[gap][k] * near[gap].by[x] + u[gap + 1][k] * near[gap + 1].by[x] +
                         u[gap + 2][k] * near[gap + 2].by[x];
      squares += row.vector().squaredNorm();
    });
    return std::sqrt(squares);
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
