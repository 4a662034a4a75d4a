#pragma once
// A rule that is not in the core: the tests add it and look whether everything follows.

#include "anisocontact/law/rules/normality.hpp"

namespace anisocontact::law {

/// Between `maximum-dissipation` and `coaxial`: K^ij = (1 - w) f^ij + w tr(F)/2 a^ij.
class Toy : public Normality<Toy> {
 public:
  static Descriptor describe() {
    return {"toy",
            "Slip normal to a mean of the friction ellipse and a circle.",
            {{"weight", Kind::scalar, "1", "weight of the circle", Bound::non_negative}}};
  }
  static Toy make(const Values& v) {
    Toy t;
    t.weight_ = v.scalar("weight");
    return t;
  }

  template <class S>
  ContraContra<S> conjugate(const SlideProblem<S>& p) const {
    const S w(weight_), half(0.5);
    return (S(1.0) - w) * p.friction + (w * half * trace(p.friction * p.a_co)) * inverse(p.a_co);
  }

 private:
  double weight_{0.0};
};

}  // namespace anisocontact::law
