// Batches of slave points against the facets of a mesh: tractions, nodal forces and tangents.

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "anisocontact/kernel/facet_assembly.hpp"
#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/surface/facet.hpp"
#include "arrays.hpp"
#include "rooms.hpp"
#include "states.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

using kernel::NodalShape;
using Nodes = nb::ndarray<const std::int32_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Gradients = nb::ndarray<const double, nb::shape<-1, -1, 2>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using FacetNodes = std::array<Vec3<double>, surface::max_facet_nodes>;

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
  FacetNodes nodes(const double* x, std::size_t f) const {
    FacetNodes r;
    for (std::size_t i = 0; i < kind(f).nodes(); ++i)
      r[i] = row3(x, static_cast<std::size_t>(node(f, i)));
    return r;
  }
};

/// Slave points: nodes of their facets, shape functions there and the weight of the quadrature.
struct Slave {
  const std::int32_t* nodes;
  const double *shape, *gradient, *weight;
  std::size_t width;
  bool current_area;

  NodalShape at(std::size_t p) const {
    NodalShape s;
    s.count = width;
    for (std::size_t a = 0; a < width; ++a) {
      s.n[a] = shape[p * width + a];
      s.dn[a] = {gradient[2 * (p * width + a)], gradient[2 * (p * width + a) + 1]};
    }
    return s;
  }
};

/// Where the search has put each point.
struct Hits {
  const std::int32_t* facet;
  const double *xi, *edge;
  const std::int8_t* feature;
};

NodalShape nodal(const surface::FacetKind& k, const surface::Shape<double>& s) {
  NodalShape r;
  r.count = k.nodes();
  r.n = s.N;
  r.dn = s.dN;
  return r;
}

struct PairHandle {
  kernel::InterfaceLaw law;
  bool mirrored;
};

/// What the kernel sees of one point.
struct Seen {
  kernel::PairPoint point;
  NodalShape slave, master, before;
  kernel::SlaveArea area;
};

Seen see(const Mesh& mesh, const Slave& slave, const Hits& hits, const kernel::PointState& state,
         std::size_t p) {
  Seen s;
  s.slave = slave.at(p);
  s.area.weight = slave.weight[p];
  s.area.current = slave.current_area;
  for (std::size_t a = 0; a < slave.width; ++a) {
    const auto node = static_cast<std::size_t>(slave.nodes[p * slave.width + a]);
    const Vec3<double> x = row3(mesh.now, node);
    s.point.slave += s.slave.n[a] * x;
    for (std::size_t i = 0; i < 2; ++i) s.area.tangents[i] += s.slave.dn[a][i] * x;
  }
  s.point.feature = static_cast<kernel::Feature>(hits.feature[p]);
  if (s.point.feature == kernel::Feature::off) return s;
  const auto f = static_cast<std::size_t>(hits.facet[p]);
  s.point.facet = hits.facet[p];
  s.point.xi = {hits.xi[2 * p], hits.xi[2 * p + 1]};
  s.point.edge = {hits.edge[2 * p], hits.edge[2 * p + 1]};
  surface::Shape<double> shape;
  surface::shape(mesh.kind(f), s.point.xi[0], s.point.xi[1], shape);
  s.master = nodal(mesh.kind(f), shape);
  s.point.now = surface::facet_jet(mesh.kind(f), mesh.nodes(mesh.now, f), shape);
  s.point.reference = surface::facet_jet(mesh.kind(f), mesh.nodes(mesh.reference, f), shape);
  if (state.facet < 0) return s;
  const auto c = static_cast<std::size_t>(state.facet);
  surface::Shape<double> committed;
  surface::shape(mesh.kind(c), state.xi[0], state.xi[1], committed);
  s.before = nodal(mesh.kind(c), committed);
  s.point.before = surface::facet_jet(mesh.kind(c), mesh.nodes(mesh.now, c), committed);
  return s;
}

nb::dict update(const PairHandle& h, const Bytes& state, double dt, const Nodes& slave_nodes,
                const Table& slave_shape, const Gradients& slave_gradient, const Scalars& weight,
                bool current_area, const Points& now, const Points& reference,
                const Nodes& connectivity, const Codes& topology, const Flags& flip,
                const Indices& facet, const Coordinates& xi, const Codes& feature,
                const Coordinates& edge, bool with_tangent, std::size_t threads) {
  const std::size_t n = facet.shape(0), ks = slave_nodes.shape(1), km = connectivity.shape(1);
  check_states(state, n);
  if (ks > kernel::most_nodes || km > kernel::most_nodes)
    throw std::invalid_argument("a facet has at most 9 nodes");
  const std::size_t rows = 3 * (ks + km), columns = 3 * (ks + 2 * km);
  const Mesh mesh{now.data(), reference.data(), connectivity.data(),
                  km,         topology.data(),  flip.data()};
  const Slave slave{
      slave_nodes.data(), slave_shape.data(), slave_gradient.data(), weight.data(), ks,
      current_area};
  const Hits hits{facet.data(), xi.data(), edge.data(), feature.data()};
  Array<std::uint8_t> next({n, sizeof(kernel::PointState)});
  Array<double> traction({n, 3}), normal({n, 3}), adhesion({n, 2, 3}), friction({n, 2, 3}),
      area({n}), residual({n, rows}), tangent({with_tangent ? n : 0, rows, columns});
  Array<std::int32_t> nodes({n, ks + 2 * km});
  Array<std::int8_t> failure({n});
  std::fill_n(residual.data, n * rows, 0.0);
  std::fill_n(tangent.data, with_tangent ? n * rows * columns : 0, 0.0);
  std::fill_n(nodes.data, n * (ks + 2 * km), -1);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t p) {
      const kernel::PointState old = load(state.data(), p);
      Seen s = see(mesh, slave, hits, old, p);
      s.point.mirrored = h.mirrored;
      const auto r = kernel::update_pair(h.law, old, s.point, dt);
      store(next.data, p, r.state);
      put3(traction.data, p, r.traction);
      put3(normal.data, p, r.normal);
      for (std::size_t k = 0; k < 2; ++k) {
        put3(adhesion.data, 2 * p + k, r.adhesion_axes[k]);
        put3(friction.data, 2 * p + k, r.friction_axes[k]);
      }
      failure.data[p] = static_cast<std::int8_t>(r.failure);
      area.data[p] = s.area.weight *
                     (current_area ? s.area.tangents[0].cross(s.area.tangents[1]).norm() : 1.0);
      std::int32_t* const id = nodes.data + p * (ks + 2 * km);
      for (std::size_t a = 0; a < ks; ++a) id[a] = slave_nodes.data()[p * ks + a];
      const bool touches = r.state.status != 0;
      if (!touches || r.failure != kernel::Failure::none) return;
      for (std::size_t b = 0; b < s.master.count; ++b)
        id[ks + b] = mesh.node(static_cast<std::size_t>(s.point.facet), b);
      for (std::size_t b = 0; b < s.before.count; ++b)
        id[ks + km + b] = mesh.node(static_cast<std::size_t>(old.facet), b);
      // facets of fewer nodes than the widest leave columns and rows without a node empty
      s.master.count = km;
      kernel::assemble_pair(r, s.slave, s.area, s.master, s.before,
                            {residual.data + p * rows, rows},
                            {with_tangent ? tangent.data + p * rows * columns : nullptr,
                             with_tangent ? rows * columns : 0},
                            columns);
    });
  }
  nb::dict d;
  d["state"] = next.array;
  d["traction"] = traction.array;
  d["normal"] = normal.array;
  d["adhesion_axes"] = adhesion.array;
  d["friction_axes"] = friction.array;
  d["failure"] = failure.array;
  d["area"] = area.array;
  d["nodes"] = nodes.array;
  d["residual"] = residual.array;
  d["tangent"] = tangent.array;
  return d;
}

}  // namespace

void bind_facet_pair(nb::module_& m) {
  nb::class_<PairHandle>(m, "FacetPairs")
      .def(
          "__init__",
          [](PairHandle* self, const Named& normal, const Named& adhesion,
             const FieldHandle* adhesion_directions, const Named& friction,
             const FieldHandle* friction_directions, const FieldHandle* friction_second,
             const Named& rule, bool mirrored) {
            new (self) PairHandle{make_law(normal, adhesion, adhesion_directions, friction,
                                           friction_directions, friction_second, rule, "transport"),
                                  mirrored};
          },
          nb::arg("normal"), nb::arg("adhesion"), nb::arg("adhesion_directions").none(),
          nb::arg("friction"), nb::arg("friction_directions").none(),
          nb::arg("friction_directions_second").none(), nb::arg("rule"),
          nb::arg("mirrored") = false)
      .def("update", &update, nb::arg("state"), nb::arg("dt"), nb::arg("slave_nodes"),
           nb::arg("slave_shape"), nb::arg("slave_gradient"), nb::arg("weight"),
           nb::arg("current_area"), nb::arg("now"), nb::arg("reference"), nb::arg("connectivity"),
           nb::arg("topology"), nb::arg("flip"), nb::arg("facet"), nb::arg("xi"),
           nb::arg("feature"), nb::arg("edge"), nb::arg("tangent"), nb::arg("threads"));
}

}  // namespace anisocontact::bindings
