// Contact planes at slave nodes: sums over nodes, and derivatives of tractions carried on to them.

#include <nanobind/stl/tuple.h>

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/mortar/plane_slopes.hpp"
#include "anisocontact/mortar/surface_tangents.hpp"
#include "arrays.hpp"
#include "bindings.hpp"

namespace anisocontact::bindings {

namespace {

using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const std::int32_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Cube = nb::ndarray<const double, nb::shape<-1, -1, -1>, nb::c_contig, nb::device::cpu>;
using Blocks = nb::ndarray<const double, nb::shape<-1, 2, 2, -1>, nb::c_contig, nb::device::cpu>;
using Gradients =
    nb::ndarray<const double, nb::shape<-1, -1, -1, 3>, nb::c_contig, nb::device::cpu>;
using Slopes = nb::ndarray<const double, nb::shape<-1, 3, 27>, nb::c_contig, nb::device::cpu>;

/// Sums of values at nodes that are at x, (n, values, 3); a node -1 gives nothing.
nb::ndarray<nb::numpy, double> node_sums(const Table& nodes, const Cube& values, const Points& x) {
  const std::size_t n = nodes.shape(0), width = nodes.shape(1), count = values.shape(1);
  Array<double> out({n, count, 3});
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < width; ++k) {
      const std::int32_t node = nodes.data()[i * width + k];
      if (node < 0) continue;
      const double* const from = x.data() + 3 * static_cast<std::size_t>(node);
      for (std::size_t v = 0; v < count; ++v) {
        const double f = values.data()[(i * count + v) * width + k];
        for (std::size_t j = 0; j < 3; ++j) out.data[3 * (i * count + v) + j] += f * from[j];
      }
    }
  return out.array;
}

/// Adds vectors times weights to nodes, -1 for none.
void add_at_nodes(const Table& nodes, const Rows& weights, const Points& vectors,
                  const nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>& out) {
  const std::size_t p = nodes.shape(0), width = nodes.shape(1);
  for (std::size_t q = 0; q < p; ++q)
    for (std::size_t k = 0; k < width; ++k) {
      const std::int32_t node = nodes.data()[q * width + k];
      if (node < 0) continue;
      double* const to = out.data() + 3 * static_cast<std::size_t>(node);
      for (std::size_t j = 0; j < 3; ++j)
        to[j] += weights.data()[q * width + k] * vectors.data()[3 * q + j];
    }
}

/// Unit normals of two tangents each, (n, 2, 3).
nb::ndarray<nb::numpy, double> unit_normals(const Cube& tangents) {
  const std::size_t n = tangents.shape(0);
  Array<double> out({n, 3}, unset);
  for (std::size_t i = 0; i < n; ++i)
    put3(out.data, i,
         row3(tangents.data(), 2 * i).cross(row3(tangents.data(), 2 * i + 1)).normalized());
  return out.array;
}

nb::tuple surface_tangents(const Gradients& gradients, const Cube& normals, const Indices& facet,
                           const Coordinates& xi, const Cube& own, const Blocks& bend,
                           std::size_t threads) {
  const std::size_t n = facet.shape(0), width = gradients.shape(2);
  const mortar::VertexGradients at{gradients.shape(1), width, gradients.data(), normals.data()};
  Array<double> values({n, 2, width}, unset), rates({n, 2, 2, width}, unset);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      mortar::surface_tangents(at, static_cast<std::size_t>(facet.data()[i]), xi.data() + 2 * i,
                               own.data() + 6 * i, bend.data() + 12 * i,
                               values.data + 2 * i * width, rates.data + 4 * i * width);
    });
  }
  return nb::make_tuple(values.array, rates.array);
}

nb::tuple plane_slopes(const Points& slave, const Cube& tangents, const Points& normal,
                       const Cube& held, const Points& now, const Points& reference,
                       const Cube& then, const Cube& carried, const Scalars& area,
                       const Table& masters, const Rows& shares, const Indices& facet,
                       const Table& nodes, const Rows& shape, const Cube& gradient,
                       const Blocks& second, const Coordinates& edge, const Table& around,
                       const Cube& along, const Blocks& bending, const Indices& which,
                       const Slopes& by_nodes, std::size_t threads) {
  const mortar::PlanesView planes{slave.data(),
                                  tangents.data(),
                                  normal.data(),
                                  held.data(),
                                  now.data(),
                                  reference.data(),
                                  then.data(),
                                  carried.data(),
                                  area.data(),
                                  {masters.shape(1),
                                   masters.data(),
                                   shares.data(),
                                   facet.data(),
                                   shape.data(),
                                   edge.data(),
                                   {nodes.shape(1), nodes.data(), gradient.data(), second.data()},
                                   {around.shape(1), around.data(), along.data(), bending.data()}}};
  const std::size_t p = which.shape(0), most = masters.shape(1);
  Array<double> by({p, mortar::moving_parts, mortar::block_size}, unset), lift({p, most, 3}, unset);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(p, threads, [&](std::size_t q) {
      mortar::plane_slopes(
          planes, static_cast<std::size_t>(which.data()[q]), by_nodes.data() + 81 * q,
          by.data + q * mortar::moving_parts * mortar::block_size, lift.data + 3 * q * most);
    });
  }
  return nb::make_tuple(by.array, lift.array);
}

}  // namespace

void bind_contact_planes(nb::module_& m) {
  m.def("node_sums", &node_sums, nb::arg("nodes"), nb::arg("values"), nb::arg("x"));
  m.def("add_at_nodes", &add_at_nodes, nb::arg("nodes"), nb::arg("weights"), nb::arg("vectors"),
        nb::arg("out").noconvert());
  m.def("unit_normals", &unit_normals, nb::arg("tangents"));
  m.def("surface_tangents", &surface_tangents, nb::arg("gradients"), nb::arg("normals"),
        nb::arg("facet"), nb::arg("xi"), nb::arg("own"), nb::arg("bend"), nb::arg("threads"));
  m.def("plane_slopes", &plane_slopes, nb::arg("slave"), nb::arg("tangents"), nb::arg("normal"),
        nb::arg("held"), nb::arg("now"), nb::arg("reference"), nb::arg("then"), nb::arg("carried"),
        nb::arg("area"), nb::arg("masters"), nb::arg("shares"), nb::arg("facet"), nb::arg("nodes"),
        nb::arg("shape"), nb::arg("gradient"), nb::arg("second"), nb::arg("edge"),
        nb::arg("around"), nb::arg("along"), nb::arg("bending"), nb::arg("which"),
        nb::arg("by_nodes"), nb::arg("threads"));
}

}  // namespace anisocontact::bindings
