#pragma once
// Material tangents of a surface of facets that are continuous across their edges: gradients at the
// vertices of a facet, interpolated between them, along tangents in the plane of the averaged normal N,
//   T_a = d_a - (d_a . N) N ,   t_a = sum_m x_m (B_m . T_a) .

#include <array>
#include <cstddef>

#include "anisocontact/tensor/tangent.hpp"

namespace anisocontact::mortar {

/// Gradients at the vertices of facets and averaged normals there.
struct VertexGradients {
  std::size_t corners, width;       ///< vertices of a facet, nodes around it
  const double *gradient, *normal;  ///< B, (m, corners, width, 3); N, (m, corners, 3)
};

namespace detail {

inline Vec3<double> vec3(const double* p) { return {p[0], p[1], p[2]}; }

/// Functions that are one at a vertex and linear along edges, and their derivatives.
struct VertexFunctions {
  std::array<std::array<double, 4>, 3> f;  ///< functions, and derivatives by both coordinates

  VertexFunctions(std::size_t corners, double x, double y) {
    if (corners == 3)
      f = {{{1.0 - x - y, x, y, 0.0}, {-1.0, 1.0, 0.0, 0.0}, {-1.0, 0.0, 1.0, 0.0}}};
    else
      f = {{{(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y},
            {y - 1.0, 1.0 - y, -y, y},
            {x - 1.0, -x, 1.0 - x, x}}};
  }
};

}  // namespace detail

/// Writes B_m . T_a at a place of a facet, (2, width), and its derivatives by the coordinates, (2, 2, width).
///
/// `own` are the tangents of the facet there in the reference configuration, (2, 3), `bend` their derivatives
/// by the coordinates, (2, 2, 3).
inline void surface_tangents(const VertexGradients& g, std::size_t facet, const double* xi,
                             const double* own, const double* bend, double* values, double* rates) {
  using detail::vec3;
  const detail::VertexFunctions at(g.corners, xi[0], xi[1]);
  const double* const normal = g.normal + facet * g.corners * 3;
  const double* const gradient = g.gradient + facet * g.corners * g.width * 3;
  std::array<Vec3<double>, 3> n;  // averaged normal, and how it turns
  for (std::size_t d = 0; d < 3; ++d) {
    n[d].setZero();
    for (std::size_t c = 0; c < g.corners; ++c) n[d] += at.f[d][c] * vec3(normal + 3 * c);
  }
  const double size = n[0].norm();
  n[0] /= size;
  for (std::size_t d = 1; d < 3; ++d) {
    n[d] /= size;
    n[d] -= n[d].dot(n[0]) * n[0];
  }
  std::array<Vec3<double>, 2> flat;
  std::array<std::array<Vec3<double>, 2>, 2> d_flat;
  for (std::size_t a = 0; a < 2; ++a) {
    const Vec3<double> d = vec3(own + 3 * a);
    const double along = d.dot(n[0]);
    flat[a] = d - along * n[0];
    for (std::size_t b = 0; b < 2; ++b) {
      const Vec3<double> dd = vec3(bend + 3 * (2 * a + b));
      d_flat[a][b] = dd - (dd.dot(n[0]) + d.dot(n[1 + b])) * n[0] - along * n[1 + b];
    }
  }
  for (std::size_t m = 0; m < g.width; ++m) {
    std::array<Vec3<double>, 3> by;  // gradient there, and its derivatives
    for (std::size_t d = 0; d < 3; ++d) {
      by[d].setZero();
      for (std::size_t c = 0; c < g.corners; ++c)
        by[d] += at.f[d][c] * vec3(gradient + 3 * (c * g.width + m));
    }
    for (std::size_t a = 0; a < 2; ++a) {
      values[a * g.width + m] = flat[a].dot(by[0]);
      for (std::size_t b = 0; b < 2; ++b)
        rates[(2 * a + b) * g.width + m] = d_flat[a][b].dot(by[0]) + flat[a].dot(by[1 + b]);
    }
  }
}

}  // namespace anisocontact::mortar
