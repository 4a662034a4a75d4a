#pragma once
// The turn of the slave about the normal against the master, in the frame of the contact plane, with
// its linear form. See `relative_spin` of tests/cpp/dual_law.hpp for the same in any numbers.

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
/// The part of a vector in the contact plane; all three components are those in the frame t_1, t_2, n.
inline Flat flat(const Vec3<double>& v) { return {v[0], v[1]}; }

}  // namespace detail

/// Where a facet of the slave lies in the frame of the contact plane: tangents, dual basis, normal.
struct SlaveFrame {
  std::array<Vec3<double>, 2> tangent, dual;
  Vec3<double> normal;

  explicit SlaveFrame(const std::array<Vec3<double>, 2>& t) : tangent(t) {
    const Vec3<double> area = t[0].cross(t[1]);
    const double inverse = 1.0 / area.norm();
    normal = inverse * area;
    dual = {inverse * t[1].cross(normal), inverse * normal.cross(t[0])};
  }
};

/// The turn about the normal n of the contact plane of what takes the slave from its committed
/// tangents s_i and normal m_0 to those of now, t_i and m:
///   F = t_i (x) s^i + m (x) m_0,   angle = atan2(n . (s^i x t_i + m_0 x m), P : F),  P = 1 - n (x) n.
/// It is the twist about n where the slave is rigid, whatever its facet is inclined by, and the rotation of
/// the polar decomposition in the contact plane where the facet lies in it.
class RelativeSpin {
 public:
  RelativeSpin(const ContactPlane& plane, const Carrier& own, const SlaveFrame& old)
      : plane_(plane), old_(old), now_({in_frame(own.now.d1[0]), in_frame(own.now.d1[1])}) {
    const Flat m = detail::flat(now_.normal), m0 = detail::flat(old_.normal);
    sine_ = detail::across(m0, m);
    cosine_ = detail::inner(m0, m);
    for (std::size_t i = 0; i < 2; ++i) {
      const Flat s = detail::flat(old_.dual[i]), t = detail::flat(now_.tangent[i]);
      sine_ += detail::across(s, t);
      cosine_ += detail::inner(s, t);
    }
    half_ = HalfSpin(sine_, cosine_);
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
    add_now(c, s, f);
    by_old = by_committed(c, s);
  }

 private:
  Vec3<double> in_frame(const Vec3<double>& v) const {
    return {plane_.t[0].dot(v), plane_.t[1].dot(v), plane_.n.dot(v)};
  }

  /// By the tangents of now, with dm = -t^i (m . dt_i), and by the frame, in which these turn.
  void add_now(double c, double s, Form& f) const {
    const Flat by_normal = detail::turned_by(-s, c, detail::flat(old_.normal));
    for (std::size_t i = 0; i < 2; ++i) {
      const Flat direct = detail::turned_by(-s, c, detail::flat(old_.dual[i]));
      const double lean = detail::inner(by_normal, detail::flat(now_.dual[i]));
      const Flat by{direct[0] - lean * now_.normal[0], direct[1] - lean * now_.normal[1]};
      const double by_rise = -lean * now_.normal[2];
      f.by[slave_input(i)] += plane_.spatial(by) + by_rise * plane_.n;
      for (std::size_t a = 0; a < 2; ++a)
        f.turn[a] +=
            by_rise * now_.tangent[i][static_cast<Eigen::Index>(a)] - by[a] * now_.tangent[i][2];
    }
  }

  /// By what lies in the contact plane of the committed tangents, with
  /// ds^i = -s^j (s^i . ds_j) + (s^i . s^j) m_0 (m_0 . ds_j),  dm_0 = -s^j (m_0 . ds_j).
  std::array<Flat, 2> by_committed(double c, double s) const {
    const Flat m0 = detail::flat(old_.normal);
    const Flat by_normal = detail::turned_by(-s, -c, detail::flat(now_.normal));
    std::array<Flat, 2> by{};
    for (std::size_t j = 0; j < 2; ++j) {
      double lean = -detail::inner(by_normal, detail::flat(old_.dual[j]));
      for (std::size_t i = 0; i < 2; ++i) {
        const Flat by_dual = detail::turned_by(-s, -c, detail::flat(now_.tangent[i]));
        const double stretch = detail::inner(by_dual, detail::flat(old_.dual[j]));
        lean += old_.dual[i].dot(old_.dual[j]) * detail::inner(by_dual, m0);
        for (std::size_t a = 0; a < 2; ++a)
          by[j][a] -= stretch * old_.dual[i][static_cast<Eigen::Index>(a)];
      }
      for (std::size_t a = 0; a < 2; ++a) by[j][a] += lean * m0[a];
    }
    return by;
  }

  const ContactPlane& plane_;
  SlaveFrame old_, now_;
  double sine_, cosine_;
  HalfSpin half_;
};

}  // namespace anisocontact::kernel
