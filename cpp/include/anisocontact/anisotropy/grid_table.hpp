#pragma once
// Interpolation of lines on a regular grid of two coordinates.

#include <algorithm>
#include <cstddef>
#include <utility>

#include "anisocontact/anisotropy/line.hpp"

namespace anisocontact::anisotropy {

/// Nodes along one coordinate, at distance 1 in the grid's own measure.
struct GridLine {
  double lower{0.0}, spacing{1.0};
  std::size_t count{0};
  bool periodic{false};

  /// The node `steps` from node i; on a periodic line it wraps.
  std::size_t node(std::size_t i, int steps) const {
    const auto n = static_cast<std::ptrdiff_t>(count);
    const auto k = static_cast<std::ptrdiff_t>(i) + steps;
    return static_cast<std::size_t>(periodic ? (k % n + n) % n : k);
  }
};

/// Cell of a coordinate and the place in it, t from 0 to 1.
template <class S>
struct Cell {
  std::array<std::size_t, 2> node{};
  S t{};
  bool inside{true};
};

/// The cell that `xi` is in; beyond the end of an open line by more than rounding there is none.
template <class S>
Cell<S> locate(const GridLine& l, const S& xi) {
  constexpr double rounding = 1e-9;  // of a cell
  const S u = (xi - S(l.lower)) / S(l.spacing);
  const double v = value(u), whole = std::floor(v);
  if (l.periodic) {
    const double n = static_cast<double>(l.count);
    const auto low = static_cast<std::size_t>(whole - n * std::floor(whole / n)) % l.count;
    return {{low, l.node(low, 1)}, u - S(whole), true};
  }
  const double last = static_cast<double>(l.count - 1);
  if (!(v >= -rounding && v <= last + rounding)) return {{}, S(0.0), false};
  const double from = std::clamp(whole, 0.0, last - 1.0);
  const auto low = static_cast<std::size_t>(from);
  return {{low, low + 1}, u - S(from), true};
}

/// Tables of v (x) v at the nodes; for bicubic interpolation with the slopes along both
/// coordinates and the mixed one, by differences of fourth order.
class GridTable {
 public:
  using Directions = std::vector<Vec3<double>>;

  GridTable(const std::array<GridLine, 2>& lines, std::vector<Directions> directions, bool cubic)
      : lines_(lines), directions_(std::move(directions)), kinds_(cubic ? 4 : 1) {
    const std::size_t nodes = lines_[0].count * lines_[1].count;
    data_.resize(nodes * tables() * kinds_);
    for (std::size_t n = 0; n < nodes; ++n)
      for (std::size_t a = 0; a < tables(); ++a) at(n, a, 0) = line_of(directions_[a][n]);
    if (!cubic) return;
    slopes(0, 0, 1);
    slopes(1, 0, 2);
    slopes(1, 1, 3);
  }

  std::size_t tables() const { return directions_.size(); }
  const GridLine& line(std::size_t i) const { return lines_[i]; }

  /// Interpolated v (x) v: piecewise bilinear, or bicubic with continuous slopes.
  template <class S>
  Line<S> interpolate(const std::array<Cell<S>, 2>& cell, std::size_t table) const {
    const auto u = weights(cell[0].t), v = weights(cell[1].t);
    Line<S> sum;
    sum.fill(S(0.0));
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t k = 0; k < kinds_; ++k) {
          const S w = u[k % 2][i] * v[k / 2][j];
          const auto& l = at(number(cell[0].node[i], cell[1].node[j]), table, k);
          for (std::size_t c = 0; c < 6; ++c) sum[c] += w * S(l[c]);
        }
    return sum;
  }

  /// Direction at the node nearest to a place in a cell.
  template <class S>
  const Vec3<double>& nearest(const std::array<Cell<S>, 2>& cell, std::size_t table) const {
    const auto side = [&](std::size_t i) { return cell[i].node[value(cell[i].t) < 0.5 ? 0 : 1]; };
    return directions_[table][number(side(0), side(1))];
  }

 private:
  std::size_t number(std::size_t i, std::size_t j) const { return i * lines_[1].count + j; }
  Line<double>& at(std::size_t node, std::size_t table, std::size_t kind) {
    return data_[(node * tables() + table) * kinds_ + kind];
  }
  const Line<double>& at(std::size_t node, std::size_t table, std::size_t kind) const {
    return data_[(node * tables() + table) * kinds_ + kind];
  }

  /// Weights of the values (first row) and of the slopes (second row) at the two ends of a cell.
  template <class S>
  std::array<std::array<S, 2>, 2> weights(const S& t) const {
    const S one(1.0), r = one - t;
    if (kinds_ == 1) return {{{r, t}, {S(0.0), S(0.0)}}};
    return {{{r * r * (one + S(2.0) * t), t * t * (one + S(2.0) * r)}, {r * r * t, -(t * t * r)}}};
  }

  /// Fills kind `to` with the slope of kind `from` along `direction`.
  void slopes(std::size_t direction, std::size_t from, std::size_t to) {
    const GridLine& l = lines_[direction];
    for (std::size_t i = 0; i < lines_[0].count; ++i)
      for (std::size_t j = 0; j < lines_[1].count; ++j) {
        const std::size_t k = direction == 0 ? i : j;
        const Stencil s = stencil(l, k);
        for (std::size_t a = 0; a < tables(); ++a) {
          Line<double> sum{};
          for (std::size_t p = 0; p < s.weight.size(); ++p) {
            const std::size_t m = l.node(k, s.first + static_cast<int>(p));
            const auto& f = at(direction == 0 ? number(m, j) : number(i, m), a, from);
            for (std::size_t c = 0; c < 6; ++c) sum[c] += s.weight[p] * f[c];
          }
          at(number(i, j), a, to) = sum;
        }
      }
  }

  /// First difference of fourth order over five nodes, the first of them `first` from the node.
  struct Stencil {
    int first;
    std::array<double, 5> weight;
  };
  static Stencil stencil(const GridLine& l, std::size_t k) {
    constexpr double t = 1.0 / 12.0;
    const std::size_t last = l.count - 1;
    if (l.periodic || (k >= 2 && k + 2 <= last)) return {-2, {t, -8 * t, 0.0, 8 * t, -t}};
    if (k == 0) return {0, {-25 * t, 48 * t, -36 * t, 16 * t, -3 * t}};
    if (k == 1) return {-1, {-3 * t, -10 * t, 18 * t, -6 * t, t}};
    if (k == last) return {-4, {3 * t, -16 * t, 36 * t, -48 * t, 25 * t}};
    return {-3, {-t, 6 * t, -18 * t, 10 * t, 3 * t}};
  }

  std::array<GridLine, 2> lines_;
  std::vector<Directions> directions_;
  std::size_t kinds_;
  std::vector<Line<double>> data_;
};

}  // namespace anisocontact::anisotropy
