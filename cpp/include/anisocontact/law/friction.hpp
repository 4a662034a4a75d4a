#pragma once
// Friction tensors: what the friction ellipse of the yield function, T . F T = N^2, is built from.

#include <algorithm>
#include <array>
#include <concepts>
#include <sstream>
#include <stdexcept>
#include <string>

#include "anisocontact/anisotropy/field.hpp"
#include "anisocontact/law/thinness.hpp"
#include "anisocontact/registry/descriptor.hpp"

namespace anisocontact::law {

/// Components e_a^i of two axes.
template <class S>
using UpperAxes = std::array<Vector<S>, 2>;

/// A friction model gives f^ij from a^ij and the axes of its direction fields; `second` are those
/// of the second surface, for a model that is built on two. Without friction the ellipse is a point
/// and F infinite: the model says so, and nobody asks it for F.
template <class T>
concept Friction = requires(const T& f, const ContraContra<double>& a, const UpperAxes<double>& e,
                            const ContraContra<Dual<3>>& b, const UpperAxes<Dual<3>>& d) {
  { f.tensor(a, e, e) } -> std::same_as<ContraContra<double>>;
  { f.tensor(b, d, d) } -> std::same_as<ContraContra<Dual<3>>>;
  { f.frictionless() } noexcept -> std::same_as<bool>;
  { T::describe() } -> std::same_as<Descriptor>;
};

/// F = e_1 (x) e_1 / mu_1^2 + e_2 (x) e_2 / mu_2^2 [Konyukhov Schweizerhof 2006, eq. (43), (57)].
class Orthotropic {
 public:
  static Descriptor describe() {
    return {"orthotropic",
            "Two coefficients of friction along two axes.",
            {{"coefficients", Kind::pair, "1",
              "coefficients of friction along the two axes; 0 is contact without friction",
              Bound::non_negative}},
            1};
  }
  /// A force that is limited along one axis and zero along the other has no ellipse.
  static Orthotropic make(const Values& v) {
    const auto& m = v.pair("coefficients");
    Orthotropic f;
    f.frictionless_ = m[0] == 0.0 && m[1] == 0.0;
    if (f.frictionless_) return f;
    if (std::min(m[0], m[1]) < least_) refuse(m[0], m[1]);
    refuse_thin("coefficients", m[0], m[1], "; 1e-3 of the other is nearly none along one axis");
    f.lambda_ = {1.0 / (m[0] * m[0]), 1.0 / (m[1] * m[1])};
    return f;
  }

  bool frictionless() const noexcept { return frictionless_; }

  template <class S>
  ContraContra<S> tensor(const ContraContra<S>&, const UpperAxes<S>& e, const UpperAxes<S>&) const {
    return lambda_[0] * outer(e[0], e[0]) + lambda_[1] * outer(e[1], e[1]);
  }

 private:
  static constexpr double least_ = 1e-100;  // the inverse of its square is a number
  [[noreturn]] static void refuse(double first, double second) {
    std::ostringstream s;
    s << "coefficients: " << first << " and " << second
      << " given, the yield ellipse needs both > 0, or both 0 for contact without friction; 1e-3 "
         "of "
         "the other is nearly none along one axis";
    throw std::invalid_argument(s.str());
  }
  std::array<double, 2> lambda_{1.0, 1.0};
  bool frictionless_{false};
};

static_assert(Friction<Orthotropic>);

/// Two orthotropic surfaces, T = -N C u for the direction of slip u with
/// C = alpha_1 I + alpha_2 m (x) m + alpha_3 k (x) k [He Curnier 1993; Konyukhov Schweizerhof 2006,
/// eq. (30) with constant alpha]; as |u| = 1, the limit is T . C^-2 T = N^2, so F = C^-2. The unit
/// vectors m and k are the first axes of the two surfaces.
class HeCurnier {
 public:
  static Descriptor describe() {
    return {"he-curnier",
            "Friction of two orthotropic surfaces, F = C^-2, C = alpha_1 I + alpha_2 m (x) m + "
            "alpha_3 k (x) k; m and k are the first axes of directions and directions_second.",
            {{"alpha",
              Kind::vector,
              "1",
              "isotropic part, part along the first axis m of the first surface, part along the "
              "first axis k of the second; 0 is contact without friction",
              Bound::any,
              true,
              {},
              {},
              {1.0, 0.0, 0.0}}},
            2};
  }

  /// The eigenvalues of C are alpha_1 + (alpha_2 + alpha_3)/2 +- 1/2 sqrt(alpha_2^2 + alpha_3^2 +
  /// 2 alpha_2 alpha_3 cos 2 theta); over all angles theta of m and k the smallest of them is
  /// alpha_1 + min(alpha_2, 0) + min(alpha_3, 0).
  static HeCurnier make(const Values& v) {
    const auto& a = v.vector("alpha");
    HeCurnier f;
    f.frictionless_ = a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0;
    if (f.frictionless_) return f;
    const double least2 = std::min(a[1], 0.0), least3 = std::min(a[2], 0.0);
    if (!(a[0] > 0.0)) refuse("alpha_1", a[0], 0.0);
    if (!(a[0] + least2 > 0.0)) refuse("alpha_2", a[1], -a[0]);
    if (!(a[0] + least3 > 0.0)) refuse("alpha_3", a[2], -a[0]);
    if (!(a[0] + least2 + least3 > 0.0)) refuse("alpha_2 + alpha_3", a[1] + a[2], -a[0]);
    refuse_thin("alpha: coefficients along the axes", a[0] + least2 + least3,
                a[0] + std::max(a[1], 0.0) + std::max(a[2], 0.0), "");
    f.alpha_ = {a[0], a[1], a[2]};
    return f;
  }

  bool frictionless() const noexcept { return frictionless_; }

  template <class S>
  ContraContra<S> tensor(const ContraContra<S>& a, const UpperAxes<S>& first,
                         const UpperAxes<S>& second) const {
    const Vector<S>&m = first[0], &k = second[0];
    const ContraContra<S> c = alpha_[0] * a + alpha_[1] * outer(m, m) + alpha_[2] * outer(k, k);
    const CoCo<S> c_inv = inverse(c);  // covariant components of C^-1
    return a * c_inv * a * c_inv * a;
  }

 private:
  [[noreturn]] static void refuse(const std::string& which, double given, double least) {
    std::ostringstream s;
    s << "alpha: " << which << " = " << given << " given, must be > " << least
      << " for C to be positive definite at every angle of m and k";
    throw std::invalid_argument(s.str());
  }
  std::array<double, 3> alpha_{1.0, 0.0, 0.0};
  bool frictionless_{false};
};

static_assert(Friction<HeCurnier>);

}  // namespace anisocontact::law
