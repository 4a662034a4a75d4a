#pragma once
// Facets of a mesh, and what mortar weights of one of them are.

#include <span>
#include <vector>

#include "anisocontact/mortar/overlap.hpp"

namespace anisocontact::mortar {

/// Facets of a mesh.
struct Facets {
  Topology topology;
  const std::int32_t* nodes;  ///< (count, node_count)
  std::size_t count;

  std::size_t width() const { return surface::node_count(topology); }
  std::int32_t node(std::size_t f, std::size_t a) const { return nodes[f * width() + a]; }
  std::span<const std::int32_t> of(std::size_t f) const { return {nodes + f * width(), width()}; }
  Facet at(std::size_t f, const double* x) const {
    Facet out{topology, {}};
    for (std::size_t a = 0; a < width(); ++a) {
      const double* p = x + 3 * static_cast<std::size_t>(node(f, a));
      out.x[a] = {p[0], p[1], p[2]};
    }
    return out;
  }
};

/// Weights of a facet and their derivatives: three columns for each node of the facet, then of
/// `masters`.
struct DualWeights {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<std::int32_t>
      masters;           ///< nodes, ascending; those of the slave facet as well where it hands over
  Eigen::VectorXd area;  ///< D
  Matrix weight;         ///< W, (slaves, masters)
  Matrix own;            ///< E of `hand_over`, (slaves, slaves); empty where it is zero
  Matrix d_area, d_weight;  ///< (slaves, columns), (slaves * masters, columns)
};

}  // namespace anisocontact::mortar
