#pragma once
// How the numbers that a law sees change with what moves: linear forms in the slave point, the
// master at the projection, the master at the committed point, and the tangents of the slave.

#include "anisocontact/kernel/carried.hpp"

namespace anisocontact::kernel {

/// What a traction depends on, in groups of three components.
enum class Input : std::size_t {
  slave = 0,
  position = 1,
  tangent_1 = 2,
  tangent_2 = 3,
  before_position = 4,
  before_tangent_1 = 5,
  before_tangent_2 = 6,
  slave_tangent_1 = 7,
  slave_tangent_2 = 8
};
inline constexpr std::size_t inputs = 9;

constexpr std::size_t index(Input i) { return static_cast<std::size_t>(i); }
constexpr std::size_t tangent_input(std::size_t i) { return index(Input::tangent_1) + i; }
constexpr std::size_t before_input(std::size_t i) { return index(Input::before_tangent_1) + i; }
constexpr std::size_t slave_input(std::size_t i) { return index(Input::slave_tangent_1) + i; }

/// A linear form: directly in the inputs, and through the coordinates of the projection, d xi^i, and
/// the turn of the normal, nu_a = t_a . dn, which follow from them.
struct Form {
  std::array<Vec3<double>, inputs> by;
  Flat xi, turn;

  void clear() {
    by.fill(Vec3<double>::Zero());
    xi = turn = {};
  }
  Vec3<double>& operator[](Input i) { return by[index(i)]; }
};

/// Where a point is in contact: the frame, the tangents of the master, and x - rho.
struct ContactPlane {
  std::array<Vec3<double>, 2> t;
  Vec3<double> n;
  std::array<Vec3<double>, 2> r;
  Vec3<double> apart;

  Flat along(const Vec3<double>& v) const { return {t[0].dot(v), t[1].dot(v)}; }
  /// u_a t_a.
  Vec3<double> spatial(const Flat& u) const { return u[0] * t[0] + u[1] * t[1]; }

  /// Adds k dg, g = (x - rho) . n.
  void add_gap(double k, Form& f) const {
    f[Input::slave] += k * n;
    f[Input::position] -= k * n;
    const Flat side = along(apart);
    for (std::size_t i = 0; i < 2; ++i) {
      f.xi[i] -= k * n.dot(r[i]);
      f.turn[i] += k * side[i];
    }
  }
  /// Adds the change of an angle to both forms, times k.
  void add_angle(const Flat& k, const PlaneAxis& a, Side side, std::array<Form, 2>& f) const {
    const std::size_t first = side == Side::master ? tangent_input(0) : slave_input(0);
    const Flat mu = along(a.mu);
    for (std::size_t b = 0; b < 2; ++b)
      for (std::size_t i = 0; i < 2; ++i) {
        f[b].by[first + i] += k[b] * a.c[i] * a.mu;
        f[b].xi[i] += k[b] * a.by_xi[i];
        f[b].turn[i] -= k[b] * a.lift * mu[i];
      }
  }
};

/// The committed point of the master, and what is remembered there, turned with the normal onto the
/// contact plane: turned(w) = w - c (n_0 + n), c = w . n / (1 + n_0 . n).
class CommittedPoint {
 public:
  CommittedPoint(const ContactPlane& plane, const surface::Geometry<double>& before,
                 const Vec3<double>& now, const PointState& state)
      : plane_(plane),
        normal_(before.normal),
        dual_{before.dual_basis(0), before.dual_basis(1)},
        share_(1.0 / (1.0 + before.normal.dot(plane.n))),
        n0_(plane.along(before.normal)),
        way_(now - before.jet.position),
        remembers_(kernel::remembers(state)) {
    for (std::size_t a = 0; a < 2; ++a) lean_[a] = plane.t[a] - n0_[a] * share_ * plane.n;
    if (!remembers_) return;
    stored_ = remembered((before.a_contra * Covector<double>{state.stored}).c, before);
    elastic_ = remembered(state.elastic, before);
  }

  /// Whether there is more to remember than the place.
  bool remembers() const { return remembers_; }
  Flat increment() const { return plane_.along(way_); }
  Flat stored() const { return turned(stored_); }
  Flat elastic() const { return turned(elastic_); }

  /// Adds k_a d(increment_a).
  void add_increment(const Flat& k, Form& f) const {
    const Vec3<double> tau = plane_.spatial(k);
    const double rise = way_.dot(plane_.n);
    f[Input::position] += tau;
    f[Input::before_position] -= tau;
    for (std::size_t i = 0; i < 2; ++i) {
      f.xi[i] += tau.dot(plane_.r[i]);
      f.turn[i] -= rise * k[i];
    }
  }
  /// Adds k_a d(stored_a) of w = lower_i b^i, the components kept:
  /// d b^i = - (b^i . d b_j) b^j + a^ij (n_0 . d b_j) n_0.
  void add_stored(const Flat& k, Form& f) const {
    const Remembered& m = stored_;
    const Vec3<double> y = add_turn(k, m, f);
    const double up = y.dot(normal_);
    for (std::size_t j = 0; j < 2; ++j) {
      const double stretch = y.dot(dual_[j]);
      f.by[before_input(j)] += (m.fall * stretch + m.upper[j] * up) * normal_ - stretch * m.w;
    }
  }
  /// Adds k_a d(elastic_a) of w = upper^i b_i, the components kept.
  void add_elastic(const Flat& k, Form& f) const {
    const Remembered& m = elastic_;
    const Vec3<double> y = add_turn(k, m, f);
    for (std::size_t j = 0; j < 2; ++j)
      f.by[before_input(j)] += m.fall * y.dot(dual_[j]) * normal_ + m.upper[j] * y;
  }

 private:
  /// A vector of the committed tangent plane.
  struct Remembered {
    Vec3<double> w;
    Flat upper;   ///< w . b^i
    Flat along;   ///< w . t_a
    double fall;  ///< c
  };
  Remembered remembered(const Flat& upper, const surface::Geometry<double>& before) const {
    const Vec3<double> w = upper[0] * before.jet.d1[0] + upper[1] * before.jet.d1[1];
    return {w, upper, plane_.along(w), share_ * w.dot(plane_.n)};
  }
  Flat turned(const Remembered& m) const {
    return {m.along[0] - m.fall * n0_[0], m.along[1] - m.fall * n0_[1]};
  }

  /// What both kinds have in common besides dn_0 = - b^j (n_0 . d b_j), which adds c (y . b^j) n_0.
  /// Returns y, the vector that dw is multiplied by.
  Vec3<double> add_turn(const Flat& k, const Remembered& m, Form& f) const {
    const double side = share_ * (k[0] * n0_[0] + k[1] * n0_[1]);
    const Flat there = turned(m);
    for (std::size_t a = 0; a < 2; ++a) f.turn[a] -= m.fall * k[a] + side * there[a];
    return k[0] * lean_[0] + k[1] * lean_[1];
  }

  const ContactPlane& plane_;
  Vec3<double> normal_;
  std::array<Vec3<double>, 2> dual_;
  double share_;
  Flat n0_;
  Vec3<double> way_;
  bool remembers_;
  std::array<Vec3<double>, 2> lean_;
  Remembered stored_, elastic_;
};

inline std::array<Flat, 2> in_frame(const ContactPlane& p, const PlaneAxes& a) {
  return {p.along(a.axis[0].e), p.along(a.axis[1].e)};
}

/// Adds the changes of both angles of a field, if they change anything.
inline void add_angles(const FrameReaction& r, Slope s, const PlaneAxes& axes,
                       const ContactPlane& p, std::array<Form, 2>& f) {
  for (std::size_t k = 0; k < 2; ++k)
    if (const Flat& slope = r.slope(s, k); slope != Flat{})
      p.add_angle(slope, axes.axis[k], axes.side, f);
}

/// The slopes of T_a by the two components of a vector.
inline Flat slopes_of(const FrameReaction& r, Slope s, std::size_t a) {
  return {r.slope(s, 0)[a], r.slope(s, 1)[a]};
}

/// What the law sees of a point. Without a committed point there is no history and no slip.
inline FrameInput frame_input(double gap, double dt, const Dual<1>& pressure,
                              const CommittedPoint* committed, const LawAxes& axes,
                              const ContactPlane& p) {
  FrameInput in{gap,
                dt,
                pressure.v,
                pressure.d[0],
                {},
                {},
                {},
                in_frame(p, axes.adhesion),
                in_frame(p, axes.friction),
                in_frame(p, axes.second)};
  if (committed == nullptr) return in;
  in.increment = committed->increment();
  if (!committed->remembers()) return in;
  in.stored = committed->stored();
  in.elastic = committed->elastic();
  return in;
}

/// Writes the forms of t_1 . dT and t_2 . dT for T = T_a t_a.
inline void put_friction_forms(const FrameReaction& r, const LawAxes& axes, const ContactPlane& p,
                               const CommittedPoint* committed, std::array<Form, 2>& f) {
  for (std::size_t a = 0; a < 2; ++a) {
    f[a].clear();
    p.add_gap(r.slope(Slope::gap, 0)[a], f[a]);
  }
  add_angles(r, Slope::adhesion, axes.adhesion, p, f);
  add_angles(r, Slope::friction, axes.friction, p, f);
  add_angles(r, Slope::second, axes.second, p, f);
  if (committed == nullptr) return;
  for (std::size_t a = 0; a < 2; ++a) {
    committed->add_increment(slopes_of(r, Slope::increment, a), f[a]);
    if (!committed->remembers()) continue;
    committed->add_stored(slopes_of(r, Slope::stored, a), f[a]);
    if (const Flat k = slopes_of(r, Slope::elastic, a); k != Flat{})
      committed->add_elastic(k, f[a]);
  }
}

/// The forms of t_1 . dt, t_2 . dt and n . dt for t = N n + T_a t_a.
inline std::array<Form, 3> traction_forms(const std::array<Form, 2>& friction,
                                          const FrameReaction& r, const FrameInput& in,
                                          const ContactPlane& p) {
  std::array<Form, 3> f{friction[0], friction[1], {}};
  f[2].clear();
  for (std::size_t a = 0; a < 2; ++a) {
    f[a].turn[a] += in.pressure;
    f[2].turn[a] -= r.traction[a];
  }
  p.add_gap(in.d_pressure, f[2]);
  return f;
}

/// The trial state of a reaction, as components in the basis of a surface.
inline PointState in_basis(const FrameReaction& r, const PointState& old,
                           const std::array<double, 2>& xi, const ContactPlane& p,
                           const surface::Geometry<double>& g) {
  PointState s = r.state;
  for (auto* c : {&s.traction, &s.stored}) *c = g.project_co(p.spatial(*c)).c;
  for (auto* c : {&s.elastic, &s.slip}) *c = g.project_contra(p.spatial(*c)).c;
  s.xi = xi;
  s.origin = origin(old, xi, g.project_contra(p.spatial(r.increment)));
  return s;
}

}  // namespace anisocontact::kernel
