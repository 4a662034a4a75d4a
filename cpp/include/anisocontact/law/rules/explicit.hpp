#pragma once
// The rule of the paper to the letter: the force (96), with a choice of what is remembered.

#include "anisocontact/law/rules/radial.hpp"

namespace anisocontact::law {

/// Force N h/sqrt(h.F h) with h = S^T F T_tr [Konyukhov Schweizerhof 2006, eq. (94)-(99)].
/// The history decides the elastic force that the next step starts from.
class Explicit {
 public:
  /// `centre`: the centre of the adhesion ellipse moves by (114), so the radial return of T_tr is
  /// remembered.
  enum class History { centre };

  Explicit() = default;
  explicit Explicit(History history) : history_(history) {}

  static Descriptor describe() {
    return {"explicit",
            "Force -N BFT_tr/sqrt(BFT_tr.FBFT_tr) of Konyukhov and Schweizerhof, eq. (96).",
            {{"history", Kind::choice, "1", "what is remembered of a sliding step", Bound::any,
              false, {0.0}, {"centre"}}}};
  }
  static Explicit make(const Values& v) {
    return Explicit(static_cast<History>(static_cast<int>(v.scalar("history"))));
  }

  template <class S>
  SlideResult<S> slide(const SlideProblem<S>& p) const noexcept {
    const Covector<S> h = transpose(p.stiffness) * (p.friction * p.trial);
    const Covector<S> t = (p.pressure / friction_norm(p.friction, h)) * h;
    const Covector<S> stored = radial_return(p);
    return {t, stored, slip_from_force(p, stored - p.trial), true};
  }

  /// dT = (N/s)(I - h (x) F h/s^2) S^T F dT_tr + (h/s) dN.
  SlideTangent tangent(const SlideProblem<double>& p, const SlideResult<double>&) const noexcept {
    const CoContra<double> sf = transpose(p.stiffness) * p.friction;
    const Covector<double> h = sf * p.trial;
    const double s = friction_norm(p.friction, h);
    const Covector<double> e = (1.0 / s) * h;
    const CoContra<double> normalised =
        unit<double, Place::co>() - outer(e, p.friction * e);
    return {(p.pressure / s) * (normalised * sf), e};
  }

 private:
  History history_{History::centre};
};

}  // namespace anisocontact::law
