#pragma once
// Maximum dissipation: slip normal to the friction ellipse, K = F.

#include "anisocontact/law/rules/normality.hpp"

namespace anisocontact::law {

/// Associated slip rule [Konyukhov Schweizerhof 2006, section 4.1 a)-d)], backward Euler.
class MaximumDissipation : public Normality<MaximumDissipation> {
 public:
  static Descriptor describe() {
    return {"maximum-dissipation",
            "Slip normal to the friction ellipse (associated); backward Euler. Converges as the "
            "increments are refined.",
            {}};
  }
  static MaximumDissipation make(const Values&) { return {}; }

  template <class S>
  ContraContra<S> conjugate(const SlideProblem<S>& p) const {
    return p.friction;
  }
};

}  // namespace anisocontact::law
