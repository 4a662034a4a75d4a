#pragma once
// Overlap of two convex polygons of a plane [Sutherland Hodgman 1974], with the derivative of its
// vertices by the corners of both.

#include <array>
#include <cmath>
#include <cstddef>

namespace anisocontact::mortar {

/// Numbers of a plane that an overlap depends on: two coordinates of each corner, four of the slave
/// and four of the master.
inline constexpr std::size_t plane_inputs = 16;
struct alignas(64) Row : std::array<double, plane_inputs> {};

/// A point of the plane; its derivatives are written where they are wanted alone.
struct Vertex {
  std::array<double, 2> x;
  std::array<Row, 2> d;
};

/// Distance over the length of an edge within which a corner lies on it: where edges lie on each
/// other rounding would say where they cross.
inline constexpr double on_edge = 1e-10;

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
};

/// A corner of slave (0 to 3) or master (4 to 7) as a vertex.
inline void put_corner(const std::array<double, 2>& x, std::size_t input, bool slopes, Vertex& v) {
  v.x = x;
  if (!slopes) return;
  for (std::size_t i = 0; i < 2; ++i) {
    v.d[i].fill(0.0);
    v.d[i][2 * input + i] = 1.0;
  }
}

namespace detail {

/// (b - a) x (p - a), positive where p lies to the left of the edge.
inline double side(const Vertex& a, const Vertex& b, const Vertex& p) {
  return (b.x[0] - a.x[0]) * (p.x[1] - a.x[1]) - (b.x[1] - a.x[1]) * (p.x[0] - a.x[0]);
}
inline void side_slopes(const Vertex& a, const Vertex& b, const Vertex& p, Row& d) {
  const double ex = b.x[0] - a.x[0], ey = b.x[1] - a.x[1], rx = p.x[0] - a.x[0],
               ry = p.x[1] - a.x[1];
  for (std::size_t k = 0; k < plane_inputs; ++k)
    d[k] = (b.d[0][k] - a.d[0][k]) * ry + ex * (p.d[1][k] - a.d[1][k]) -
           (b.d[1][k] - a.d[1][k]) * rx - ey * (p.d[0][k] - a.d[0][k]);
}

/// Where the way from p to q, at distances sp and sq from an edge, crosses it.
inline void cross(const Vertex& a, const Vertex& b, const Vertex& p, const Vertex& q, double sp,
                  double sq, bool slopes, Vertex& out) {
  const double inverse = 1.0 / (sp - sq), share = sp * inverse;
  const std::array<double, 2> way{q.x[0] - p.x[0], q.x[1] - p.x[1]};
  for (std::size_t i = 0; i < 2; ++i) out.x[i] = p.x[i] + share * way[i];
  if (!slopes) return;
  Row dp, dq;
  side_slopes(a, b, p, dp);
  side_slopes(a, b, q, dq);
  for (std::size_t k = 0; k < plane_inputs; ++k) {
    const double ds = (sp * dq[k] - sq * dp[k]) * inverse * inverse;
    for (std::size_t i = 0; i < 2; ++i)
      out.d[i][k] = p.d[i][k] + share * (q.d[i][k] - p.d[i][k]) + way[i] * ds;
  }
}

}  // namespace detail

/// The part of a polygon to the left of an edge. A corner on the edge is left alone: where edges lie
/// on each other the polygon keeps its own.
inline void clip(const Polygon& in, const Vertex& a, const Vertex& b, bool slopes, Polygon& out) {
  const double ex = b.x[0] - a.x[0], ey = b.x[1] - a.x[1], on = on_edge * (ex * ex + ey * ey);
  std::array<double, 9> s;
  for (std::size_t i = 0; i < in.count; ++i) {
    s[i] = detail::side(a, b, in.vertex[i]);
    if (std::abs(s[i]) <= on) s[i] = 0.0;
  }
  out.count = 0;
  for (std::size_t i = 0; i < in.count && out.count < out.vertex.size(); ++i) {
    const std::size_t j = i + 1 == in.count ? 0 : i + 1;
    if (s[i] >= 0.0) out.vertex[out.count++] = in.vertex[i];
    if (s[i] * s[j] < 0.0 && out.count < out.vertex.size())
      detail::cross(a, b, in.vertex[i], in.vertex[j], s[i], s[j], slopes, out.vertex[out.count++]);
  }
}

}  // namespace anisocontact::mortar
