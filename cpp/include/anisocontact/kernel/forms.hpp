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
  Flat xi{}, turn{};

  Form() { by.fill(Vec3<double>::Zero()); }
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
  /// Adds the change of an angle.
  void add_angle(double k, const PlaneAxis& a, Side side, Form& f) const {
    const std::size_t first = side == Side::master ? tangent_input(0) : slave_input(0);
    const Flat mu = along(a.mu);
    for (std::size_t i = 0; i < 2; ++i) {
      f.by[first + i] += k * a.c[i] * a.mu;
      f.xi[i] += k * a.by_xi[i];
      f.turn[i] -= k * a.lift * mu[i];
    }
  }
};

/// The committed point of the master, and what is remembered there, turned with the normal onto the
/// contact plane: turned(w) = w - c (n_0 + n), c = w . n / (1 + n_0 . n).
class CommittedPoint {
 public:
  CommittedPoint(const ContactPlane& plane, const surface::Geometry<double>& before,
                 const Vec3<double>& now)
      : before_(before),
        dual_{before.dual_basis(0), before.dual_basis(1)},
        share_(1.0 / (1.0 + before.normal.dot(plane.n))),
        n0_(plane.along(before.normal)),
        way_(now - before.jet.position),
        rise_(way_.dot(plane.n)) {
    for (std::size_t a = 0; a < 2; ++a) lean_[a] = plane.t[a] - n0_[a] * share_ * plane.n;
  }

  /// A vector of the committed tangent plane.
  struct Remembered {
    Vec3<double> w;
    Flat upper;  ///< w . b^i
  };
  Remembered vector(const Flat& upper) const {
    return {upper[0] * before_.jet.d1[0] + upper[1] * before_.jet.d1[1], upper};
  }
  Remembered covector(const Flat& lower) const {
    return vector((before_.a_contra * Covector<double>{lower}).c);
  }

  Flat increment(const ContactPlane& p) const { return p.along(way_); }
  Flat turned(const Remembered& m, const ContactPlane& p) const {
    const Flat w = p.along(m.w);
    const double c = share_ * m.w.dot(p.n);
    return {w[0] - c * n0_[0], w[1] - c * n0_[1]};
  }

  /// Adds k_a d(increment_a).
  void add_increment(const Flat& k, const ContactPlane& p, Form& f) const {
    const Vec3<double> tau = p.spatial(k);
    f[Input::position] += tau;
    f[Input::before_position] -= tau;
    for (std::size_t i = 0; i < 2; ++i) {
      f.xi[i] += tau.dot(p.r[i]);
      f.turn[i] -= rise_ * k[i];
    }
  }
  /// Adds k_a d(turned_a) of m = upper^i b_i, the components kept.
  void add_vector(const Flat& k, const Remembered& m, const ContactPlane& p, Form& f) const {
    const Vec3<double> y = add_turn(k, m, p, f);
    for (std::size_t j = 0; j < 2; ++j) f.by[before_input(j)] += m.upper[j] * y;
  }
  /// Adds k_a d(turned_a) of m = lower_i b^i, the components kept:
  /// d b^i = - (b^i . d b_j) b^j + a^ij (n_0 . d b_j) n_0.
  void add_covector(const Flat& k, const Remembered& m, const ContactPlane& p, Form& f) const {
    const Vec3<double> y = add_turn(k, m, p, f);
    const double up = y.dot(before_.normal);
    for (std::size_t j = 0; j < 2; ++j)
      f.by[before_input(j)] += m.upper[j] * up * before_.normal - y.dot(dual_[j]) * m.w;
  }

 private:
  /// What both kinds have in common: dn and dn_0 = - b^j (n_0 . d b_j). Returns the vector that dw
  /// is multiplied by.
  Vec3<double> add_turn(const Flat& k, const Remembered& m, const ContactPlane& p, Form& f) const {
    const Vec3<double> y = k[0] * lean_[0] + k[1] * lean_[1];
    const double c = share_ * m.w.dot(p.n), side = share_ * (k[0] * n0_[0] + k[1] * n0_[1]);
    const Flat w = p.along(m.w);
    for (std::size_t a = 0; a < 2; ++a) f.turn[a] -= c * k[a] + side * (w[a] - c * n0_[a]);
    for (std::size_t j = 0; j < 2; ++j)
      f.by[before_input(j)] += c * y.dot(dual_[j]) * before_.normal;
    return y;
  }

  const surface::Geometry<double>& before_;
  std::array<Vec3<double>, 2> dual_;
  double share_;
  Flat n0_;
  Vec3<double> way_;
  double rise_;
  std::array<Vec3<double>, 2> lean_;
};

inline std::array<Flat, 2> in_frame(const ContactPlane& p, const PlaneAxes& a) {
  return {p.along(a.axis[0].e), p.along(a.axis[1].e)};
}

/// Adds the changes of both angles of a field.
inline void add_angles(const FrameReaction& r, Slope s, const PlaneAxes& axes, std::size_t a,
                       const ContactPlane& p, Form& f) {
  for (std::size_t k = 0; k < 2; ++k) p.add_angle(r.slope(s, k)[a], axes.axis[k], axes.side, f);
}

/// The slopes of T_a by the two components of a vector.
inline Flat slopes_of(const FrameReaction& r, Slope s, std::size_t a) {
  return {r.slope(s, 0)[a], r.slope(s, 1)[a]};
}

/// What the law sees of a point. Without a committed point there is no history and no slip.
inline FrameInput frame_input(double gap, double dt, const Dual<1>& pressure,
                              const PointState& state, const CommittedPoint* committed,
                              const LawAxes& axes, const ContactPlane& p) {
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
  in.increment = committed->increment(p);
  if (!remembers(state)) return in;
  in.stored = committed->turned(committed->covector(state.stored), p);
  in.elastic = committed->turned(committed->vector(state.elastic), p);
  return in;
}

/// The forms of t_1 . dT and t_2 . dT for T = T_a t_a.
inline std::array<Form, 2> friction_forms(const FrameReaction& r, const LawAxes& axes,
                                          const ContactPlane& p, const PointState& state,
                                          const CommittedPoint* committed) {
  std::array<Form, 2> f;
  for (std::size_t a = 0; a < 2; ++a) {
    p.add_gap(r.slope(Slope::gap, 0)[a], f[a]);
    add_angles(r, Slope::adhesion, axes.adhesion, a, p, f[a]);
    add_angles(r, Slope::friction, axes.friction, a, p, f[a]);
    add_angles(r, Slope::second, axes.second, a, p, f[a]);
    if (committed == nullptr) continue;
    committed->add_increment(slopes_of(r, Slope::increment, a), p, f[a]);
    if (!remembers(state)) continue;
    committed->add_covector(slopes_of(r, Slope::stored, a), committed->covector(state.stored), p,
                            f[a]);
    committed->add_vector(slopes_of(r, Slope::elastic, a), committed->vector(state.elastic), p,
                          f[a]);
  }
  return f;
}

/// The forms of t_1 . dt, t_2 . dt and n . dt for t = N n + T_a t_a.
inline std::array<Form, 3> traction_forms(const std::array<Form, 2>& friction,
                                          const FrameReaction& r, const FrameInput& in,
                                          const ContactPlane& p) {
  std::array<Form, 3> f{friction[0], friction[1], {}};
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
