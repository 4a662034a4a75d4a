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

/// N at the end of a step; zero where there is a gap or the law would pull. A multiplier is added
/// to what a law without time gives: N = <lambda - eps_N g> [Alart Curnier 1991].
/// `dt` is the time that the law acts, in numbers or in S.
template <class S, class Time>
S pressure(const NormalModel& m, const S& gap, double gap_n, double pressure_n, const Time& dt,
           double multiplier = 0.0) {
  if (!(value(gap) < 0.0) && !(multiplier > 0.0)) return S(0.0);
  const double from = std::min(gap_n, 0.0);
  const S n =
      (S(m.w * pressure_n) + S(m.b) * (gap - S(from)) + S(dt * m.c) * gap) / S(m.w + dt * m.a) +
      S(multiplier);
  return value(n) > 0.0 ? n : S(0.0);
}

/// N = -eps_N g [Konyukhov Schweizerhof 2006, eq. (12) integrated; (11) with the sign of the
/// force].
class Penalty {
 public:
  static Descriptor describe() {
    return {
        "penalty",
        "Pressure proportional to the penetration.",
        {{"penalty", Kind::scalar, "stress/length", "normal stiffness eps_N", Bound::positive}}};
  }
  static Penalty make(const Values& v) {
    Penalty p;
    p.model_ = {0.0, 1.0, 0.0, -v.scalar("penalty")};
    return p;
  }
  const NormalModel& model() const { return model_; }

 private:
  NormalModel model_;
};

/// Spring and dashpot side by side, T without pull: N = -(k g + eta dg/dt) >= 0.
class NormalKelvinVoigt {
 public:
  static Descriptor describe() {
    return {
        "kelvin-voigt",
        "Spring and dashpot side by side; the contact opens where they would pull.",
        {{"stiffness", Kind::scalar, "stress/length", "stiffness of the spring", Bound::positive},
         {"viscosity", Kind::scalar, "stress*time/length", "viscosity of the dashpot",
          Bound::non_negative}}};
  }
  /// With w = 0 and a = 1 backward Euler divides by dt, so b stands for b dg/dt.
  static NormalKelvinVoigt make(const Values& v) {
    NormalKelvinVoigt p;
    p.model_ = {0.0, 1.0, -v.scalar("viscosity"), -v.scalar("stiffness")};
    return p;
  }
  const NormalModel& model() const { return model_; }

 private:
  NormalModel model_;
};

/// Spring and dashpot in series: dN/dt + N/tau = -k dg/dt.
class NormalMaxwell {
 public:
  static Descriptor describe() {
    return {
        "maxwell",
        "Spring and dashpot in series; the pressure relaxes to zero.",
        {{"stiffness", Kind::scalar, "stress/length", "stiffness of the spring", Bound::positive},
         {"relaxation_time", Kind::scalar, "time", "relaxation time", Bound::positive}}};
  }
  static NormalMaxwell make(const Values& v) {
    NormalMaxwell p;
    p.model_ = {1.0, 1.0 / v.scalar("relaxation_time"), -v.scalar("stiffness"), 0.0};
    return p;
  }
  const NormalModel& model() const { return model_; }

 private:
  NormalModel model_;
};

/// A spring beside a Maxwell element: dN/dt + N/tau = -(k + k_1) dg/dt - (k/tau) g.
class NormalStandardLinearSolid {
 public:
  static Descriptor describe() {
    return {"standard-linear-solid",
            "A spring beside a Maxwell element; the pressure relaxes to the spring's.",
            {{"stiffness", Kind::scalar, "stress/length", "stiffness of the spring, at rest",
              Bound::positive},
             {"stiffness_maxwell", Kind::scalar, "stress/length",
              "stiffness of the Maxwell element, which relaxes", Bound::positive},
             {"relaxation_time", Kind::scalar, "time", "relaxation time", Bound::positive}}};
  }
  static NormalStandardLinearSolid make(const Values& v) {
    const double k = v.scalar("stiffness"), tau = v.scalar("relaxation_time");
    NormalStandardLinearSolid p;
    p.model_ = {1.0, 1.0 / tau, -k - v.scalar("stiffness_maxwell"), -k / tau};
    return p;
  }
  const NormalModel& model() const { return model_; }

 private:
  NormalModel model_;
};

/// The general law dN/dt + a N = -b dg/dt - c g [Konyukhov Schweizerhof 2006, eq. (27)].
class NormalGeneral {
 public:
  static Descriptor describe() {
    return {"general-linear",
            "dN/dt + a N = -b dg/dt - c g, eq. (27) with positive b and c.",
            {{"a", Kind::scalar, "1/time", "relaxation", Bound::non_negative},
             {"b", Kind::scalar, "stress/length", "instantaneous stiffness", Bound::positive},
             {"c", Kind::scalar, "stress/length/time", "stiffness rate", Bound::non_negative}}};
  }
  static NormalGeneral make(const Values& v) {
    NormalGeneral p;
    p.model_ = {1.0, v.scalar("a"), -v.scalar("b"), -v.scalar("c")};
    return p;
  }
  const NormalModel& model() const { return model_; }

 private:
  NormalModel model_;
};

}  // namespace anisocontact::law
