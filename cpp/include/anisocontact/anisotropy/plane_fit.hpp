#pragma once
// Weighted least squares of a plane through tabulated lines.

#include "anisocontact/anisotropy/line.hpp"

namespace anisocontact::anisotropy {

/// The fit at u = v = 0 of up to two tables; u, v are coordinates along two tangents, of size 1.
template <class S>
class PlaneFit {
 public:
  PlaneFit() {
    moment_.fill(S(0.0));
    for (auto& t : right_)
      for (auto& l : t) l.fill(S(0.0));
  }

  /// Adds a point of weight w at (u, v).
  void add(const S& w, const S& u, const S& v) {
    basis_ = {w, w * u, w * v};
    moment_[0] += w;
    moment_[1] += basis_[1];
    moment_[2] += basis_[2];
    moment_[3] += basis_[1] * u;
    moment_[4] += basis_[1] * v;
    moment_[5] += basis_[2] * v;
  }
  /// Adds the line that a table has at the point added last.
  void add(std::size_t table, const Line<double>& l) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 6; ++c) right_[table][k][c] += basis_[k] * S(l[c]);
  }

  /// Whether the points determine a plane: they are not few, nor in a line. A spread of a few per
  /// cent of the unit across the line is enough.
  bool solve() {
    constexpr double spread_limit = 1e-6;
    const auto& m = moment_;
    row_ = {m[3] * m[5] - m[4] * m[4], m[2] * m[4] - m[1] * m[5], m[1] * m[4] - m[2] * m[3]};
    const double w = value(m[0]);
    return value(m[0] * row_[0] + m[1] * row_[1] + m[2] * row_[2]) > spread_limit * w * w * w;
  }

  /// The fitted line times the determinant of the moments, which leaves its eigenvectors as they
  /// are.
  Line<S> fitted(std::size_t table) const {
    Line<S> l;
    for (std::size_t c = 0; c < 6; ++c)
      l[c] = row_[0] * right_[table][0][c] + row_[1] * right_[table][1][c] +
             row_[2] * right_[table][2][c];
    return l;
  }

 private:
  std::array<S, 3> basis_;
  std::array<S, 6> moment_;  // 1, u, v, uu, uv, vv
  std::array<S, 3> row_;     // first row of their adjugate
  std::array<std::array<Line<S>, 3>, 2> right_;
};

}  // namespace anisocontact::anisotropy
