#pragma once
// Non-associated slip rule: normal to an ellipse of its own, measured apart from the friction one.

#include <cmath>

#include "anisocontact/law/rules/normality.hpp"
#include "anisocontact/law/thinness.hpp"

namespace anisocontact::law {

/// K = d_1 (x) d_1/k_1^2 + d_2 (x) d_2/k_2^2: slip normal to (T_1/k_1)^2 + (T_2/k_2)^2 = const
/// [Michalowski and Mroz 1978]. d_1 is the first friction axis turned towards the second, d_2 normal
/// to it: axes that a mirror makes left-handed have the mirrored ellipse.
class SlipEllipse : public Normality<SlipEllipse> {
 public:
  static Descriptor describe() {
    return {"slip-ellipse",
            "Slip normal to a second ellipse with semi-axes k1, k2 (Michalowski and Mroz); "
            "maximum-dissipation where it is similar to the friction ellipse.",
            {{"slip_axes", Kind::pair, "1",
              "semi-axes k1, k2 of the slip ellipse; their ratio counts", Bound::positive},
             {"slip_angle",
              Kind::scalar,
              "angle",
              "angle from the first friction axis, towards the second, to the first axis of the "
              "slip ellipse",
              Bound::any,
              false,
              {0.0}}}};
  }
  static SlipEllipse make(const Values& v) {
    const auto& k = v.pair("slip_axes");
    refuse_thin("slip_axes", k[0], k[1], "");
    const double angle = v.scalar("slip_angle");
    SlipEllipse r;
    r.axis_ = {std::cos(angle), std::sin(angle)};
    r.weight_ = {1.0, (k[0] / k[1]) * (k[0] / k[1])};
    return r;
  }

  template <class S>
  ContraContra<S> conjugate(const SlideProblem<S>& p) const {
    using std::sqrt;
    const Vector<S>& e = p.axes[0];
    // the second friction axis may be oblique: what is normal to the first counts
    const Vector<S> across = p.axes[1] - dot(p.a_co * e, p.axes[1]) * e;
    const Vector<S> f = (S(1.0) / sqrt(dot(p.a_co * across, across))) * across;
    const Vector<S> d1 = axis_[0] * e + axis_[1] * f;
    const Vector<S> d2 = axis_[0] * f - axis_[1] * e;
    return weight_[0] * outer(d1, d1) + weight_[1] * outer(d2, d2);
  }

 private:
  std::array<double, 2> axis_{1.0, 0.0}, weight_{1.0, 1.0};
};

}  // namespace anisocontact::law
