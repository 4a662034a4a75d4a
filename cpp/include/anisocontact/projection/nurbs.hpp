#pragma once
// Closest point of a NURBS patch: the tree of its pieces from the nearest box on. A piece that may
// hold a nearer point is searched by Newton's method and halved until the minimum found is shown to
// be its least one. So the closest point is the global one.

#include <algorithm>
#include <array>
#include <cmath>

#include "anisocontact/projection/linearisation.hpp"
#include "anisocontact/projection/minimise.hpp"
#include "anisocontact/projection/rational_distance.hpp"
#include "anisocontact/surface/analytic/nurbs_pieces.hpp"

namespace anisocontact::projection {

/// The polynomials of one pair of spans, seen from a point.
struct NurbsSpan {
  const surface::Nurbs& surface;
  std::array<std::size_t, 2> span;
  Vec3<double> x;

  static constexpr bool triangular() noexcept { return false; }
  Local at(const std::array<double, 2>& xi) const noexcept {
    return local(surface.jet_in(span, xi[0], xi[1]), x);
  }
};

class NurbsSearch {
 public:
  NurbsSearch(const surface::Nurbs& s, const Vec3<double>& x) noexcept
      : surface_(s), pieces_(s.pieces()), domain_(s.domain()), x_(x) {
    const auto& root = pieces_.tree.back().box;
    rounding_ =
        digits * (x.cwiseAbs().maxCoeff() + root.centre.cwiseAbs().maxCoeff() + pieces_.size);
  }

  surface::Foot run(const std::array<double, 2>* guess) noexcept {
    if (guess) bound_by(*guess);
    descend();
    return found_ && !doubtful_ ? classified() : surface::Foot{};
  }

 private:
  using Pair = std::array<double, 2>;

  /// Not farther than the point of the surface at the guess, with room for rounding.
  void bound_by(const Pair& guess) noexcept {
    Pair xi;
    for (std::size_t k = 0; k < 2; ++k)
      xi[k] =
          domain_.periodic[k] ? guess[k] : std::clamp(guess[k], domain_.lower[k], domain_.upper[k]);
    const auto j = surface_.jet(xi[0], xi[1]);
    if (const double d = (j.position - x_).norm(); d >= 0.0) limit_ = (1.0 + apart) * d + rounding_;
  }

  /// Visits the boxes that are not farther than the best point, the nearer of two first.
  void descend() noexcept {
    struct Waiting {
      std::size_t node;
      double distance2;
    };
    std::array<Waiting, most_waiting> stack;
    std::size_t count = 0;
    const auto distance2 = [&](std::size_t i) { return pieces_.tree[i].box.distance2(x_); };
    const std::size_t root = pieces_.tree.size() - 1;
    stack[count++] = {root, distance2(root)};
    while (count > 0) {
      const Waiting w = stack[--count];
      if (std::sqrt(w.distance2) > limit_ + rounding_) continue;
      const auto& piece = pieces_.tree[w.node];
      if (piece.child[0] < 0) {
        search(piece);
        continue;
      }
      const auto a = static_cast<std::size_t>(piece.child[0]),
                 b = static_cast<std::size_t>(piece.child[1]);
      Waiting near{a, distance2(a)}, far{b, distance2(b)};
      if (far.distance2 < near.distance2) std::swap(near, far);
      stack[count++] = far;
      stack[count++] = near;
    }
  }

  /// The least distance over a piece of the tree, by branch and bound on its parts.
  void search(const surface::NurbsPiece& piece) noexcept {
    const NurbsSpan here{surface_, piece.span, x_};
    std::array<RationalDistance, most_halvings + 1> waiting;
    BernsteinTable g;
    std::size_t count = 0;
    waiting[count++].set(piece, {surface_.knots(0).degree(), surface_.knots(1).degree()}, x_);
    const double slack = digits * waiting[0].distance.largest();
    const auto may_beat = [&](const RationalDistance& p, double d) {
      p.less(d, g);
      return g.lowest() <= slack;
    };
    for (std::size_t parts = 0; count > 0; ++parts) {
      RationalDistance& p = waiting[--count];
      if (!may_beat(p, limit_ + rounding_)) continue;
      if (parts >= most_parts || count + 2 > waiting.size()) {
        doubtful_ = doubtful_ || may_beat(p, (1.0 - apart) * limit_);
        continue;
      }
      const Minimum m = minimise(here, p.part, g.where_lowest());
      const Pair xi = p.part.at(m.s);
      const Local l = here.at(xi);
      take(xi, l);
      p.less(l.r.norm(), g);
      if ((m.converged && g.settled()) || g.largest() <= slack) continue;
      const std::size_t k = g.bend(0) >= g.bend(1) ? 0 : 1;
      p.halve(k, waiting[count + 1]);
      count += 2;
    }
  }

  /// Keeps the nearest point. Of points equally near the one with the least coordinates is kept,
  /// whatever the order of the search.
  void take(const Pair& xi, const Local& l) noexcept {
    const double d = l.r.norm();
    if (!(d <= limit_ + rounding_)) return;
    const Vec3<double> position = x_ + l.r;
    const bool same = found_ && (position - position_).norm() <= apart * pieces_.size;
    if (found_ && d >= distance_ - rounding_) {
      if (!same) ambiguous_ = true;
      if (same ? d >= distance_ : xi > xi_) return;
    } else {
      ambiguous_ = false;
    }
    found_ = true;
    xi_ = xi;
    position_ = position;
    distance_ = d;
    limit_ = std::min(limit_, d);
  }

  /// Part of |x - rho| along a coordinate line.
  static double along(const Local& l, std::size_t k) noexcept {
    const double length = (k == 0 ? l.r1 : l.r2).norm();
    return length > 0.0 ? std::abs(k == 0 ? l.g1 : l.g2) / length : 0.0;
  }

  /// Rounding of `along`: the direction of a line that shrinks towards a pole is off by more.
  double blurred(const Local& l, std::size_t k) const noexcept {
    const double length = (domain_.upper[k] - domain_.lower[k]) * (k == 0 ? l.r1 : l.r2).norm();
    return rounding_ * (1.0 + l.r.norm() / length);
  }

  /// A minimum on the border of two pieces is that of one of them to rounding, and one that is
  /// hardly a minimum cannot be found better by distances: Newton steps for a normal x - rho, which
  /// know nothing of borders, finish it. They keep off poles as pieces do.
  void polish() noexcept {
    Local l = local(surface_.jet(xi_[0], xi_[1]), x_);
    for (int step = 0; step < 3; ++step) {
      const double d = l.h11 * l.h22 - l.h12 * l.h12;
      const Pair to{xi_[0] - (l.h22 * l.g1 - l.h12 * l.g2) / d,
                    xi_[1] - (l.h11 * l.g2 - l.h12 * l.g1) / d};
      for (std::size_t k = 0; k < 2; ++k)
        if (!domain_.periodic[k] &&
            !(domain_.lower[k] + cap(k, 0) <= to[k] && to[k] <= domain_.upper[k] - cap(k, 1)))
          return;
      const Local next = local(surface_.jet(to[0], to[1]), x_);
      if (!(along(next, 0) + along(next, 1) < along(l, 0) + along(l, 1))) return;
      if (!(next.r.norm() <= l.r.norm() + rounding_)) return;
      xi_ = to;
      l = next;
    }
  }

  surface::Foot classified() noexcept {
    polish();
    for (std::size_t k = 0; k < 2; ++k)
      if (domain_.periodic[k]) xi_[k] -= domain_.turns(k, xi_[k]);
    const auto jet = surface_.jet(xi_[0], xi_[1]);
    const Local l = local(jet, x_);
    surface::Foot foot{xi_, surface::Status::interior};
    bool pole = false;
    for (std::size_t k = 0; k < 2; ++k) {
      const bool at_pole = is_pole(k);
      const double allowed = (at_pole ? pole_tolerance : normal_tolerance) * l.r.norm();
      foot.fixed[k] = along(l, k) > allowed + blurred(l, k);
      pole = pole || at_pole;
    }
    const auto count = static_cast<std::int64_t>(foot.fixed[0]) + foot.fixed[1];
    foot.status = static_cast<surface::Status>(count);
    if (pole) foot.status = surface::Status::singular;
    if (ambiguous_ || (count == 0 && focal(jet))) foot.status = surface::Status::ambiguous;
    return foot;
  }

  bool is_pole(std::size_t k) const noexcept {
    return xi_[k] - domain_.lower[k] < 2.0 * cap(k, 0) ||
           domain_.upper[k] - xi_[k] < 2.0 * cap(k, 1);
  }

  /// How far a coordinate keeps off one of its ends, where that is a pole.
  double cap(std::size_t k, std::size_t end) const noexcept {
    return pieces_.pole[k][end] ? surface::polar_cap * (domain_.upper[k] - domain_.lower[k]) : 0.0;
  }

  bool focal(const surface::Jet<double>& jet) const noexcept {
    const auto g = surface::geometry(jet);
    const double gap = (x_ - jet.position).dot(g.normal);
    return is_focal(unit<double, Place::contra>() - gap * g.h_mixed);
  }

  static constexpr std::size_t most_waiting = 128, most_halvings = 32, most_parts = 2000;
  /// Relative rounding of distances and of their Bernstein coefficients.
  static constexpr double digits = 16.0 * std::numeric_limits<double>::epsilon();
  /// Fraction of the size from which two points are two, and of the range that polishing may move.
  static constexpr double apart = 1e-6;
  /// Sine of an angle of x - rho to the normal that counts as none: far above rounding, far below
  /// any that matters. At a pole the foot is moved by 1e-8 of the range.
  static constexpr double normal_tolerance = 1e-10, pole_tolerance = 1e-6;

  const surface::Nurbs& surface_;
  const surface::NurbsPieces& pieces_;
  const surface::Domain domain_;
  const Vec3<double> x_;
  double rounding_;  ///< distances that differ by less are equal
  double limit_{std::numeric_limits<double>::infinity()};
  bool found_{false}, ambiguous_{false};
  bool doubtful_{false};  ///< the search of a piece was given up while it could hold a nearer point
  Pair xi_{};
  Vec3<double> position_{Vec3<double>::Zero()};
  double distance_{0.0};
};

inline surface::Foot closest_point(const surface::Nurbs& s, const Vec3<double>& x,
                                   const std::array<double, 2>* guess) noexcept {
  return NurbsSearch(s, x).run(guess);
}

}  // namespace anisocontact::projection
