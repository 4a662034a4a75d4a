#pragma once
// One slave point against a facet of a deforming master: kinematics -> law -> traction, and its
// exact derivatives with respect to everything that moves.
//
// The facet enters through its position and first derivatives at fixed coordinates, rho, rho_1,
// rho_2, which are linear in its nodes; so do the committed point of the master and the tangents of
// the slave. The coordinates of the projection follow from these by the implicit function theorem.

#include "anisocontact/kernel/forms.hpp"

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
  bool mirrored{false};          ///< whether directions turn about the inward normal
};

struct PairResult {
  Vec3<double> traction{Vec3<double>::Zero()};  ///< on the slave
  std::array<Eigen::Matrix3d, inputs> d_traction;
  std::array<Eigen::Matrix<double, 2, 3>, 4> d_xi;  ///< by the first four inputs
  Vec3<double> normal{Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> adhesion_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  std::array<Vec3<double>, 2> friction_axes{Vec3<double>::Zero(), Vec3<double>::Zero()};
  PointState state{};
  Failure failure{Failure::none};
};

/// The facet under a point: contact plane, and how the coordinates of the projection and the normal
/// follow what moves.
///   d xi^i = w^ij [(dx - drho) . rho_j + (x - rho) . drho_j]
/// Inside a facet w = (a_ij - g h_ij)^-1, along an edge of direction e w = e (x) e / slope, at a
/// vertex w = 0.
class Footing {
 public:
  explicit Footing(const PairPoint& p) noexcept
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

  /// Axis along the first direction: of the facet, or of the edge. It makes the frame.
  std::optional<PlaneAxis> start(const PairPoint& p) noexcept {
    const Vector<double> c =
        p.feature == Feature::edge ? Vector<double>{p.edge} : Vector<double>{{1.0, 0.0}};
    const Vector<Dual<2>> fixed = constant<Dual<2>>(c);
    const auto first = detail::plane_axis<Dual<2>>(jet_, plane.n, fixed);
    if (first) plane.t = {first->e, plane.n.cross(first->e)};
    return first;
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

  /// Replaces what follows by what it follows from.
  void expand(Form& f) const noexcept {
    expand_turn(f);
    const Flat k{w_(0, 0) * f.xi[0] + w_(1, 0) * f.xi[1], w_(0, 1) * f.xi[0] + w_(1, 1) * f.xi[1]};
    const Vec3<double> q = k[0] * plane.r[0] + k[1] * plane.r[1];
    f[Input::slave] += q;
    f[Input::position] -= q;
    for (std::size_t j = 0; j < 2; ++j) f.by[tangent_input(j)] += k[j] * plane.apart;
  }

  /// d xi by the first four inputs.
  void shift(std::array<Eigen::Matrix<double, 2, 3>, 4>& d) const noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Vec3<double> q = w_(i, 0) * plane.r[0] + w_(i, 1) * plane.r[1];
      d[0].row(row) = q;
      d[1].row(row) = -q;
      for (std::size_t j = 0; j < 2; ++j) d[2 + j].row(row) = w_(i, j) * plane.apart;
    }
  }

  ContactPlane plane;

 private:
  /// nu_a = - (t_a . rho^j) (n . drho_j + h_jk d xi^k) inside a facet; where n is along x - rho,
  /// nu_a = t_a . (dx - drho - rho_j d xi^j) / ((x - rho) . n).
  void expand_turn(Form& f) const noexcept {
    const Vec3<double> k = plane.spatial(f.turn);
    if (interior_) {
      for (std::size_t j = 0; j < 2; ++j) {
        const double c = -k.dot(facet_.dual_basis(j));
        f.by[tangent_input(j)] += c * plane.n;
        for (std::size_t i = 0; i < 2; ++i) f.xi[i] += c * h_(j, i);
      }
      return;
    }
    f[Input::slave] += turn_ * k;
    f[Input::position] -= turn_ * k;
    for (std::size_t i = 0; i < 2; ++i) f.xi[i] -= turn_ * k.dot(plane.r[i]);
  }

  const surface::Jet<double>& jet_;
  surface::Geometry<double> facet_;
  bool interior_;
  double turn_{0.0};
  CoCo<double> h_{};
  ContraContra<double> w_{};
};

namespace detail {

/// Axes of fields at a point, with the reference planes of both bodies where they are needed.
template <bool tangent>
class PairAxes {
 public:
  PairAxes(const PairPoint& p, const Vec3<double>& n, const PlaneAxis& start) noexcept
      : point_(p), n_(n), start_(start), turns_(p.mirrored ? -1.0 : 1.0) {}

  /// Without a field, along the first direction.
  PlaneAxes operator()(const Directions& d) noexcept {
    if (!d.field) return with_normal(start_, n_);
    if (d.side == Side::master) {
      if (!master_) master_.emplace(point_.master, turns_);
      return carried(*d.field, *master_, n_, d.side);
    }
    if (!own_) own_.emplace(point_.own, turns_ * orientation(point_.own, n_));
    return carried(*d.field, *own_, n_, d.side);
  }

 private:
  const PairPoint& point_;
  const Vec3<double>& n_;
  const PlaneAxis& start_;
  double turns_;
  std::optional<ReferencePlane<std::conditional_t<tangent, Dual<2>, double>>> master_;
  std::optional<ReferencePlane<double>> own_;
};

}  // namespace detail

/// Pure update of one slave point against a facet; with `tangent` all derivatives of a point that
/// touches. Those of others are not written.
template <bool tangent>
PairResult update_pair(const InterfaceLaw& law, const PointState& state, const PairPoint& p,
                       double dt) noexcept {
  PairResult out;
  out.state = lasting(state);
  if (p.feature == Feature::off) return out;
  Footing foot(p);
  const ContactPlane& plane = foot.plane;
  out.normal = plane.n;
  out.state.facet = p.facet;
  out.state.xi = out.state.origin = p.master.xi;
  const double gap = foot.gap() - state.offset;
  out.state.gap = gap;
  const Dual<1> pressure = detail::pressure_of(law, state, gap, dt);
  if (!(pressure.v > 0.0)) return out;
  out.traction = pressure.v * plane.n;
  const auto fail = [&](Failure why) {
    out.failure = why;
    out.state = state;
    out.state.facet = p.facet;
    return out;
  };
  const auto start = foot.start(p);
  if (!start) return fail(Failure::direction);
  detail::PairAxes<tangent> axes_at(p, plane.n, *start);
  const LawAxes axes = law_axes(law, axes_at);
  if (!axes.valid()) return fail(Failure::direction);
  put_axes(axes, out.adhesion_axes, out.friction_axes);
  const auto before = surface::tangent_plane(p.before);
  std::optional<CommittedPoint> history;
  if (state.facet >= 0) history.emplace(plane, before, p.master.now.position);
  const CommittedPoint* committed = history ? &*history : nullptr;
  const FrameInput in = frame_input(gap, dt, pressure, state, committed, axes, plane);
  const FrameReaction r = react_in_frame<tangent>(law, state, in);
  if (r.failure != Failure::none) return fail(r.failure);
  out.state = in_basis(r, state, p.master.xi, plane, foot.facet());
  out.state.facet = p.facet;
  out.traction += plane.spatial(r.traction);
  if constexpr (tangent) {
    foot.follow(p);
    auto forms = traction_forms(r, in, axes, plane, state, committed);
    for (Form& f : forms) foot.expand(f);
    for (std::size_t i = 0; i < inputs; ++i)
      out.d_traction[i] = plane.t[0] * forms[0].by[i].transpose() +
                          plane.t[1] * forms[1].by[i].transpose() +
                          plane.n * forms[2].by[i].transpose();
    foot.shift(out.d_xi);
  }
  return out;
}

}  // namespace anisocontact::kernel
