#pragma once
// Radial return: the force keeps the direction of the trial force.

#include "anisocontact/law/slide.hpp"

namespace anisocontact::law {

/// N T_tr / sqrt(T_tr . F T_tr), and its tangent.
template <class S>
Covector<S> radial_return(const SlideProblem<S>& p) {
  return (p.pressure / friction_norm(p.friction, p.trial)) * p.trial;
}

class Radial {
 public:
  static Descriptor describe() {
    return {"radial", "Force collinear with the trial force: N T_tr/sqrt(T_tr.F T_tr).", {}};
  }
  static Radial make(const Values&) { return {}; }

  template <class S>
  SlideResult<S> slide(const SlideProblem<S>& p) const noexcept {
    const Covector<S> t = radial_return(p);
    return {t, t, slip_from_force(p, t - p.trial), true};
  }

  SlideTangent tangent(const SlideProblem<double>& p, const SlideResult<double>&) const noexcept {
    const double r = friction_norm(p.friction, p.trial);
    const Vector<double> n = (1.0 / r) * (p.friction * p.trial);
    const Covector<double> e = (1.0 / r) * p.trial;
    return {p.pressure / r * (unit<double, Place::co>() - outer(e, n)), e};
  }

  template <std::size_t N>
  TensorTangent<N> tensor_tangent(const SlideProblem<double>& p, const SlideResult<double>& r,
                                  const SlideTangent& t,
                                  const SlideProblem<Dual<N>>& d) const noexcept {
    TensorTangent<N> out;
    for (std::size_t k = 0; k < N; ++k)
      out[k] =
          equivalent_pressure(derivative(d.friction, k), r.traction, p.pressure) * t.d_pressure;
    return out;
  }
};

}  // namespace anisocontact::law
