#pragma once
// Whether a linear model w = 1 in time can create energy. With f = -T, S = -B and R = -C it reads
// df/dt + A f = S v + R x, dx/dt = v. It takes the power f . v, and is passive if no path from rest
// gives back more than was put in. By the positive real lemma [Anderson Vongpanitlerd 1973, sec. 5]
// there is then an energy E(x, f) >= 0 with dE/dt <= f . v. From dE/dt = f . v in the instant, E =
// 1/2 x.K x + 1/2 f_1.K_1^-1 f_1 with f_1 = f - K x, K_1 = S - K: a spring K beside Maxwell elements
// K_1, which lose f_1.K_1^-1 A f_1 per time. So the model is passive if and only if it is such a pair:
//   A K = R with symmetric K and S, K >= 0, K_1 >= 0 and the symmetric part of A K_1 >= 0.

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "anisocontact/law/linear_model.hpp"

namespace anisocontact::law {

/// Refuses a model that can create energy. Numbers count as equal to six digits of the largest entry
/// of their tensors, as many as are written by hand.
class Passivity {
 public:
  explicit Passivity(const LinearModel& m) : m_(m), s_(detail::combined(-1.0, m.b, 0.0, m.b)) {}

  void require() const {
    using namespace detail;
    symmetric("stiffness_instant: S", s_, "fast");
    const auto k = stiffness_at_rest(m_);
    const double stiffness = same_ * largest(s_), rate = same_ * largest(m_.a) * largest(s_);
    if (!k || largest(combined(1.0, product(m_.a, *k), 1.0, m_.c)) > rate)
      refuse("stiffness_rate: this singular A leaves no stiffness at rest K with A K = R",
             "held, the force would grow without end");
    not_below("stiffness_rate: the stiffness at rest A^-1 R", *k, stiffness,
              "held, the force would push along the slip and create energy");
    symmetric("stiffness_rate: the stiffness at rest A^-1 R", *k, "slow");
    const AxesMatrix k1 = combined(1.0, s_, -1.0, *k);
    not_below("stiffness_rate: what relaxes, S - A^-1 R,", k1, stiffness,
              "held, the force would grow and create energy");
    not_below("relaxation: the symmetric part of A S - R", product(m_.a, k1), rate,
              "fast slip to and fro would create energy");
  }

 private:
  static constexpr double same_ = 1e-6;

  [[noreturn]] static void refuse(const std::string& what, const std::string& why) {
    throw std::invalid_argument(what + ": " + why +
                                "; energy = \"none\" takes such tensors and tells no energy");
  }
  static void not_below(const std::string& what, const AxesMatrix& m, double zero,
                        const std::string& why) {
    const double least = detail::least_eigenvalue(m);
    if (least >= -zero) return;
    std::ostringstream s;
    s << what << " has the eigenvalue " << least << ", must be >= 0";
    refuse(s.str(), why);
  }
  void symmetric(const std::string& what, const AxesMatrix& m, const std::string& pace) const {
    if (std::abs(m[0][1] - m[1][0]) <= same_ * detail::largest(s_)) return;
    std::ostringstream s;
    s << what << " has " << m[0][1] << " and " << m[1][0]
      << " beside the diagonal, must be symmetric";
    refuse(s.str(), pace + " slip in a circle would create energy");
  }

  const LinearModel& m_;
  AxesMatrix s_;
};

}  // namespace anisocontact::law
