#pragma once
// Points of the plane of an overlap, as coordinates on a facet, and its shape functions there.

#include <algorithm>
#include <cmath>
#include <limits>

#include "anisocontact/mortar/lanes.hpp"
#include "anisocontact/mortar/overlap.hpp"

namespace anisocontact::mortar::detail {

/// Points that are looked at together.
inline constexpr std::size_t batch = 8;
using Batch = Lanes<batch>;
using PlanePoints = std::array<Batch, 2>;

/// A part of a facet in the plane: x = c_0 + c_1 s + c_2 t + c_3 s t.
class InPart {
 public:
  /// `order` are the corners of the part as they are in the plane, from `first` on.
  InPart(const SubFacet& part, const std::array<std::size_t, 4>& order, const Corners& corners,
         std::size_t first)
      : part_(part), order_(order) {
    const Point *p = corners.x.data() + first, last = part.corners == 3 ? p[2] : p[3];
    for (std::size_t i = 0; i < 2; ++i)
      c_[i] = {p[0][i], p[1][i] - p[0][i], last[i] - p[0][i],
               part.corners == 3 ? 0.0 : p[0][i] - p[1][i] + p[2][i] - last[i]};
    const auto &a = c_[0], &b = c_[1];
    const double determinant =
        (a[1] + 0.5 * a[3]) * (b[2] + 0.5 * b[3]) - (a[2] + 0.5 * a[3]) * (b[1] + 0.5 * b[3]);
    bend_ = (std::abs(a[3] * b[2] - b[3] * a[2]) + std::abs(b[3] * a[1] - a[3] * b[1])) /
            std::abs(determinant);
  }

  /// Whether shape functions of the part are polynomials of the position, to rounding.
  bool straight() const {
    constexpr double rounding = 1e-9;
    return std::abs(c_[0][3]) + std::abs(c_[1][3]) <
           rounding * (std::abs(c_[0][1] + c_[0][2]) + std::abs(c_[1][1] + c_[1][2])) +
               std::numeric_limits<double>::min();
  }

  /// Solves for the coordinates of points.
  ANISOCONTACT_INLINE bool locate(const PlanePoints& x, PlanePoints& s) const {
    constexpr int iterations = 20;
    constexpr double converged = 1e-14, enough = 1e-10;
    s[0] = s[1] = Batch(part_.corners == 3 ? 0.3 : 0.5);
    if (bend_ >= converged) begin(x, s);
    for (int it = 0; it < iterations; ++it) {
      const Slopes j = slopes(s);
      const Batch r0 = x[0] - at(0, s), r1 = x[1] - at(1, s),
                  du = j.inverse * (j.by[1][1] * r0 - j.by[0][1] * r1),
                  dv = j.inverse * (j.by[0][0] * r1 - j.by[1][0] * r0);
      s[0] += du;
      s[1] += dv;
      double left = 0.0, sum = 0.0;
      const Batch size = du * dv;  // c_3 times this is left, and the next step follows from it
      for (std::size_t l = 0; l < batch; ++l) sum += size[l];
      if (!std::isfinite(sum)) return false;
      if (bend_ < converged) return true;
      const Batch first = j.inverse * size * (c_[0][3] * j.by[1][1] - c_[1][3] * j.by[0][1]),
                  second = j.inverse * size * (c_[1][3] * j.by[0][0] - c_[0][3] * j.by[1][0]);
      for (std::size_t l = 0; l < batch; ++l)
        left = std::max(left, std::abs(first[l]) + std::abs(second[l]));
      if (left < converged || (it > 6 && left < enough)) return true;
    }
    return false;
  }

  /// Functions of the corners at coordinates on the part, and those of the facet that multipliers
  /// see, see `transform`, with their derivatives by the position where there is a place for them.
  ANISOCONTACT_INLINE void functions(Topology t, bool transformed, const PlanePoints& s,
                                     Batch* corner, Batch* value, PlanePoints* slope) const {
    const std::size_t count = part_.corners;
    const Batch one(1.0), u = s[0], v = s[1];
    std::array<PlanePoints, 4> by;  // by the coordinates on the part
    if (count == 3) {
      const std::array<Batch, 3> f{one - u - v, u, v};
      std::copy(f.begin(), f.end(), corner);
      by = {{{-one, -one}, {one, Batch()}, {Batch(), one}, {}}};
    } else {
      const std::array<Batch, 4> f{(one - u) * (one - v), u * (one - v), u * v, (one - u) * v};
      std::copy(f.begin(), f.end(), corner);
      by = {{{v - one, u - one}, {one - v, -u}, {v, u}, {-v, one - u}}};
    }
    if (slope == nullptr && surface::node_count(t) == count) {
      for (std::size_t a = 0; a < count; ++a) value[part_.node[order_[a]]] = corner[a];
      return;
    }
    const Slopes j = slopes(s);
    for (std::size_t a = 0; a < count; ++a)
      by[a] = {j.inverse * (by[a][0] * j.by[1][1] - by[a][1] * j.by[1][0]),
               j.inverse * (by[a][1] * j.by[0][0] - by[a][0] * j.by[0][1])};
    if (surface::node_count(t) == count) {
      for (std::size_t a = 0; a < count; ++a) {
        value[part_.node[order_[a]]] = corner[a];
        slope[part_.node[order_[a]]] = by[a];
      }
      return;
    }
    PlanePoints on;                  // coordinates on the facet
    std::array<PlanePoints, 2> way;  // and their derivatives by the position
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t i = 0; i < 2; ++i) {
        const double there = part_.at[order_[a]][i];
        on[i].add(there, corner[a]);
        for (std::size_t d = 0; d < 2; ++d) way[i][d].add(there, by[a][d]);
      }
    surface::Shape<Batch> facet;
    surface::shape(t, on[0], on[1], facet);
    if (transformed) transform(t, facet);
    for (std::size_t k = 0; k < surface::node_count(t); ++k) {
      value[k] = facet.N[k];
      for (std::size_t d = 0; slope != nullptr && d < 2; ++d)
        slope[k][d] = facet.dN[k][0] * way[0][d] + facet.dN[k][1] * way[1][d];
    }
  }

 private:
  /// Derivatives of the position by the coordinates, and one over their determinant.
  struct Slopes {
    std::array<PlanePoints, 2> by;
    Batch inverse;
  };
  ANISOCONTACT_INLINE Slopes slopes(const PlanePoints& s) const {
    Slopes out;
    for (std::size_t i = 0; i < 2; ++i)
      out.by[i] = {Batch(c_[i][1]) + c_[i][3] * s[1], Batch(c_[i][2]) + c_[i][3] * s[0]};
    out.inverse = Batch(1.0) / (out.by[0][0] * out.by[1][1] - out.by[0][1] * out.by[1][0]);
    return out;
  }
  /// Coordinates of points from the quadratic equation (r - c_2 t) x (c_1 + c_3 t) = 0, r = x - c_0, but for
  /// rounding; none where it has no solution.
  ANISOCONTACT_INLINE void begin(const PlanePoints& x, PlanePoints& s) const {
    const auto &a = c_[0], &b = c_[1];
    const Batch r0 = x[0] - Batch(a[0]), r1 = x[1] - Batch(b[0]),
                linear = b[3] * r0 - a[3] * r1 + Batch(a[1] * b[2] - b[1] * a[2]),
                last = b[1] * r0 - a[1] * r1;
    const double square = a[3] * b[2] - b[3] * a[2];
    const Batch t = (-2.0 * last) / (linear + sqrt(linear * linear - (4.0 * square) * last)),
                w0 = Batch(a[1]) + a[3] * t, w1 = Batch(b[1]) + b[3] * t,
                u = ((r0 - a[2] * t) * w0 + (r1 - b[2] * t) * w1) / (w0 * w0 + w1 * w1);
    double sum = 0.0;
    for (std::size_t l = 0; l < batch; ++l) sum += u[l] * t[l];
    if (std::isfinite(sum)) s = {u, t};
  }
  ANISOCONTACT_INLINE Batch at(std::size_t i, const PlanePoints& s) const {
    const auto& c = c_[i];
    return Batch(c[0]) + c[1] * s[0] + (Batch(c[2]) + c[3] * s[0]) * s[1];
  }

  const SubFacet& part_;
  const std::array<std::size_t, 4>& order_;
  std::array<std::array<double, 4>, 2> c_{};
  double bend_;  ///< c_3 in coordinates on the part
};

}  // namespace anisocontact::mortar::detail
