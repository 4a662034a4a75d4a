#pragma once
// The contact frame of a slave point on a facet, and how the projection follows what moves.

#include "anisocontact/kernel/pair_slopes.hpp"

namespace anisocontact::kernel {

/// What the projection hit. On an edge the tangent plane is that of x - rho; its first direction is
/// along the edge.
enum class Feature : std::int64_t { interior = 0, edge = 1, vertex = 2, off = 3 };

/// Where a slave point is: jets of the facets in plain numbers.
struct PairPoint {
  Vec3<double> slave{Vec3<double>::Zero()};
  Carrier master{};               ///< facet at the projection; coordinates xi
  Carrier own{};                  ///< slave facet at the point: positions and tangents alone
  surface::Jet<double> before{};  ///< of the committed facet at the committed coordinates
  std::int64_t facet{-1};
  Feature feature{Feature::off};
  std::array<double, 2> edge{};  ///< direction of the edge in coordinates
  const double* held{nullptr};   ///< onto directions across n along which nothing slips, (3, 3)
};

/// The facet under a point: contact plane, and how the coordinates of the projection and the normal
/// follow what moves.
///   d xi^i = w^ij [(dx - drho) . rho_j + (x - rho) . drho_j]
/// Inside a facet w = (a_ij - g h_ij)^-1, along an edge of direction e w = e (x) e / slope, at a
/// vertex w = 0.
class FacetFrame {
 public:
  explicit FacetFrame(const PairPoint& p) noexcept
      : jet_(p.master.now),
        facet_(surface::tangent_plane(jet_)),
        interior_(p.feature == Feature::interior) {
    plane.r = jet_.d1;
    plane.apart = p.slave - jet_.position;
    plane.n = facet_.normal;
    if (!interior_) {
      const double sign = plane.apart.dot(facet_.normal) < 0.0 ? -1.0 : 1.0;
      turn_ = sign / plane.apart.norm();
      plane.n = turn_ * plane.apart;
    }
  }

  /// (x - rho) . n
  double gap() const { return plane.apart.dot(plane.n); }
  const surface::Geometry<double>& facet() const { return facet_; }
  bool interior() const { return interior_; }
  /// rho_ij of the facet.
  const Vec3<double>& second(std::size_t i, std::size_t j) const { return jet_.second(i, j); }

  /// Writes the axis along the first direction, of the facet or of the edge, which makes the frame;
  /// returns whether there is one.
  bool start(const PairPoint& p, PlaneAxis& first) noexcept {
    const Vector<double> c =
        p.feature == Feature::edge ? Vector<double>{p.edge} : Vector<double>{{1.0, 0.0}};
    const Vector<Dual<2>> fixed = constant<Dual<2>>(c);
    if (!detail::put_axis<Dual<2>>(jet_, plane.n, fixed, first)) return false;
    plane.t = {first.e, plane.n.cross(first.e)};
    return true;
  }

  void follow(const PairPoint& p) noexcept {
    if (p.feature == Feature::interior) {
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j) h_(i, j) = jet_.second(i, j).dot(plane.n);
      w_ = inverse(facet_.a_co - gap() * h_);
    } else if (p.feature == Feature::edge) {
      const auto& e = p.edge;
      const Vec3<double> along = e[0] * plane.r[0] + e[1] * plane.r[1];
      const Vec3<double> bend = e[0] * e[0] * jet_.second(0, 0) +
                                2.0 * e[0] * e[1] * jet_.second(0, 1) +
                                e[1] * e[1] * jet_.second(1, 1);
      const double slope = along.squaredNorm() - plane.apart.dot(bend);
      w_ = (1.0 / slope) * outer(Vector<double>{e}, Vector<double>{e});
    }
  }

  /// Writes d xi, dg and nu_a.
  void follow(PairSlopes& d) const noexcept {
    d.interior = interior_;
    const Padded r0 = plane.r[0], r1 = plane.r[1], apart = plane.apart, n = plane.n;
    for (std::size_t i = 0; i < 2; ++i) {
      const Padded q = w_(i, 0) * r0 + w_(i, 1) * r1;
      d.form(NearForm::xi, i).by = {q, -q, w_(i, 0) * apart, w_(i, 1) * apart};
    }
    d.form(NearForm::gap).by = {n, -n, {}, {}};
    for (std::size_t a = 0; a < 2; ++a) turn(plane.t[a], a, d);
  }

  /// Replaces what follows by what it follows from.
  void expand(Form& f, const PairSlopes& d) const noexcept {
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < Near::inputs; ++i)
        f.by[i] += f.xi[k] * d.near[k].by[i] + f.turn[k] * d.near[turn_form + k].by[i];
  }

  ContactPlane plane;

 private:
  static constexpr std::size_t turn_form = static_cast<std::size_t>(NearForm::turn);

  /// nu = - (t . rho^j) (n . drho_j + h_jk d xi^k) inside a facet; where n is along x - rho,
  /// nu = t . (dx - drho - rho_j d xi^j) / ((x - rho) . n).
  void turn(const Vec3<double>& t, std::size_t a, PairSlopes& d) const noexcept {
    if (interior_) {
      const Flat c{-t.dot(facet_.dual_basis(0)), -t.dot(facet_.dual_basis(1))};
      const Padded n = plane.n;
      d.put(NearForm::turn, a, {{{}, {}, c[0] * n, c[1] * n}},
            {c[0] * h_(0, 0) + c[1] * h_(1, 0), c[0] * h_(0, 1) + c[1] * h_(1, 1)});
      return;
    }
    const Padded along = turn_ * t;
    d.put(NearForm::turn, a, {{along, -along, {}, {}}},
          {-turn_ * t.dot(plane.r[0]), -turn_ * t.dot(plane.r[1])});
  }

  const surface::Jet<double>& jet_;
  surface::Geometry<double> facet_;
  bool interior_;
  double turn_{0.0};
  CoCo<double> h_{};
  ContraContra<double> w_{};
};

}  // namespace anisocontact::kernel
