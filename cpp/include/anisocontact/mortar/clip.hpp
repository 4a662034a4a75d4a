#pragma once
// Overlap of two convex polygons of a plane [Sutherland Hodgman 1974], with the derivative of its
// vertices by the corners of both.

#include <array>
#include <cmath>
#include <cstddef>

namespace anisocontact::mortar {

using Point = std::array<double, 2>;

/// Corners of a slave (0 to 3) and of a master (4 to 7) in a plane. The edge of a corner runs from it
/// to the next one.
struct Corners {
  std::array<Point, 8> x{};
  std::size_t slaves{0}, masters{0};

  std::size_t next(std::size_t corner) const {
    if (corner < 4) return corner + 1 == slaves ? 0 : corner + 1;
    return corner + 1 == 4 + masters ? 4 : corner + 1;
  }
};

/// A vertex of an overlap: a corner, or where two edges cross.
struct Vertex {
  Point x;
  std::size_t edge;                 ///< which leaves it
  std::array<std::size_t, 2> from;  ///< the edges; twice the same number is a corner

  bool crosses() const { return from[0] != from[1]; }
};

/// Distance over the length of an edge within which a corner lies on it: where edges lie on each
/// other rounding would say where they cross.
inline constexpr double on_edge = 1e-8;

/// A polygon; four corners clipped by four edges have eight at most.
struct Polygon {
  std::array<Vertex, 9> vertex;
  std::size_t count{0};

  double area() const {
    double twice = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto &p = vertex[i].x, &q = vertex[i + 1 == count ? 0 : i + 1].x;
      twice += p[0] * q[1] - p[1] * q[0];
    }
    return 0.5 * twice;
  }
  void add(const Vertex& v) {
    if (count < vertex.size()) vertex[count++] = v;
  }
};

/// The part of a polygon to the left of the edge of a corner. A corner on the edge is left alone:
/// where edges lie on each other the polygon keeps its own.
inline void clip(const Polygon& in, const Corners& corners, std::size_t edge, Polygon& out) {
  const Point &a = corners.x[edge], &b = corners.x[corners.next(edge)];
  const double ex = b[0] - a[0], ey = b[1] - a[1], on = on_edge * (ex * ex + ey * ey);
  std::array<double, 9> s;  // positive to the left
  for (std::size_t i = 0; i < in.count; ++i) {
    const Point& p = in.vertex[i].x;
    s[i] = ex * (p[1] - a[1]) - ey * (p[0] - a[0]);
    if (std::abs(s[i]) <= on) s[i] = 0.0;
  }
  out.count = 0;
  for (std::size_t i = 0; i < in.count; ++i) {
    const std::size_t j = i + 1 == in.count ? 0 : i + 1;
    const Vertex &p = in.vertex[i], &q = in.vertex[j];
    if (s[i] >= 0.0) out.add({p.x, s[i] == 0.0 && s[j] < 0.0 ? edge : p.edge, p.from});
    if (!(s[i] * s[j] < 0.0)) continue;
    const double share = s[i] / (s[i] - s[j]);
    out.add({{p.x[0] + share * (q.x[0] - p.x[0]), p.x[1] + share * (q.x[1] - p.x[1])},
             s[j] < 0.0 ? edge : p.edge,
             {p.edge, edge}});
  }
}

/// How a crossing of two edges follows the ends of both: dx = sum of `by` d corner.
struct Crossing {
  std::array<std::size_t, 4> corner;
  std::array<std::array<Point, 2>, 4> by;

  Crossing(const Corners& corners, const Vertex& v) {
    std::array<Point, 2> way;
    std::array<double, 2> share;
    for (std::size_t e = 0; e < 2; ++e) {
      corner[2 * e] = v.from[e];
      corner[2 * e + 1] = corners.next(v.from[e]);
      const Point &a = corners.x[corner[2 * e]], &b = corners.x[corner[2 * e + 1]];
      way[e] = {b[0] - a[0], b[1] - a[1]};
      share[e] = ((v.x[0] - a[0]) * way[e][0] + (v.x[1] - a[1]) * way[e][1]) /
                 (way[e][0] * way[e][0] + way[e][1] * way[e][1]);
    }
    // what moves along an edge is where the other one is: dx = ds + w (n . (dm - ds)) / (n . w)
    const Point &w = way[0], n{-way[1][1], way[1][0]};
    const double size = n[0] * w[0] + n[1] * w[1];
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t e = c / 2;
      const double part = c % 2 == 0 ? 1.0 - share[e] : share[e];
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k) {
          const double along = w[i] * n[k] / size;
          by[c][i][k] = part * (e == 1 ? along : (i == k ? 1.0 : 0.0) - along);
        }
    }
  }
};

}  // namespace anisocontact::mortar
