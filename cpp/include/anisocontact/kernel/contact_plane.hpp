#pragma once
// Linear forms in what moves a contact point, and the plane in which its law is solved.

#include "anisocontact/kernel/carried.hpp"
#include "anisocontact/tensor/padded.hpp"

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
  std::array<Padded, inputs> by;
  Flat xi, turn;

  void clear() {
    by.fill(Padded());
    xi = turn = {};
  }
  Padded& operator[](Input i) { return by[index(i)]; }
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
    f[Input::slave].add(k, n);
    f[Input::position].add(-k, n);
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
        f[b].by[first + i].add(k[b] * a.c[i], a.mu);
        f[b].xi[i] += k[b] * a.by_xi[i];
        f[b].turn[i] -= k[b] * a.lift * mu[i];
      }
  }
};

}  // namespace anisocontact::kernel
