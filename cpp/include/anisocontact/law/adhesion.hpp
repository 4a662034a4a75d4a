#pragma once
// The adhesion models: named members of the linear family, each a choice of w, A, B, C.

#include <stdexcept>

#include "anisocontact/law/passivity.hpp"
#include "anisocontact/registry/descriptor.hpp"

namespace anisocontact::law {

/// Rate-independent adhesion, dT/dt = B v, B = -(eps_1 e_1 (x) e_1 + eps_2 e_2 (x) e_2)
/// [Konyukhov Schweizerhof 2006, eq. (28), (49)].
class Elastic {
 public:
  static Descriptor describe() {
    return {"elastic",
            "Rate-independent elastic adhesion.",
            {{"stiffness", Kind::pair, "stress/length", "tangential stiffness along the two axes",
              Bound::non_negative}}};
  }
  static Elastic make(const Values& v) {
    const auto& e = v.pair("stiffness");
    if (e[0] == 0.0 && e[1] == 0.0)
      throw std::invalid_argument("stiffness: 0 along both axes, one at least must be > 0");
    Elastic m;
    m.model_.b = diagonal(-e[0], -e[1]);
    return m;
  }
  const LinearModel& model() const { return model_; }

 private:
  LinearModel model_;
};

/// Spring and dashpot in series along each axis: dT/dt + T/tau = -k v.
class Maxwell {
 public:
  static Descriptor describe() {
    return {
        "maxwell",
        "Spring and dashpot in series along each axis; the force relaxes to zero.",
        {{"stiffness", Kind::pair, "stress/length", "stiffness of the springs", Bound::positive},
         {"relaxation_time", Kind::pair, "time", "relaxation times along the two axes",
          Bound::positive}}};
  }
  static Maxwell make(const Values& v) {
    const auto &k = v.pair("stiffness"), &tau = v.pair("relaxation_time");
    Maxwell m;
    m.model_.a = diagonal(1.0 / tau[0], 1.0 / tau[1]);
    m.model_.b = diagonal(-k[0], -k[1]);
    return m;
  }
  const LinearModel& model() const { return model_; }

 private:
  LinearModel model_;
};

/// Spring and dashpot side by side along each axis: T = -k xi_el - eta v.
class KelvinVoigt {
 public:
  static Descriptor describe() {
    return {"kelvin-voigt",
            "Spring and dashpot side by side along each axis.",
            {{"stiffness", Kind::pair, "stress/length", "stiffness of the springs",
              Bound::non_negative},
             {"viscosity", Kind::pair, "stress*time/length", "viscosity of the dashpots",
              Bound::positive}}};
  }
  static KelvinVoigt make(const Values& v) {
    const auto &k = v.pair("stiffness"), &eta = v.pair("viscosity");
    KelvinVoigt m;
    m.model_.w = 0.0;
    m.model_.a = diagonal(1.0, 1.0);
    m.model_.b = diagonal(-eta[0], -eta[1]);
    m.model_.c = diagonal(-k[0], -k[1]);
    return m;
  }
  const LinearModel& model() const { return model_; }

 private:
  LinearModel model_;
};

/// A spring beside a Maxwell element along each axis:
/// dT/dt + T/tau = -(k + k_1) v - (k/tau) xi_el.
class StandardLinearSolid {
 public:
  static Descriptor describe() {
    return {"standard-linear-solid",
            "A spring beside a Maxwell element along each axis; the force relaxes to the spring's.",
            {{"stiffness", Kind::pair, "stress/length", "stiffness of the springs, at rest",
              Bound::positive},
             {"stiffness_maxwell", Kind::pair, "stress/length",
              "stiffness of the Maxwell elements, which relaxes", Bound::positive},
             {"relaxation_time", Kind::pair, "time", "relaxation times along the two axes",
              Bound::positive}}};
  }
  static StandardLinearSolid make(const Values& v) {
    const auto &k = v.pair("stiffness"), &k1 = v.pair("stiffness_maxwell"),
               &tau = v.pair("relaxation_time");
    StandardLinearSolid m;
    m.model_.a = diagonal(1.0 / tau[0], 1.0 / tau[1]);
    m.model_.b = diagonal(-k[0] - k1[0], -k[1] - k1[1]);
    m.model_.c = diagonal(-k[0] / tau[0], -k[1] / tau[1]);
    return m;
  }
  const LinearModel& model() const { return model_; }

 private:
  LinearModel model_;
};

/// The general model dT/dt + A T = B v + C xi_el with full tensors
/// [Konyukhov Schweizerhof 2006, eq. (26)].
class GeneralLinear {
 public:
  static Descriptor describe() {
    const std::string form = ", 2 x 2 along the axes, row by row";
    const std::vector<double> unit{1.0, 0.0, 0.0, 1.0};
    const auto full = [&](const char* name, const char* dimension, const char* doc) {
      return Parameter{name, Kind::array, dimension, doc + form, Bound::any, true, {}, {}, unit};
    };
    Parameter rate = full("stiffness_rate", "stress/length/time", "R = -C");
    rate.required = false;
    rate.fallback = {0.0, 0.0, 0.0, 0.0};
    return {"general-linear",
            "dT/dt + A T = -S v - R xi_el with full tensors A, S = -B, R = -C, eq. (26).",
            {full("relaxation", "1/time", "A"),
             full("stiffness_instant", "stress/length", "S = -B, positive definite"),
             rate,
             {"energy",
              Kind::choice,
              "1",
              "stored: the tensors must be passive, so that they store an energy and create none; "
              "none: others are taken too, and no energy is told",
              Bound::any,
              false,
              {0.0},
              {"stored", "none"}}}};
  }
  static GeneralLinear make(const Values& v) {
    GeneralLinear m;
    m.model_.a = matrix(v, "relaxation", 1.0);
    m.model_.b = matrix(v, "stiffness_instant", -1.0);
    m.model_.c = matrix(v, "stiffness_rate", -1.0);
    m.model_.stores = !v.has("energy") || v.scalar("energy") == 0.0;
    if (!(detail::least_eigenvalue(detail::combined(-1.0, m.model_.b, 0.0, m.model_.b)) > 0.0))
      throw std::invalid_argument("stiffness_instant: its symmetric part is not positive definite");
    if (const double least = detail::least_real_part(m.model_.a);
        !(least >= -1e-9 * detail::largest(m.model_.a)))
      throw std::invalid_argument("relaxation: has an eigenvalue with the real part " +
                                  std::to_string(least) + ", must be >= 0");
    if (m.model_.stores) Passivity(m.model_).require();
    return m;
  }
  const LinearModel& model() const { return model_; }

 private:
  static AxesMatrix matrix(const Values& v, const std::string& name, double sign) {
    const auto& l = v.list(name);
    if (l.size() != 4)
      throw std::invalid_argument(name + ": " + std::to_string(l.size()) +
                                  " values given, 4 needed (2 x 2, row by row)");
    return {{{sign * l[0], sign * l[1]}, {sign * l[2], sign * l[3]}}};
  }
  LinearModel model_;
};

}  // namespace anisocontact::law
