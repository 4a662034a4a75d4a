#pragma once
// Friction tensors: what the yield ellipse T . F T = N^2 is built from.

#include <array>

#include "anisocontact/anisotropy/field.hpp"
#include "anisocontact/registry/descriptor.hpp"

namespace anisocontact::law {

/// F = e_1 (x) e_1 / mu_1^2 + e_2 (x) e_2 / mu_2^2 [Konyukhov Schweizerhof 2006, eq. (43), (57)].
class Orthotropic {
 public:
  static Descriptor describe() {
    return {"orthotropic",
            "Two coefficients of friction along two axes.",
            {{"coefficients", Kind::pair, "1", "coefficients of friction along the two axes",
              Bound::positive}}};
  }
  static Orthotropic make(const Values& v) {
    const auto& m = v.pair("coefficients");
    Orthotropic f;
    f.lambda_ = {1.0 / (m[0] * m[0]), 1.0 / (m[1] * m[1])};
    return f;
  }

  template <class S>
  ContraContra<S> tensor(const surface::Geometry<S>& g, const anisotropy::Axes<S>& axes) const {
    return anisotropy::pull_back_contra(g, axes, lambda_);
  }

 private:
  std::array<double, 2> lambda_{1.0, 1.0};
};

}  // namespace anisocontact::law
