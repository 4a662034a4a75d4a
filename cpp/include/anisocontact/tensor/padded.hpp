#pragma once
// Spatial vectors in one vector register each: linear forms are sums of many.

#include "anisocontact/tensor/dual.hpp"
#include "anisocontact/tensor/lanes.hpp"

namespace anisocontact {

/// Three components with a zero behind them.
class Padded {
 public:
  ANISOCONTACT_INLINE Padded() = default;
  template <class Derived>
  ANISOCONTACT_INLINE Padded(const Eigen::MatrixBase<Derived>& x) : Padded(Vec3<double>(x)) {}
  ANISOCONTACT_INLINE Padded(const Vec3<double>& x) : c_(Lanes<4>::of(x[0], x[1], x[2], 0.0)) {}

  ANISOCONTACT_INLINE double operator[](std::size_t i) const { return c_[i]; }
  ANISOCONTACT_INLINE Vec3<double> vector() const { return {c_[0], c_[1], c_[2]}; }
  /// Writes the components and the zero.
  ANISOCONTACT_INLINE void to(double* p) const { c_.to(p); }

  /// this += f other
  ANISOCONTACT_INLINE void add(double f, const Padded& other) { c_.add(f, other.c_); }
  ANISOCONTACT_INLINE Padded& operator+=(const Padded& y) { return *this = *this + y; }
  ANISOCONTACT_INLINE Padded& operator-=(const Padded& y) { return *this = *this - y; }
  ANISOCONTACT_INLINE friend Padded operator+(const Padded& x, const Padded& y) {
    return Padded(x.c_ + y.c_);
  }
  ANISOCONTACT_INLINE friend Padded operator-(const Padded& x, const Padded& y) {
    return Padded(x.c_ - y.c_);
  }
  ANISOCONTACT_INLINE friend Padded operator*(double f, const Padded& x) {
    return Padded(f * x.c_);
  }
  ANISOCONTACT_INLINE Padded operator-() const { return Padded(-c_); }

 private:
  ANISOCONTACT_INLINE explicit Padded(const Lanes<4>& c) : c_(c) {}
  Lanes<4> c_;
};

}  // namespace anisocontact
