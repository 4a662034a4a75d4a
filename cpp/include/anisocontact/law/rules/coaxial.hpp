#pragma once
// Slip collinear with the force: K = I.

#include "anisocontact/law/rules/normality.hpp"

namespace anisocontact::law {

/// K^ij = a^ij: the force opposes the slip, its size is that of the friction ellipse.
class Coaxial : public Normality<Coaxial> {
 public:
  static Descriptor describe() {
    return {
        "coaxial",
        "Slip collinear with the force; the friction ellipse gives the size of the force alone.",
        {}};
  }
  static Coaxial make(const Values&) { return {}; }

  template <class S>
  ContraContra<S> conjugate(const SlideProblem<S>& p) const {
    return inverse(p.a_co);
  }
};

}  // namespace anisocontact::law
