#pragma once
// Batches of slave points against the facets of a mesh: what is given, and what the kernel sees of a
// point.

#include <algorithm>
#include <array>

#include "anisocontact/kernel/facet_assembly.hpp"
#include "anisocontact/surface/facet.hpp"
#include "arrays.hpp"
#include "states.hpp"

namespace anisocontact::bindings {

using kernel::NodalShape;

/// Positions of the nodes of a facet, where they are.
struct FacetNodes {
  const double* x;
  const std::int32_t* node;

  const double* operator[](std::size_t i) const {
    return x + 3 * static_cast<std::size_t>(node[i]);
  }
};

/// Facets of a mesh with the positions of all nodes now and in the reference configuration.
struct Mesh {
  const double *now, *reference;
  const std::int32_t* connectivity;
  std::size_t width;  ///< nodes in a row of the connectivity
  const std::int8_t* topology;
  const bool* flip;

  surface::FacetKind kind(std::size_t f) const {
    return {static_cast<surface::Topology>(topology[f]), flip[f]};
  }
  std::int32_t node(std::size_t f, std::size_t i) const { return connectivity[f * width + i]; }
  /// -1 beyond the nodes of a facet.
  std::int32_t node_or_none(std::int64_t facet, std::size_t i) const {
    const auto f = static_cast<std::size_t>(facet);
    return i < kind(f).nodes() ? node(f, i) : -1;
  }
  void copy_nodes(std::int64_t facet, std::int32_t* to) const {
    for (std::size_t i = 0; i < width; ++i) to[i] = node_or_none(facet, i);
  }
  /// Positions of the nodes of a facet.
  FacetNodes nodes(const double* x, std::size_t f) const { return {x, connectivity + f * width}; }
};

/// Slave points: nodes of their facets, shape functions there and the weight of the quadrature.
struct Slave {
  const std::int32_t* nodes;
  const double *shape, *gradient, *weight;
  std::size_t width;
  bool current_area;

  void at(std::size_t p, NodalShape& s) const {
    s.count = width;
    for (std::size_t a = 0; a < width; ++a) {
      s.N[a] = shape[p * width + a];
      s.dN[a] = {gradient[2 * (p * width + a)], gradient[2 * (p * width + a) + 1]};
    }
  }
};

/// Where the search has put each point.
struct Hits {
  const std::int32_t* facet;
  const double *xi, *edge, *held;  ///< held: projections, (n, 3, 3), see kernel::PairPoint; or none
  const std::int8_t* feature;
};

/// What the kernel sees of one point.
struct Seen {
  kernel::PairPoint point;
  kernel::PairShapes shapes;
};

/// Everything of a batch that does not change from point to point.
struct Batch {
  Mesh mesh;
  Slave slave;
  Hits hits;
  bool on_master, on_slave;  ///< on whose reference there are directions

  ANISOCONTACT_INLINE void see_slave(std::size_t p, Seen& s) const {
    auto& own = s.point.own;
    const std::int32_t* const nodes = slave.nodes + p * slave.width;
    surface::put_jet<false>(slave.width, FacetNodes{mesh.now, nodes}, s.shapes.slave, own.now);
    if (on_slave)
      surface::put_jet<false>(slave.width, FacetNodes{mesh.reference, nodes}, s.shapes.slave,
                              own.reference);
    s.point.slave = own.now.position;
    s.shapes.area.tangents = own.now.d1;
  }

  ANISOCONTACT_INLINE void see_master(std::size_t p, Seen& s) const {
    const auto f = static_cast<std::size_t>(hits.facet[p]);
    s.point.facet = hits.facet[p];
    s.point.master.xi = {hits.xi[2 * p], hits.xi[2 * p + 1]};
    s.point.edge = {hits.edge[2 * p], hits.edge[2 * p + 1]};
    s.point.held = hits.held == nullptr ? nullptr : hits.held + 9 * p;
    const auto kind = mesh.kind(f);
    auto& shape = s.shapes.master;
    put_shape(kind, s.point.master.xi, shape);
    const std::size_t count = kind.nodes();
    surface::put_jet<true>(count, mesh.nodes(mesh.now, f), shape, s.point.master.now);
    if (on_master)
      surface::put_jet<true>(count, mesh.nodes(mesh.reference, f), shape, s.point.master.reference);
  }

  ANISOCONTACT_INLINE void see_committed(const kernel::PointState& state, Seen& s) const {
    const auto c = static_cast<std::size_t>(state.facet);
    const auto kind = mesh.kind(c);
    auto& shape = s.shapes.before;
    put_shape(kind, state.xi, shape);
    surface::put_jet<false>(kind.nodes(), mesh.nodes(mesh.now, c), shape, s.point.before);
  }

  /// What there was of another point stays where this one has nothing.
  ANISOCONTACT_INLINE void see(const kernel::PointState& state, std::size_t p, Seen& s) const {
    slave.at(p, s.shapes.slave);
    s.shapes.area.weight = slave.weight[p];
    s.shapes.area.current = slave.current_area;
    see_slave(p, s);
    s.point.feature = static_cast<kernel::Feature>(hits.feature[p]);
    s.shapes.master.count = s.shapes.before.count = 0;
    if (s.point.feature == kernel::Feature::off) return;
    see_master(p, s);
    if (state.facet >= 0) see_committed(state, s);
  }

 private:
  /// Facets of fewer nodes than the widest have zeros at the end.
  ANISOCONTACT_INLINE void put_shape(const surface::FacetKind& kind,
                                     const std::array<double, 2>& xi, NodalShape& s) const {
    s.count = mesh.width;
    surface::shape(kind, xi[0], xi[1], s);
  }
};

}  // namespace anisocontact::bindings
