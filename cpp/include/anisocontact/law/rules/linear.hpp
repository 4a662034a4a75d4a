#pragma once
// Force linear in the direction of slip: K = F^(1/2).

#include "anisocontact/law/rules/normality.hpp"

namespace anisocontact::law {

/// K = F^(1/2), the root taken in mixed components (f^ik a_kj): in steady slip along v the force is
/// -N F^(-1/2) v/|v|, linear in the direction of slip [Zmitrowicz 1981; He and Curnier 1993].
class LinearRule : public Normality<LinearRule> {
 public:
  static Descriptor describe() {
    return {"linear",
            "Force linear in the direction of slip, T = -N F^(-1/2) v/|v|: slip normal to the "
            "ellipse of F^(1/2) (Zmitrowicz; He and Curnier).",
            {}};
  }
  static LinearRule make(const Values&) { return {}; }

  template <class S>
  ContraContra<S> conjugate(const SlideProblem<S>& p) const {
    return square_root(p.friction * p.a_co) * inverse(p.a_co);
  }
};

}  // namespace anisocontact::law
