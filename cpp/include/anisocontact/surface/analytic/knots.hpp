#pragma once
// Knot vector of one coordinate of a B-spline: basis functions with derivatives, and blossoms.

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::surface {

/// Highest degree; buffers of an evaluation have a place for each of its basis functions.
inline constexpr std::size_t most_degree = 8;

class Knots {
 public:
  /// The basis functions that are not zero in a span, and their first two derivatives.
  template <class S>
  using Basis = std::array<std::array<S, most_degree + 1>, 3>;

  Knots() = default;
  Knots(std::size_t degree, std::vector<double> knots, const std::string& name)
      : degree_(degree), knots_(std::move(knots)) {
    const std::size_t p = degree_, m = knots_.size();
    if (p < 1 || p > most_degree)
      throw std::invalid_argument("degrees must be from 1 to " + std::to_string(most_degree));
    if (m < 2 * (p + 1))
      throw std::invalid_argument(name + " has " + std::to_string(m) + " knots, degree " +
                                  std::to_string(p) + " needs at least " +
                                  std::to_string(2 * (p + 1)));
    if (!std::is_sorted(knots_.begin(), knots_.end()))
      throw std::invalid_argument(name + " must not decrease");
    if (!(lower() < upper())) throw std::invalid_argument(name + " spans nothing");
    for (std::size_t i = p + 1; i + p + 1 < m; ++i)
      if (knots_[i] > lower() && knots_[i] < upper() && !(knots_[i] < knots_[i + p]))
        throw std::invalid_argument(name + " tears the surface: a knot inside has more than " +
                                    std::to_string(p) + " places");
  }

  std::size_t degree() const { return degree_; }
  std::size_t count() const { return knots_.size() - degree_ - 1; }  ///< of control points
  double lower() const { return knots_[degree_]; }
  double upper() const { return knots_[count()]; }
  double operator[](std::size_t i) const { return knots_[i]; }

  /// Knots from the other end.
  Knots reversed() const {
    Knots r = *this;
    const double sum = knots_.front() + knots_.back();
    for (std::size_t i = 0; i < knots_.size(); ++i)
      r.knots_[i] = sum - knots_[knots_.size() - 1 - i];
    return r;
  }

  /// Span i with knots[i] <= u < knots[i + 1]; the first and the last one go on beyond the ends.
  std::size_t span(double u) const noexcept {
    const auto first = knots_.begin() + static_cast<std::ptrdiff_t>(degree_ + 1);
    const auto last = knots_.begin() + static_cast<std::ptrdiff_t>(count());
    const auto above = std::upper_bound(first, last, std::min(u, upper()));
    auto i = static_cast<std::size_t>(above - knots_.begin()) - 1;
    while (!(knots_[i] < knots_[i + 1])) --i;  // u is the upper end
    return i;
  }

  /// Spans that are not empty.
  std::vector<std::size_t> spans() const {
    std::vector<std::size_t> r;
    for (std::size_t i = degree_; i < count(); ++i)
      if (knots_[i] < knots_[i + 1]) r.push_back(i);
    return r;
  }

  /// N_{span-p} ... N_span and derivatives by the recursion of Cox and de Boor
  /// [Piegl Tiller 1997, eq. (2.5), (2.7)].
  template <class S>
  Basis<S> basis(std::size_t span, const S& u) const noexcept {
    const std::size_t p = degree_;
    Basis<S> b{};
    std::array<S, most_degree + 1> value{}, first{}, second{};
    value[0] = S(1.0);
    for (std::size_t r = 1; r <= p; ++r) {
      if (r == p) first = value;
      if (r + 1 == p) second = value;
      S carried(0.0);
      for (std::size_t j = 0; j < r; ++j) {
        const double right = knots_[span + j + 1], left = knots_[span + j + 1 - r];
        const S share = value[j] / S(right - left);
        value[j] = carried + (S(right) - u) * share;
        carried = (u - S(left)) * share;
      }
      value[r] = carried;
    }
    b[0] = value;
    b[1] = derivative(span, p, first);
    if (p > 1) b[2] = derivative(span, p, derivative(span, p - 1, second));
    return b;
  }

  /// Value at the arguments t_1 ... t_p of the blossom of the polynomial in a span whose control
  /// points are c[0] ... c[p]; overwrites them. With p - j arguments a and j arguments b it is the
  /// j-th Bezier control point of the piece from a to b.
  template <class Point>
  Point blossom(std::size_t span, const double* t, Point* c) const {
    const std::size_t p = degree_;
    for (std::size_t r = 1; r <= p; ++r)
      for (std::size_t i = p; i >= r; --i) {
        const double left = knots_[span - p + i], right = knots_[span + 1 + i - r];
        const double s = (t[r - 1] - left) / (right - left);
        c[i] = (1.0 - s) * c[i - 1] + s * c[i];
      }
    return c[p];
  }

 private:
  /// Derivatives of the functions of degree m from (derivatives of) those of degree m - 1.
  template <class S>
  std::array<S, most_degree + 1> derivative(
      std::size_t span, std::size_t m, const std::array<S, most_degree + 1>& below) const noexcept {
    std::array<S, most_degree + 1> d{};
    for (std::size_t j = 0; j < m; ++j) {
      const double width = knots_[span + j + 1] - knots_[span + j + 1 - m];
      const S share = S(static_cast<double>(m) / width) * below[j];
      d[j] -= share;
      d[j + 1] += share;
    }
    return d;
  }

  std::size_t degree_{1};
  std::vector<double> knots_{0.0, 0.0, 1.0, 1.0};
};

}  // namespace anisocontact::surface
