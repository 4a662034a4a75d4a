#pragma once
// Normal laws: pressure N >= 0 from the gap, w dN/dt + a N = b dg/dt + c g
// [Konyukhov Schweizerhof 2006, eq. (27)], backward Euler, the contact starting at g = 0.

#include <algorithm>

#include "anisocontact/registry/descriptor.hpp"
#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::law {

struct NormalModel {
  double w{0.0}, a{1.0}, b{0.0}, c{0.0};
};

/// N at the end of a step; zero where there is a gap or the law would pull.
template <class S>
S pressure(const NormalModel& m, const S& gap, double gap_n, double pressure_n, double dt) {
  if (!(value(gap) < 0.0)) return S(0.0);
  const double from = std::min(gap_n, 0.0);
  const S n = (S(m.w * pressure_n) + S(m.b) * (gap - S(from)) + S(dt * m.c) * gap) /
              S(m.w + dt * m.a);
  return value(n) > 0.0 ? n : S(0.0);
}

/// N = -eps_N g [Konyukhov Schweizerhof 2006, eq. (12) integrated; (11) with the sign of the force].
class Penalty {
 public:
  static Descriptor describe() {
    return {"penalty",
            "Pressure proportional to the penetration.",
            {{"penalty", Kind::scalar, "stress/length", "normal stiffness eps_N",
              Bound::positive}}};
  }
  static Penalty make(const Values& v) {
    Penalty p;
    p.model_.c = -v.scalar("penalty");
    return p;
  }
  const NormalModel& model() const { return model_; }

 private:
  NormalModel model_;
};

}  // namespace anisocontact::law
