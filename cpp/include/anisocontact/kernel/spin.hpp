#pragma once
// The turn of the slave about the normal against the master, in the frame of the contact plane, with
// its linear form. See `relative_spin` of kernel/evolution.hpp for the same in any numbers.

#include "anisocontact/kernel/contact_plane.hpp"
#include "anisocontact/kernel/half_turn.hpp"

namespace anisocontact::kernel {

namespace detail {

inline double inner(const Flat& u, const Flat& v) { return u[0] * v[0] + u[1] * v[1]; }
inline double across(const Flat& u, const Flat& v) { return u[0] * v[1] - u[1] * v[0]; }
/// u and a quarter of a turn of u, times two numbers.
inline Flat turned_by(double cosine, double sine, const Flat& u) {
  return {cosine * u[0] - sine * u[1], cosine * u[1] + sine * u[0]};
}

}  // namespace detail

/// The angle of the rotation in the polar decomposition of what takes the committed tangents of the
/// slave, s_i, to those of now, t_i, all in the contact plane:
///   angle = atan2(t_1 . s_2 - t_2 . s_1,  t_1 x s_2 + s_1 x t_2).
class RelativeSpin {
 public:
  RelativeSpin(const ContactPlane& plane, const Carrier& own, const std::array<Flat, 2>& old)
      : plane_(plane), old_(old) {
    for (std::size_t i = 0; i < 2; ++i) {
      now_[i] = plane.along(own.now.d1[i]);
      rise_[i] = plane.n.dot(own.now.d1[i]);
    }
    sine_ = detail::inner(now_[0], old[1]) - detail::inner(now_[1], old[0]);
    cosine_ = detail::across(now_[0], old[1]) + detail::across(old[0], now_[1]);
    const double side = detail::across(old[0], old[1]) < 0.0 ? -1.0 : 1.0;
    half_ = HalfSpin(side * sine_, side * cosine_);
  }

  double angle() const { return 2.0 * half_.half; }
  /// The path that a chord spans.
  Flat path(const Flat& chord) const { return detail::turned_by(half_.g, half_.half, chord); }
  /// Slopes by the chord from those by the path.
  Flat by_chord(const Flat& k) const { return detail::turned_by(half_.g, -half_.half, k); }

  /// Adds the change of the path with the angle. What follows from the committed tangents goes to
  /// the two numbers of `by_old`.
  void add(const Flat& k, const Flat& chord, std::array<Flat, 2>& by_old, Form& f) const {
    const double by_angle = detail::inner(k, detail::turned_by(half_.dg, 0.5, chord)) /
                            (sine_ * sine_ + cosine_ * cosine_);
    const double c = by_angle * cosine_, s = by_angle * sine_;
    const std::array<Flat, 2> by_now{detail::turned_by(c, s, old_[1]),
                                     detail::turned_by(-c, -s, old_[0])};
    by_old = {detail::turned_by(-c, s, now_[1]), detail::turned_by(c, -s, now_[0])};
    for (std::size_t i = 0; i < 2; ++i) {
      f.by[slave_input(i)] += plane_.spatial(by_now[i]);
      for (std::size_t a = 0; a < 2; ++a) f.turn[a] -= by_now[i][a] * rise_[i];
    }
  }

 private:
  const ContactPlane& plane_;
  std::array<Flat, 2> old_, now_;
  std::array<double, 2> rise_;  ///< of the tangents of now, out of the plane
  double sine_, cosine_;
  HalfSpin half_;
};

}  // namespace anisocontact::kernel
