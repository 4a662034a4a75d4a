#pragma once
// The committed point of the master as a law sees it from where the point is now: slip, and what is
// remembered there; with the linear forms in what moves.

#include "anisocontact/kernel/spin.hpp"

namespace anisocontact::kernel {

/// Slopes of a number by what a law sees of the committed point.
struct CommittedSlopes {
  Flat increment, stored, elastic;
  Flat axes;  ///< by the angles of the committed axes of adhesion
};

/// Slip, and what is remembered, turned with the normal onto the contact plane (parallel transport):
/// turned(w) = w - c (n_0 + n), c = w . n / (1 + n_0 . n). Components in the basis b_i of the committed
/// point are kept, so that all but the stored force, whose components are covariant, follows from
/// the two turned tangents.
class CommittedPoint {
 public:
  /// `own`: the slave, if it is known; `halfway`: slip as of `Transport`, else of `BackwardEuler`.
  ANISOCONTACT_INLINE CommittedPoint(const ContactPlane& plane,
                                     const surface::Geometry<double>& before,
                                     const Vec3<double>& now, const PointState& state,
                                     const Carrier* own, bool halfway)
      : plane_(plane),
        state_(state),
        normal_(before.normal),
        dual_{before.dual_basis(0), before.dual_basis(1)},
        cosine_(before.normal.dot(plane.n)),
        share_(1.0 / (1.0 + cosine_)),
        n0_(plane.along(before.normal)),
        way_(now - before.jet.position),
        remembers_(kernel::remembers(state)),
        has_axes_(remembers_ && has_pair(state.axes)),
        halfway_(halfway) {
    for (std::size_t a = 0; a < 2; ++a) lean_[a] = plane.t[a] - n0_[a] * share_ * plane.n;
    if (remembers_) remember(before);
    if (remembers_ && own != nullptr && has_pair(state.slave))
      spin_.emplace(plane, *own, SlaveFrame({slave_tangent(0), slave_tangent(1)}));
    put_slip();
  }

  /// Whether there is more to remember than the place.
  bool remembers() const { return remembers_; }
  /// Whether the step looks at both of its ends.
  bool halfway() const { return halfway_; }
  /// Whether there are committed axes that count.
  bool looks_back() const { return has_axes_ && halfway_; }
  const Flat& increment() const { return slip_; }
  Flat stored() const { return turned(stored_.upper); }
  Flat elastic() const { return turned(state_.elastic); }

  /// Axes halfway from the committed ones to those of now; either sense of an axis is the same.
  std::array<Flat, 2> axes_halfway(const std::array<Flat, 2>& now) const {
    std::array<Flat, 2> mean;
    for (std::size_t k = 0; k < 2; ++k) {
      const Flat old = turned(state_.axes, k);
      const double sense = detail::inner(old, now[k]) < 0.0 ? -1.0 : 1.0;
      const double scale = sense / std::sqrt(detail::inner(old, old));
      const Flat sum{now[k][0] + scale * old[0], now[k][1] + scale * old[1]};
      const double inverse = 1.0 / std::sqrt(detail::inner(sum, sum));
      mean[k] = {inverse * sum[0], inverse * sum[1]};
    }
    return mean;
  }

  /// Turn of the slave about the normal.
  double spin() const { return spin_ ? spin_->angle() : 0.0; }
  /// The largest angle by which normal, axes or slave have turned.
  double turn(const std::array<Flat, 2>& axes) const {
    double square = std::max(2.0 - 2.0 * cosine_, 0.0);  // of a chord of the unit circle
    for (std::size_t k = 0; k < 2 && has_axes_; ++k) {
      const Flat old = turned(state_.axes, k);
      const double along =
          std::abs(detail::inner(old, axes[k])) / std::sqrt(detail::inner(old, old));
      square = std::max(square, 2.0 - 2.0 * along);
    }
    return std::max(2.0 * std::asin(std::min(0.5 * std::sqrt(square), 1.0)), std::abs(spin()));
  }

  /// Adds the change of a number.
  void add(const CommittedSlopes& k, Form& f) const {
    std::array<Flat, 2> by_basis{};  // by the turned tangents
    Flat by_chord = k.increment;
    if (spin_ && halfway_) {
      by_chord = spin_->by_chord(k.increment);
      std::array<Flat, 2> by_slave;
      spin_->add(k.increment, chord_, by_slave, f);
      for (std::size_t i = 0; i < 2; ++i)
        put(by_slave[i], {state_.slave[2 * i], state_.slave[2 * i + 1]}, by_basis);
    }
    add_chord(by_chord, f);
    if (!remembers_) return;
    put(k.elastic, state_.elastic, by_basis);
    for (std::size_t i = 0; i < 2 && looks_back(); ++i) put_axis(k.axes[i], i, by_basis);
    add_stored(k.stored, f);
    for (std::size_t i = 0; i < 2; ++i)
      if (by_basis[i] != Flat{}) add_tangent(by_basis[i], i, f);
  }

 private:
  /// The stored force as a vector of the committed tangent plane.
  struct Stored {
    Vec3<double> w{Vec3<double>::Zero()};
    Flat upper{};      ///< w . b^i
    double fall{0.0};  ///< c
  };

  ANISOCONTACT_INLINE void remember(const surface::Geometry<double>& before) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Vec3<double>& b = before.jet.d1[i];
      fall_[i] = share_ * b.dot(plane_.n);
      const Flat along = plane_.along(b);
      turned_[i] = {along[0] - fall_[i] * n0_[0], along[1] - fall_[i] * n0_[1]};
    }
    Stored& s = stored_;
    s.upper = (before.a_contra * Covector<double>{state_.stored}).c;
    s.w = s.upper[0] * before.jet.d1[0] + s.upper[1] * before.jet.d1[1];
    s.fall = s.upper[0] * fall_[0] + s.upper[1] * fall_[1];
  }
  Flat turned(const Flat& upper) const {
    return {upper[0] * turned_[0][0] + upper[1] * turned_[1][0],
            upper[0] * turned_[0][1] + upper[1] * turned_[1][1]};
  }
  Flat turned(const KeptPair& kept, std::size_t i) const {
    return turned({kept[2 * i], kept[2 * i + 1]});
  }

  /// A committed tangent of the slave in the frame of the contact plane.
  Vec3<double> slave_tangent(std::size_t i) const {
    const Flat along = turned(state_.slave, i);
    return {along[0], along[1], state_.slave_rise[i]};
  }

  /// The chord as the path that it spans, see `ArcOfNormals`: n_0 along the plane is nu.
  ANISOCONTACT_INLINE void put_slip() {
    flat_ = plane_.along(way_);
    rise_ = way_.dot(plane_.n);
    if (halfway_) arc_ = ArcOfNormals(cosine_);
    along_ = detail::inner(n0_, flat_);
    dip_ = arc_.a * rise_ + arc_.b * along_;
    chord_ = {flat_[0] - dip_ * n0_[0], flat_[1] - dip_ * n0_[1]};
    slip_ = spin_ && halfway_ ? spin_->path(chord_) : chord_;
  }

  /// k_a d(chord_a), by the change of the way, of the normal and of the committed normal.
  void add_chord(const Flat& k, Form& f) const {
    const double lean = detail::inner(k, n0_), by_along = lean * arc_.b, by_rise = lean * arc_.a;
    const Flat by_flat{k[0] - by_along * n0_[0], k[1] - by_along * n0_[1]};
    const Flat by_nu{-dip_ * k[0] - by_along * flat_[0], -dip_ * k[1] - by_along * flat_[1]};
    const double by_cosine = -lean * (arc_.da * rise_ + arc_.db * along_);
    const Vec3<double> by_way = plane_.spatial(by_flat) - by_rise * plane_.n,
                       by_before = plane_.spatial(by_nu) + by_cosine * plane_.n;
    f[Input::position] += by_way;
    f[Input::before_position] -= by_way;
    for (std::size_t i = 0; i < 2; ++i) {
      f.xi[i] += by_way.dot(plane_.r[i]);
      f.turn[i] +=
          by_cosine * n0_[i] - by_nu[i] * cosine_ - by_flat[i] * rise_ - by_rise * flat_[i];
      f.by[before_input(i)].add(-by_before.dot(dual_[i]), normal_);
    }
  }

  /// Slopes by a vector of kept components as slopes by the two turned tangents.
  static void put(const Flat& k, const Flat& upper, std::array<Flat, 2>& by_basis) {
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t a = 0; a < 2; ++a) by_basis[i][a] += upper[i] * k[a];
  }
  /// The same of the angle of a committed axis.
  void put_axis(double k, std::size_t i, std::array<Flat, 2>& by_basis) const {
    if (k == 0.0) return;
    const Flat old = turned(state_.axes, i);
    put(detail::turned_by(0.0, k / detail::inner(old, old), old),
        {state_.axes[2 * i], state_.axes[2 * i + 1]}, by_basis);
  }

  /// Of w = lower_i b^i: d b^i = - (b^i . d b_j) b^j + a^ij (n_0 . d b_j) n_0.
  void add_stored(const Flat& k, Form& f) const {
    const Stored& m = stored_;
    const Vec3<double> y = add_turn(k, turned(m.upper), m.fall, f);
    const double up = y.dot(normal_);
    for (std::size_t j = 0; j < 2; ++j) {
      const double stretch = y.dot(dual_[j]);
      f.by[before_input(j)].add(m.fall * stretch + m.upper[j] * up, normal_);
      f.by[before_input(j)].add(-stretch, m.w);
    }
  }
  /// Of the turned tangent b_i.
  void add_tangent(const Flat& k, std::size_t i, Form& f) const {
    const Vec3<double> y = add_turn(k, turned_[i], fall_[i], f);
    for (std::size_t j = 0; j < 2; ++j)
      f.by[before_input(j)].add(fall_[i] * y.dot(dual_[j]), normal_);
    f.by[before_input(i)] += y;
  }
  /// What all turned vectors have in common besides dn_0 = - b^j (n_0 . d b_j), which adds
  /// c (y . b^j) n_0. Returns y, the vector that dw is multiplied by.
  Vec3<double> add_turn(const Flat& k, const Flat& there, double fall, Form& f) const {
    const double side = share_ * detail::inner(k, n0_);
    for (std::size_t a = 0; a < 2; ++a) f.turn[a] -= fall * k[a] + side * there[a];
    return k[0] * lean_[0] + k[1] * lean_[1];
  }

  const ContactPlane& plane_;
  const PointState& state_;
  Vec3<double> normal_;
  std::array<Vec3<double>, 2> dual_;
  double cosine_, share_;
  Flat n0_;
  Vec3<double> way_;
  bool remembers_, has_axes_, halfway_;
  std::array<Vec3<double>, 2> lean_;
  std::array<Flat, 2> turned_{};
  Flat fall_{};
  Stored stored_;
  std::optional<RelativeSpin> spin_;
  ArcOfNormals arc_;
  Flat flat_, chord_, slip_;
  double rise_, along_, dip_;
};

}  // namespace anisocontact::kernel
