#pragma once
// The couple of friction. It acts at the slave point x and, the other way, at the foot rho of the
// master, so that its moments differ by (x - rho) x T. The master's facet carries x - rho,
//   x - rho = c^j rho_j + c n_f,
// and the virtual work of friction takes the change of that off:
//   T . (delta x - delta rho - delta(x - rho)) = T . (delta x - delta rho) + m_j . delta rho_j,
//   m_j = c (T . rho^j) n_f - c^j T ,
// which is none where both bodies turn together. Inside a facet c^j = 0, c = g, and it is T_i times
// a^ij [(delta x - delta rho) . rho_j + g n . delta rho_j]: the variation of the coordinates of the
// projection [Konyukhov Schweizerhof 2006, eq. (4)], in the metric at xi^3 = 0.

#include "anisocontact/kernel/facet_frame.hpp"

namespace anisocontact::kernel {

class Couple {
 public:
  Couple(const FacetFrame& frame, const Vec3<double>& friction) noexcept
      : frame_(frame),
        normal_(frame.facet().normal),
        friction_(friction),
        dual_{frame.facet().dual_basis(0), frame.facet().dual_basis(1)},
        above_(frame.plane.apart.dot(normal_)) {
    for (std::size_t j = 0; j < 2; ++j) {
      upper_[j] = friction.dot(dual_[j]);
      beside_[j] = frame.interior() ? 0.0 : frame.plane.apart.dot(dual_[j]);
    }
  }

  /// m_j.
  Vec3<double> on_tangent(std::size_t j) const {
    return above_ * upper_[j] * normal_ - beside_[j] * friction_;
  }

  /// Writes d m_j with the components of T; d xi and nu_a are there already.
  void differentiate(const Flat& force, PairSlopes& d) const noexcept {
    if (!frame_.interior())
      for (std::size_t k = 0; k < 2; ++k) bend(k, d);
    for (std::size_t j = 0; j < 2; ++j) {
      lift(j, d);
      if (frame_.interior())
        inside(j, d);
      else
        beside(j, force, d);
    }
  }

 private:
  /// n_f . d rho_k.
  void bend(std::size_t k, PairSlopes& d) const {
    std::array<Padded, Near::inputs> direct;
    direct[tangent_input(k)] = normal_;
    d.put(NearForm::bend, k, direct,
          {normal_.dot(frame_.second(k, 0)), normal_.dot(frame_.second(k, 1))});
  }
  /// Of k_m rho^j . d rho_m, by the coordinates of the projection.
  Flat stretch(const Flat& k, std::size_t j) const {
    const double mixed = dual_[j].dot(frame_.second(0, 1));
    return {k[0] * dual_[j].dot(frame_.second(0, 0)) + k[1] * mixed,
            k[0] * mixed + k[1] * dual_[j].dot(frame_.second(1, 1))};
  }

  /// What d (c T . rho^j) has besides c rho^j . dT, with dc = n_f . d(x - rho) - c^k n_f . d rho_k
  /// and T . d rho^j = - (rho^j . d rho_k) T^k + a^jk (T . n_f) (n_f . d rho_k).
  void lift(std::size_t j, PairSlopes& d) const {
    const Padded rise = upper_[j] * normal_, dual = dual_[j];
    const Flat k{-above_ * upper_[0], -above_ * upper_[1]};
    d.put(NearForm::lift, j, {{rise, -rise, k[0] * dual, k[1] * dual}}, stretch(k, j));
    d.direction(1 + j, NearForm::lift, j) = normal_;
    if (frame_.interior()) return;
    const double out = friction_.dot(normal_);
    for (std::size_t m = 0; m < 2; ++m)
      d.form(NearForm::lift, j)
          .add(above_ * frame_.facet().a_contra(j, m) * out - upper_[j] * beside_[m],
               d.form(NearForm::bend, m));
  }

  void inside(std::size_t j, PairSlopes& d) const {
    for (std::size_t a = 0; a < 2; ++a) {
      d.along_friction[1 + j][a] = above_ * frame_.plane.t[a].dot(dual_[j]) * normal_;
      d.direction(1 + j, NearForm::turn, a) = above_ * upper_[j] * frame_.plane.t[a];
    }
  }

  /// On edges and vertices: dT = t_a (t_a . dT) - n T_a nu_a has a part along n_f, the facet turns
  /// unlike n, and there is d (c^j T).
  void beside(std::size_t j, const Flat& force, PairSlopes& d) const {
    const Vec3<double>& n = frame_.plane.n;
    for (std::size_t a = 0; a < 2; ++a) {
      const Vec3<double>& t = frame_.plane.t[a];
      d.along_friction[1 + j][a] = above_ * t.dot(dual_[j]) * normal_ - beside_[j] * t;
      d.direction(1 + j, NearForm::turn, a) =
          force[a] * (beside_[j] * n - above_ * n.dot(dual_[j]) * normal_);
      d.direction(1 + j, NearForm::bend, a) = -above_ * upper_[j] * dual_[a];
    }
    const Padded dual = dual_[j];
    const Flat k{-beside_[0], -beside_[1]};
    Flat by_xi = stretch(k, j);
    by_xi[j] -= 1.0;
    d.put(NearForm::beside, j, {{dual, -dual, k[0] * dual, k[1] * dual}}, by_xi);  // d c^j
    for (std::size_t m = 0; m < 2; ++m)
      d.form(NearForm::beside, j)
          .add(above_ * frame_.facet().a_contra(j, m), d.form(NearForm::bend, m));
    d.direction(1 + j, NearForm::beside, j) = -friction_;
  }

  const FacetFrame& frame_;
  Vec3<double> normal_, friction_;
  std::array<Vec3<double>, 2> dual_;
  double above_;
  std::array<double, 2> upper_{}, beside_{};  ///< T . rho^j and c^j
};

}  // namespace anisocontact::kernel
