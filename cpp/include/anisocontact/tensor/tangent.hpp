#pragma once
// Vectors and tensors of the tangent plane with the placement of every index in the type.
// A contraction compiles only between an upper and a lower index; a sum only between equals.

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "anisocontact/tensor/dual.hpp"
#include "anisocontact/tensor/inline.hpp"

namespace anisocontact {

/// Placement of an index: `co` (lower, T_i) or `contra` (upper, xi^i).
enum class Place { co, contra };

constexpr Place opposite(Place p) { return p == Place::co ? Place::contra : Place::co; }

/// First-order tensor of the tangent plane.
template <class S, Place P>
struct Tangent1 {
  std::array<S, 2> c{};

  S& operator[](std::size_t i) { return c[i]; }
  const S& operator[](std::size_t i) const { return c[i]; }

  ANISOCONTACT_INLINE friend Tangent1 operator+(const Tangent1& a, const Tangent1& b) {
    return {{a.c[0] + b.c[0], a.c[1] + b.c[1]}};
  }
  ANISOCONTACT_INLINE friend Tangent1 operator-(const Tangent1& a, const Tangent1& b) {
    return {{a.c[0] - b.c[0], a.c[1] - b.c[1]}};
  }
  ANISOCONTACT_INLINE friend Tangent1 operator*(const S& s, const Tangent1& a) {
    return {{s * a.c[0], s * a.c[1]}};
  }
  ANISOCONTACT_INLINE friend Tangent1 operator*(double s, const Tangent1& a)
    requires(!std::is_same_v<S, double>)
  {
    return {{s * a.c[0], s * a.c[1]}};
  }
  ANISOCONTACT_INLINE Tangent1 operator-() const { return {{-c[0], -c[1]}}; }
};

/// Second-order tensor of the tangent plane.
template <class S, Place P, Place Q>
struct Tangent2 {
  std::array<std::array<S, 2>, 2> c{};

  S& operator()(std::size_t i, std::size_t j) { return c[i][j]; }
  const S& operator()(std::size_t i, std::size_t j) const { return c[i][j]; }

  ANISOCONTACT_INLINE friend Tangent2 operator+(const Tangent2& a, const Tangent2& b) {
    return {{{{a.c[0][0] + b.c[0][0], a.c[0][1] + b.c[0][1]},
              {a.c[1][0] + b.c[1][0], a.c[1][1] + b.c[1][1]}}}};
  }
  ANISOCONTACT_INLINE friend Tangent2 operator-(const Tangent2& a, const Tangent2& b) {
    return a + (-b);
  }
  ANISOCONTACT_INLINE friend Tangent2 operator*(const S& s, const Tangent2& a) {
    return {{{{s * a.c[0][0], s * a.c[0][1]}, {s * a.c[1][0], s * a.c[1][1]}}}};
  }
  ANISOCONTACT_INLINE friend Tangent2 operator*(double s, const Tangent2& a)
    requires(!std::is_same_v<S, double>)
  {
    return {{{{s * a.c[0][0], s * a.c[0][1]}, {s * a.c[1][0], s * a.c[1][1]}}}};
  }
  ANISOCONTACT_INLINE Tangent2 operator-() const {
    return {{{{-c[0][0], -c[0][1]}, {-c[1][0], -c[1][1]}}}};
  }
};

/// Contravariant components, xi^i.
template <class S>
using Vector = Tangent1<S, Place::contra>;
/// Covariant components, T_i.
template <class S>
using Covector = Tangent1<S, Place::co>;
template <class S>
using CoCo = Tangent2<S, Place::co, Place::co>;
template <class S>
using ContraContra = Tangent2<S, Place::contra, Place::contra>;
/// Maps covectors to covectors: m_i^j.
template <class S>
using CoContra = Tangent2<S, Place::co, Place::contra>;
/// Maps vectors to vectors: m^i_j.
template <class S>
using ContraCo = Tangent2<S, Place::contra, Place::co>;

/// u_i v^i.
template <class S, Place P>
ANISOCONTACT_INLINE S dot(const Tangent1<S, P>& u, const Tangent1<S, opposite(P)>& v) {
  return u.c[0] * v.c[0] + u.c[1] * v.c[1];
}

/// Contraction of the last index of `m` with `u`.
template <class S, Place P, Place Q>
ANISOCONTACT_INLINE Tangent1<S, P> operator*(const Tangent2<S, P, Q>& m,
                                             const Tangent1<S, opposite(Q)>& u) {
  return {{m.c[0][0] * u.c[0] + m.c[0][1] * u.c[1], m.c[1][0] * u.c[0] + m.c[1][1] * u.c[1]}};
}

/// Contraction of the last index of `m` with the first index of `n`.
template <class S, Place P, Place Q, Place R>
ANISOCONTACT_INLINE Tangent2<S, P, R> operator*(const Tangent2<S, P, Q>& m,
                                                const Tangent2<S, opposite(Q), R>& n) {
  const auto at = [&](std::size_t i, std::size_t j) ANISOCONTACT_INLINE_LAMBDA {
    return m.c[i][0] * n.c[0][j] + m.c[i][1] * n.c[1][j];
  };
  return {{{{at(0, 0), at(0, 1)}, {at(1, 0), at(1, 1)}}}};
}

/// u (x) v.
template <class S, Place P, Place Q>
ANISOCONTACT_INLINE Tangent2<S, P, Q> outer(const Tangent1<S, P>& u, const Tangent1<S, Q>& v) {
  return {{{{u.c[0] * v.c[0], u.c[0] * v.c[1]}, {u.c[1] * v.c[0], u.c[1] * v.c[1]}}}};
}

template <class S, Place P, Place Q>
ANISOCONTACT_INLINE Tangent2<S, Q, P> transpose(const Tangent2<S, P, Q>& m) {
  return {{{{m.c[0][0], m.c[1][0]}, {m.c[0][1], m.c[1][1]}}}};
}

template <class S, Place P, Place Q>
ANISOCONTACT_INLINE S det(const Tangent2<S, P, Q>& m) {
  return m.c[0][0] * m.c[1][1] - m.c[0][1] * m.c[1][0];
}

/// m_i^i, defined for mixed placement alone.
template <class S, Place P>
ANISOCONTACT_INLINE S trace(const Tangent2<S, P, opposite(P)>& m) {
  return m.c[0][0] + m.c[1][1];
}

/// det(m) m^-1; the placement is that of the inverse.
template <class S, Place P, Place Q>
ANISOCONTACT_INLINE Tangent2<S, opposite(Q), opposite(P)> adjugate(const Tangent2<S, P, Q>& m) {
  return {{{{m.c[1][1], -m.c[0][1]}, {-m.c[1][0], m.c[0][0]}}}};
}

template <class S, Place P, Place Q>
ANISOCONTACT_INLINE Tangent2<S, opposite(Q), opposite(P)> inverse(const Tangent2<S, P, Q>& m) {
  return (S(1.0) / det(m)) * adjugate(m);
}

/// The unit tensor delta_i^j.
template <class S, Place P>
ANISOCONTACT_INLINE Tangent2<S, P, opposite(P)> unit() {
  return {{{{S(1.0), S(0.0)}, {S(0.0), S(1.0)}}}};
}

/// Full contraction m_ij n^ij.
template <class S, Place P, Place Q>
S contract(const Tangent2<S, P, Q>& m, const Tangent2<S, opposite(P), opposite(Q)>& n) {
  return m.c[0][0] * n.c[0][0] + m.c[0][1] * n.c[0][1] + m.c[1][0] * n.c[1][0] +
         m.c[1][1] * n.c[1][1];
}

/// Square root of a symmetric positive tensor in mixed placement: (M + sqrt(det M) I)/sqrt(tr M + 2 sqrt(det M))
/// by the theorem of Cayley and Hamilton. Where det M is lost in the rounding of its two products, it
/// is what rounding leaves of it: there is a root always, and it is never singular.
template <class S, Place P>
Tangent2<S, P, opposite(P)> square_root(const Tangent2<S, P, opposite(P)>& m) {
  using std::sqrt;
  const S tr = trace(m), d = det(m);
  const S least = 1e-8 * tr;
  const S s = value(d) > value(least) * value(least) ? sqrt(d) : least;
  return (S(1.0) / sqrt(tr + S(2.0) * s)) * (m + s * unit<S, P>());
}

/// Derivative k of a tensor in dual numbers.
template <std::size_t N, Place P, Place Q>
Tangent2<double, P, Q> derivative(const Tangent2<Dual<N>, P, Q>& m, std::size_t k) {
  return {{{{m.c[0][0].d[k], m.c[0][1].d[k]}, {m.c[1][0].d[k], m.c[1][1].d[k]}}}};
}

/// Constants in the scalar type S.
template <class S, Place P>
Tangent1<S, P> constant(const Tangent1<double, P>& u) {
  return {{S(u.c[0]), S(u.c[1])}};
}
template <class S, Place P>
Tangent1<double, P> value(const Tangent1<S, P>& u) {
  return {{value(u.c[0]), value(u.c[1])}};
}
template <class S, Place P>
std::array<Tangent1<double, P>, 2> value(const std::array<Tangent1<S, P>, 2>& u) {
  return {value(u[0]), value(u[1])};
}
template <class S, Place P, Place Q>
Tangent2<double, P, Q> value(const Tangent2<S, P, Q>& m) {
  return {{{{value(m.c[0][0]), value(m.c[0][1])}, {value(m.c[1][0]), value(m.c[1][1])}}}};
}

}  // namespace anisocontact
