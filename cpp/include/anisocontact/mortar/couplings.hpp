#pragma once
// Tangent of a slave node of a mortar contact from the slopes of its traction and of its weights.

#include <cstddef>
#include <cstdint>

#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::mortar {

/// How many things a traction depends on that are sums over nodes: slave point and tangents, mean of
/// the master and tangents, the same of the accepted increment, place of the tangents.
inline constexpr std::size_t moving_parts = 10;

/// Sizes of the arrays of a node.
struct NodeSizes {
  std::size_t masters, columns;  ///< columns count nodes
};

/// Writes dt/du, (3, 3 columns): by the moving parts, `by` (3, 3, parts) and `moving` (parts, columns),
/// and by the weights, through `lift` (3, masters) and their derivative (masters, 3 columns).
inline void traction_slopes(const NodeSizes& n, const double* by, const double* moving,
                            const double* lift, const double* d_weight, double* out) {
  const std::size_t width = 3 * n.columns;
  for (std::size_t i = 0; i < 3; ++i) {
    double* const row = out + i * width;
    for (std::size_t c = 0; c < n.columns; ++c)
      for (std::size_t j = 0; j < 3; ++j) {
        const double* const slope = by + (3 * i + j) * moving_parts;
        double sum = 0.0;
        for (std::size_t v = 0; v < moving_parts; ++v) sum += slope[v] * moving[v * n.columns + c];
        row[3 * c + j] = sum;
      }
    for (std::size_t k = 0; k < n.masters; ++k) {
      const double f = lift[i * n.masters + k];
      const double* const d = d_weight + k * width;
      if (f != 0.0)
        for (std::size_t c = 0; c < width; ++c) row[c] += f * d[c];
    }
  }
}

/// Writes - w dt/du - t dw/du for one row of nodes: weight w and its slopes, (3 columns).
ANISOCONTACT_INLINE void coupling_row(std::size_t width, double w, const double* dw, double sign,
                                      const double* t, const double* slopes, double* out) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = -sign * w, b = -sign * t[i];
    const double* const from = slopes + i * width;
    double* const to = out + i * width;
    for (std::size_t c = 0; c < width; ++c) to[c] = a * from[c] + b * dw[c];
  }
}

}  // namespace anisocontact::mortar
