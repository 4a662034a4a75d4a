#pragma once
// B-spline or NURBS patch; the coordinates are the parameters of its knots.

#include <memory>
#include <vector>

#include "anisocontact/surface/analytic/knots.hpp"
#include "anisocontact/surface/foot.hpp"
#include "anisocontact/surface/geometry.hpp"

namespace anisocontact::surface {

struct NurbsPieces;

/// rho = sum N_a(xi^1) N_b(xi^2) w_ab P_ab / sum N_a(xi^1) N_b(xi^2) w_ab
/// [Piegl Tiller 1997, eq. (4.15)].
class Nurbs {
 public:
  /// A control point (w x, w y, w z, w).
  using Point = Eigen::Vector4d;

  Nurbs() = default;
  Nurbs(const Knots& knots_1, const Knots& knots_2, std::vector<Point> net);

  static Descriptor describe() {
    return {"nurbs",
            "B-spline or NURBS patch; xi are the parameters of its knots.",
            {{"degrees", Kind::integers, "1", "degree in each coordinate, from 1 to 8",
              Bound::positive},
             {"knots_1", Kind::array, "1", "knots of the first coordinate"},
             {"knots_2", Kind::array, "1", "knots of the second coordinate"},
             {"points", Kind::array, "length",
              "control points x, y, z one after the other, the second coordinate runs fastest"},
             {"weights",
              Kind::array,
              "1",
              "weight of each control point; all equal if left out",
              Bound::positive,
              false,
              {}},
             {"flip",
              Kind::flag,
              "1",
              "whether the first coordinate is reversed, which turns the normal to the other side",
              Bound::any,
              false,
              {0.0}}}};
  }
  static Nurbs make(const Values& v);

  Domain domain() const { return domain_; }

  /// A periodic coordinate may be given beyond its ends; others are continued by the polynomial of
  /// the last piece.
  template <class S>
  Jet<S> jet(const S& u, const S& v) const {
    const S a = wrapped(0, u), b = wrapped(1, v);
    return jet_in({knots_[0].span(anisocontact::value(a)), knots_[1].span(anisocontact::value(b))},
                  a, b);
  }

  /// The jet of the polynomials of one pair of spans.
  template <class S>
  Jet<S> jet_in(const std::array<std::size_t, 2>& span, const S& u, const S& v) const noexcept;

  const Knots& knots(std::size_t i) const { return knots_[i]; }
  const Point& control(std::size_t i, std::size_t j) const {
    return net_[i * knots_[1].count() + j];
  }
  const NurbsPieces& pieces() const { return *pieces_; }

 private:
  template <class S>
  S wrapped(std::size_t i, const S& u) const noexcept {
    if (!domain_.periodic[i]) return u;
    const double turns = domain_.turns(i, anisocontact::value(u));
    return turns == 0.0 ? u : u - S(turns);
  }
  bool closes(std::size_t i) const;

  std::array<Knots, 2> knots_;
  std::vector<Point> net_;
  Domain domain_;
  std::shared_ptr<const NurbsPieces> pieces_;  ///< for the closest point; shared by copies
};

template <class S>
Jet<S> Nurbs::jet_in(const std::array<std::size_t, 2>& span, const S& u,
                     const S& v) const noexcept {
  using Homogeneous = Eigen::Matrix<S, 4, 1>;
  const std::size_t p = knots_[0].degree(), q = knots_[1].degree();
  const auto n = knots_[0].basis(span[0], u), m = knots_[1].basis(span[1], v);
  std::array<Homogeneous, 6> a;  // value, _1, _2, _11, _12, _22
  for (auto& h : a) h.fill(S(0.0));
  for (std::size_t i = 0; i <= p; ++i) {
    std::array<Homogeneous, 3> row;
    for (auto& h : row) h.fill(S(0.0));
    const Point* c = &control(span[0] - p + i, span[1] - q);
    for (std::size_t j = 0; j <= q; ++j)
      for (std::size_t d = 0; d < 3; ++d)
        for (Eigen::Index k = 0; k < 4; ++k) row[d][k] += c[j][k] * m[d][j];
    for (Eigen::Index k = 0; k < 4; ++k) {
      a[0][k] += n[0][i] * row[0][k];
      a[1][k] += n[1][i] * row[0][k];
      a[2][k] += n[0][i] * row[1][k];
      a[3][k] += n[2][i] * row[0][k];
      a[4][k] += n[1][i] * row[1][k];
      a[5][k] += n[0][i] * row[2][k];
    }
  }
  const S inverse = S(1.0) / a[0][3];
  const auto part = [&](std::size_t d) -> Vec3<S> { return inverse * a[d].template head<3>(); };
  const auto weight = [&](std::size_t d) -> S { return inverse * a[d][3]; };
  Jet<S> r;
  r.position = part(0);
  r.d1[0] = part(1) - weight(1) * r.position;
  r.d1[1] = part(2) - weight(2) * r.position;
  r.d2[0] = part(3) - S(2.0) * weight(1) * r.d1[0] - weight(3) * r.position;
  r.d2[1] = part(4) - weight(1) * r.d1[1] - weight(2) * r.d1[0] - weight(4) * r.position;
  r.d2[2] = part(5) - S(2.0) * weight(2) * r.d1[1] - weight(5) * r.position;
  return r;
}

}  // namespace anisocontact::surface
