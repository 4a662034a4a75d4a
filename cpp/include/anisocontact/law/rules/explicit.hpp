#pragma once
// The rule of the paper to the letter: the force (96), with a choice of what is remembered.

#include <cmath>

#include "anisocontact/law/rules/radial.hpp"

namespace anisocontact::law {

/// Force N h/sqrt(h.F h) with h = S^T F T_tr [Konyukhov Schweizerhof 2006, eq. (94)-(99)].
/// The history decides the elastic force that the next step starts from.
class Explicit {
 public:
  /// `centre`: the centre of the adhesion ellipse moves by (114), so that the radial return of T_tr
  /// is remembered. `incremental`: the force itself, (112). `kuhn-tucker`: what is left after a slip
  /// along the increment, (102)-(111).
  enum class History { centre, incremental, kuhn_tucker };

  Explicit() = default;
  explicit Explicit(History history) : history_(history) {}

  static Descriptor describe() {
    return {"explicit",
            "Force -N BFT_tr/sqrt(BFT_tr.FBFT_tr) of Konyukhov and Schweizerhof, eq. (96).",
            {{"history",
              Kind::choice,
              "1",
              "what is remembered of a sliding step; incremental does not converge",
              Bound::any,
              false,
              {0.0},
              {"centre", "incremental", "kuhn-tucker"}}}};
  }
  static Explicit make(const Values& v) {
    return Explicit(static_cast<History>(static_cast<int>(v.scalar("history"))));
  }

  template <class S>
  SlideResult<S> slide(const SlideProblem<S>& p) const noexcept {
    const Covector<S> h = transpose(p.stiffness) * (p.friction * p.trial);
    const S norm = friction_norm(p.friction, h);
    SlideResult<S> r;
    r.converged = value(norm) > 0.0;  // in the strip F T_tr may lie along it
    r.traction = (p.pressure / norm) * h;
    if (history_ == History::kuhn_tucker && slip_along_increment(p, r)) return r;
    r.stored = history_ == History::incremental ? r.traction : radial_return(p);
    r.slip = slip_from_force(p, r.stored - p.trial);
    return r;
  }

  /// dT = (N/s)(I - h (x) F h/s^2) S^T F dT_tr + (h/s) dN, whatever the history.
  SlideTangent tangent(const SlideProblem<double>& p, const SlideResult<double>&) const noexcept {
    const CoContra<double> sf = transpose(p.stiffness) * p.friction;
    const Covector<double> h = sf * p.trial;
    const double s = friction_norm(p.friction, h);
    const Covector<double> e = (1.0 / s) * h;
    const CoContra<double> normalised = unit<double, Place::co>() - outer(e, p.friction * e);
    return {(p.pressure / s) * (normalised * sf), e};
  }

  /// Of T = N h/s by h, and by F in s.
  template <std::size_t N>
  TensorTangent<N> tensor_tangent(const SlideProblem<double>& p, const SlideResult<double>& r,
                                  const SlideTangent& t,
                                  const SlideProblem<Dual<N>>& d) const noexcept {
    const Covector<double> h = transpose(p.stiffness) * (p.friction * p.trial);
    const double scale = p.pressure / friction_norm(p.friction, h);
    const CoContra<Dual<N>> sf = transpose(d.stiffness) * d.friction;
    const Vector<double> fe = p.friction * t.d_pressure;
    TensorTangent<N> out;
    for (std::size_t k = 0; k < N; ++k) {
      const Covector<double> dh = derivative(sf, k) * p.trial;
      const double dn = equivalent_pressure(derivative(d.friction, k), r.traction, p.pressure);
      out[k] = scale * (dh - dot(dh, fe) * t.d_pressure) + dn * t.d_pressure;
    }
    return out;
  }

 private:
  /// Slip lambda dxi with |T_tr + lambda S dxi|_F = N, the smaller root of (111), whose larger one
  /// would create energy. False where there is none (N has dropped, or dxi leads back): the
  /// return is then radial.
  template <class S>
  static bool slip_along_increment(const SlideProblem<S>& p, SlideResult<S>& r) {
    using std::sqrt;
    const Covector<S> s = p.stiffness * p.increment;
    const Vector<S> fs = p.friction * s;
    const S a = dot(s, fs), b = -dot(p.trial, fs);
    if (!(value(b) > 0.0)) return false;
    // the point of the line that is nearest to zero, and the half chord from there
    const Covector<S> middle = p.trial + (b / a) * s;
    const S chord = (p.pressure * p.pressure - dot(middle, p.friction * middle)) / a;
    if (!(value(chord) > 0.0)) return false;
    const S half = sqrt(chord);
    r.slip = (b / a - half) * p.increment;
    r.stored = middle - half * s;
    return true;
  }

  History history_{History::centre};
};

}  // namespace anisocontact::law
