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

#include "anisocontact/kernel/footing.hpp"

namespace anisocontact::kernel {

class Couple {
 public:
  Couple(const Footing& foot, const Vec3<double>& friction) noexcept
      : foot_(foot),
        normal_(foot.facet().normal),
        friction_(friction),
        dual_{foot.facet().dual_basis(0), foot.facet().dual_basis(1)},
        above_(foot.plane.apart.dot(normal_)) {
    for (std::size_t j = 0; j < 2; ++j) {
      upper_[j] = friction.dot(dual_[j]);
      beside_[j] = foot.interior() ? 0.0 : foot.plane.apart.dot(dual_[j]);
    }
  }

  /// m_j.
  Vec3<double> on_tangent(std::size_t j) const {
    return above_ * upper_[j] * normal_ - beside_[j] * friction_;
  }

  /// d m_j by every input, from the forms of t_a . dT.
  void differentiate(const Flat& force, const std::array<Form, 2>& friction,
                     std::array<std::array<Eigen::Matrix3d, inputs>, 2>& out) const noexcept {
    std::array<Form, 2> bend;  // n_f . d rho_k
    for (std::size_t k = 0; k < 2; ++k) {
      add_bend(1.0, k, bend[k]);
      foot_.expand(bend[k]);
    }
    for (std::size_t j = 0; j < 2; ++j) {
      const Form along = along_normal(j, force, friction);
      const double size = above_ * upper_[j];
      for (std::size_t i = 0; i < inputs; ++i) {
        out[j][i] = normal_ * along.by[i].transpose();
        if (i > tangent_input(1)) continue;
        for (std::size_t k = 0; k < 2; ++k)
          out[j][i] -= size * dual_[k] * bend[k].by[i].transpose();
      }
      if (!foot_.interior()) add_beside(j, force, friction, out[j]);
    }
  }

 private:
  /// Adds k n_f . d rho_m.
  void add_bend(double k, std::size_t m, Form& f) const {
    f.by[tangent_input(m)] += k * normal_;
    for (std::size_t l = 0; l < 2; ++l) f.xi[l] += k * normal_.dot(foot_.second(m, l));
  }
  /// Adds k rho^j . d rho_m.
  void add_stretch(double k, std::size_t j, std::size_t m, Form& f) const {
    f.by[tangent_input(m)] += k * dual_[j];
    for (std::size_t l = 0; l < 2; ++l) f.xi[l] += k * dual_[j].dot(foot_.second(m, l));
  }

  /// d (c T . rho^j) with dc = n_f . d(x - rho) - c^k n_f . d rho_k and
  /// T . d rho^j = - (rho^j . d rho_k) T^k + a^jk (T . n_f) (n_f . d rho_k).
  Form along_normal(std::size_t j, const Flat& force, const std::array<Form, 2>& friction) const {
    Form f;
    for (std::size_t a = 0; a < 2; ++a) {
      const double share = above_ * foot_.plane.t[a].dot(dual_[j]);
      for (std::size_t i = 0; i < inputs; ++i) f.by[i] += share * friction[a].by[i];
      for (std::size_t l = 0; l < 2; ++l) {
        f.xi[l] += share * friction[a].xi[l];
        f.turn[l] += share * friction[a].turn[l];
      }
    }
    f[Input::slave] += upper_[j] * normal_;
    f[Input::position] -= upper_[j] * normal_;
    for (std::size_t k = 0; k < 2; ++k) add_stretch(-above_ * upper_[k], j, k, f);
    if (!foot_.interior()) {
      const double lean = above_ * foot_.plane.n.dot(dual_[j]), out = friction_.dot(normal_);
      for (std::size_t k = 0; k < 2; ++k) {
        f.turn[k] -= lean * force[k];
        add_bend(above_ * foot_.facet().a_contra(j, k) * out - upper_[j] * beside_[k], k, f);
      }
    }
    foot_.expand(f);
    return f;
  }

  /// Adds - d (c^j T), beside a facet.
  void add_beside(std::size_t j, const Flat& force, const std::array<Form, 2>& friction,
                  std::array<Eigen::Matrix3d, inputs>& out) const {
    Form shift, fall;  // d c^j and - n . dT
    shift[Input::slave] += dual_[j];
    shift[Input::position] -= dual_[j];
    shift.xi[j] -= 1.0;
    for (std::size_t k = 0; k < 2; ++k) {
      add_stretch(-beside_[k], j, k, shift);
      add_bend(above_ * foot_.facet().a_contra(j, k), k, shift);
    }
    fall.turn = force;
    std::array<Form, 2> level = friction;
    for (Form* f : {&shift, &fall, &level[0], &level[1]}) foot_.expand(*f);
    for (std::size_t i = 0; i < inputs; ++i) {
      out[i] -= friction_ * shift.by[i].transpose();
      for (std::size_t a = 0; a < 2; ++a)
        out[i] -= beside_[j] * foot_.plane.t[a] * level[a].by[i].transpose();
      out[i] += beside_[j] * foot_.plane.n * fall.by[i].transpose();
    }
  }

  const Footing& foot_;
  Vec3<double> normal_, friction_;
  std::array<Vec3<double>, 2> dual_;
  double above_;
  std::array<double, 2> upper_{}, beside_{};  ///< T . rho^j and c^j
};

}  // namespace anisocontact::kernel
