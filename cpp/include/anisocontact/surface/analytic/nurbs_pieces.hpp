#pragma once
// A NURBS patch cut into pieces that are nearly flat, in a tree of boxes.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "anisocontact/surface/analytic/nurbs.hpp"
#include "anisocontact/surface/analytic/oriented_box.hpp"

namespace anisocontact::surface {

/// A node of the tree; a leaf is a piece of one polynomial patch.
struct NurbsPiece {
  OrientedBox box;
  std::array<double, 2> lower{}, upper{};
  std::array<std::size_t, 2> span{};
  std::array<std::int32_t, 2> child{-1, -1};
  std::vector<Nurbs::Point> net;  ///< Bezier points of a leaf, the second coordinate runs fastest
};

struct NurbsPieces {
  std::vector<NurbsPiece> tree;  ///< the root is the last
  double size{0.0};              ///< diagonal of the root's box
  /// Ends of a coordinate where a line of the other one is a point; pieces keep off by `polar_cap`.
  std::array<std::array<bool, 2>, 2> pole{};
};

/// Builds the tree from the Bezier points of pieces: with positive weights a piece lies in their
/// convex hull.
class PieceBuilder {
 public:
  explicit PieceBuilder(const Nurbs& s) : surface_(s) {
    for (std::size_t k = 0; k < 2; ++k)
      for (const std::size_t span : s.knots(k).spans())
        cells_[k].push_back({span, s.knots(k)[span], s.knots(k)[span + 1]});
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t end = 0; end < 2; ++end) keep_off_pole(k, end);
    grid(0, cells_[0].size(), 0, cells_[1].size());
    result_.size = 2.0 * result_.tree.back().box.half.norm();
  }

  NurbsPieces take() { return std::move(result_); }

 private:
  struct Cell {
    std::size_t span;
    double lower, upper;
  };
  using Net = std::vector<Nurbs::Point>;  // as in Nurbs, of one piece

  /// Nearly flat: the Bezier points leave the chord by at most this fraction of its length. It
  /// decides on the speed of a search alone, not on its result.
  static constexpr double flat = 1.0 / 8.0;
  static constexpr int most_cuts = 12;

  static Vec3<double> euclidean(const Nurbs::Point& p) { return p.head<3>() / p[3]; }

  void keep_off_pole(std::size_t k, std::size_t end) {
    const Knots& along = surface_.knots(1 - k);
    const Cell& last = end == 0 ? cells_[k].front() : cells_[k].back();
    const double at = end == 0 ? last.lower : last.upper;
    Vec3<double> low = Vec3<double>::Constant(Domain::infinity), high = -low;
    double reach = 0.0;
    for (const Cell& c : cells_[1 - k])
      for (std::size_t i = 0; i <= along.degree(); ++i) {
        const double f = static_cast<double>(i) / static_cast<double>(along.degree());
        const double t = c.lower + f * (c.upper - c.lower);
        const Vec3<double> x = (k == 0 ? surface_.jet_in({last.span, c.span}, at, t)
                                       : surface_.jet_in({c.span, last.span}, t, at))
                                   .position;
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
        reach = std::max(reach, x.cwiseAbs().maxCoeff());
      }
    for (std::size_t i = 0; i < surface_.knots(0).count(); ++i)
      for (std::size_t j = 0; j < surface_.knots(1).count(); ++j)
        reach = std::max(reach, euclidean(surface_.control(i, j)).cwiseAbs().maxCoeff());
    if ((high - low).norm() > 1e-12 * reach) return;
    result_.pole[k][end] = true;
    const double cap = polar_cap * (surface_.knots(k).upper() - surface_.knots(k).lower());
    if (end == 0)
      cells_[k].front().lower += cap;
    else
      cells_[k].back().upper -= cap;
  }

  /// Tree over a block of cells.
  std::int32_t grid(std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    if (i1 - i0 == 1 && j1 - j0 == 1) {
      const Cell &a = cells_[0][i0], &b = cells_[1][j0];
      NurbsPiece p;
      p.lower = {a.lower, b.lower};
      p.upper = {a.upper, b.upper};
      p.span = {a.span, b.span};
      return cut(p, 0);
    }
    if (i1 - i0 >= j1 - j0) {
      const std::size_t half = (i0 + i1) / 2;
      const auto left = grid(i0, half, j0, j1);
      return join(left, grid(half, i1, j0, j1));
    }
    const std::size_t half = (j0 + j1) / 2;
    const auto left = grid(i0, i1, j0, half);
    return join(left, grid(i0, i1, half, j1));
  }

  /// Tree over one piece, cut until it is nearly flat.
  std::int32_t cut(NurbsPiece p, int cuts) {
    Net net = bezier(p);
    const auto bend = std::array<double, 2>{deviation(net, 0), deviation(net, 1)};
    if (cuts < most_cuts && std::max(bend[0], bend[1]) > flat) {
      const std::size_t k = bend[0] >= bend[1] ? 0 : 1;
      NurbsPiece left = p, right = p;
      left.upper[k] = right.lower[k] = 0.5 * (p.lower[k] + p.upper[k]);
      const auto first = cut(left, cuts + 1);
      return join(first, cut(right, cuts + 1));
    }
    std::vector<Vec3<double>> points;
    for (const auto& c : net) points.push_back(euclidean(c));
    const std::size_t row = surface_.knots(1).degree() + 1;
    const Vec3<double>&a = points[0], &b = points[row - 1], &c = points[points.size() - row],
          &d = points.back();
    p.box = OrientedBox(axes_along(c + d - a - b, b + d - a - c), points);
    p.net = std::move(net);
    return add(std::move(p));
  }

  std::int32_t join(std::int32_t left, std::int32_t right) {
    const auto &a = result_.tree[static_cast<std::size_t>(left)].box,
               &b = result_.tree[static_cast<std::size_t>(right)].box;
    auto corners = a.corners();
    for (const auto& c : b.corners()) corners.push_back(c);
    NurbsPiece p;
    p.child = {left, right};
    p.box = OrientedBox(a.axes, corners);
    const OrientedBox other(b.axes, corners);
    if (other.half.sum() < p.box.half.sum()) p.box = other;
    return add(std::move(p));
  }

  std::int32_t add(NurbsPiece p) {
    result_.tree.push_back(std::move(p));
    return static_cast<std::int32_t>(result_.tree.size()) - 1;
  }

  /// Bezier points of a piece: blossoms along the second coordinate, then along the first.
  Net bezier(const NurbsPiece& piece) const {
    const std::size_t p = surface_.knots(0).degree(), q = surface_.knots(1).degree();
    Net rows((p + 1) * (q + 1)), net(rows.size());
    std::array<Nurbs::Point, most_degree + 1> c;
    std::array<double, most_degree> t;
    for (std::size_t i = 0; i <= p; ++i)
      for (std::size_t j = 0; j <= q; ++j) {
        std::copy_n(&surface_.control(piece.span[0] - p + i, piece.span[1] - q), q + 1, c.begin());
        std::fill_n(t.begin(), q - j, piece.lower[1]);
        std::fill_n(t.begin() + static_cast<std::ptrdiff_t>(q - j), j, piece.upper[1]);
        rows[i * (q + 1) + j] = surface_.knots(1).blossom(piece.span[1], t.data(), c.data());
      }
    for (std::size_t j = 0; j <= q; ++j)
      for (std::size_t i = 0; i <= p; ++i) {
        for (std::size_t k = 0; k <= p; ++k) c[k] = rows[k * (q + 1) + j];
        std::fill_n(t.begin(), p - i, piece.lower[0]);
        std::fill_n(t.begin() + static_cast<std::ptrdiff_t>(p - i), i, piece.upper[0]);
        net[i * (q + 1) + j] = surface_.knots(0).blossom(piece.span[0], t.data(), c.data());
      }
    return net;
  }

  /// How far the Bezier points of the lines of a coordinate leave evenly spaced points of their
  /// chords, over the longest chord.
  double deviation(const Net& net, std::size_t k) const {
    const std::size_t q = surface_.knots(1).degree();
    const std::size_t n = surface_.knots(k).degree(), lines = surface_.knots(1 - k).degree() + 1;
    double away = 0.0, chord = 0.0, reach = 0.0;
    for (std::size_t line = 0; line < lines; ++line) {
      const auto at = [&](std::size_t i) {
        return euclidean(k == 0 ? net[i * (q + 1) + line] : net[line * (q + 1) + i]);
      };
      const Vec3<double> first = at(0), last = at(n);
      chord = std::max(chord, (last - first).norm());
      reach = std::max(reach, first.cwiseAbs().maxCoeff());
      for (std::size_t i = 1; i < n; ++i) {
        const double f = static_cast<double>(i) / static_cast<double>(n);
        away = std::max(away, (at(i) - (1.0 - f) * first - f * last).norm());
      }
    }
    return away <= 1e-13 * reach ? 0.0 : away / chord;
  }

  const Nurbs& surface_;
  std::array<std::vector<Cell>, 2> cells_;
  NurbsPieces result_;
};

inline Nurbs::Nurbs(const Knots& knots_1, const Knots& knots_2, std::vector<Point> net)
    : knots_{knots_1, knots_2}, net_(std::move(net)) {
  domain_.lower = {knots_1.lower(), knots_2.lower()};
  domain_.upper = {knots_1.upper(), knots_2.upper()};
  domain_.periodic = {closes(0), closes(1)};
  pieces_ = std::make_shared<const NurbsPieces>(PieceBuilder(*this).take());
}

/// Whether position and first derivatives at both ends of a coordinate agree.
inline bool Nurbs::closes(std::size_t i) const {
  const Knots &k = knots_[i], &other = knots_[1 - i];
  const double range = k.upper() - k.lower();
  double gap = 0.0, length = 0.0;
  for (const std::size_t span : other.spans())
    for (std::size_t n = 0; n <= other.degree(); ++n) {
      const double f = static_cast<double>(n) / static_cast<double>(other.degree());
      const double t = (1.0 - f) * other[span] + f * other[span + 1];
      const auto at = [&](double u) {
        const std::size_t mine = k.span(u);
        return i == 0 ? jet_in({mine, span}, u, t) : jet_in({span, mine}, t, u);
      };
      const auto a = at(k.lower()), b = at(k.upper());
      length = std::max(length, range * (a.d1[i].norm() + b.d1[i].norm()));
      gap = std::max({gap, (a.position - b.position).norm(), range * (a.d1[i] - b.d1[i]).norm()});
    }
  constexpr double same = 1e-10;
  return gap <= same * length;
}

inline Nurbs Nurbs::make(const Values& v) {
  const auto& degrees = v.pair("degrees");
  const auto degree = [&](std::size_t k) { return static_cast<std::size_t>(degrees[k]); };
  const Knots a(degree(0), v.list("knots_1"), "knots_1"),
      b(degree(1), v.list("knots_2"), "knots_2");
  const auto &points = v.list("points"), &weights = v.list("weights");
  const std::size_t n = a.count(), m = b.count();
  const std::string net = std::to_string(n) + " x " + std::to_string(m);
  if (points.size() != 3 * n * m)
    throw std::invalid_argument("points has " + std::to_string(points.size()) +
                                " numbers, the knots and degrees need 3 x " + net);
  if (!weights.empty() && weights.size() != n * m)
    throw std::invalid_argument("weights has " + std::to_string(weights.size()) +
                                " numbers, the knots and degrees need " + net);
  const bool flip = v.flag("flip");
  std::vector<Point> control(n * m);
  for (std::size_t i = 0; i < n * m; ++i) {
    const double w = weights.empty() ? 1.0 : weights[i];
    const std::size_t to = flip ? (n - 1 - i / m) * m + i % m : i;
    control[to] = {w * points[3 * i], w * points[3 * i + 1], w * points[3 * i + 2], w};
  }
  return {flip ? a.reversed() : a, b, std::move(control)};
}

}  // namespace anisocontact::surface
