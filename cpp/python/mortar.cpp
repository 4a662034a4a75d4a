// Mortar weights of slave nodes.

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/mortar/couplings.hpp"
#include "anisocontact/mortar/nodal_weights.hpp"
#include "arrays.hpp"
#include "rooms.hpp"

#include <nanobind/stl/string.h>

namespace anisocontact::bindings {

namespace {

using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const std::int32_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Offsets = nb::ndarray<const std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

surface::Topology named(const std::string& name) {
  const auto t = surface::topology_of(name);
  if (!t) throw std::invalid_argument("no topology " + name);
  return *t;
}

/// Mortar weights of the nodes of slave facets, see cpp/include/anisocontact/mortar/.
nb::dict mortar_weights(const std::string& slave_topology, const Table& slave,
                        const std::string& master_topology, const Table& master, const Points& now,
                        const Points& reference, const Offsets& pair_offsets,
                        const Indices& pair_facets, const Table& patch,
                        const Offsets& around_offsets, const Indices& around_facets,
                        const Indices& around_local, const Offsets& more_offsets,
                        const Indices& more_nodes, const Coordinates& straight_points,
                        const Scalars& straight_weights, const Coordinates& skew_points,
                        const Scalars& skew_weights, bool current_area, bool tangent,
                        std::size_t threads) {
  const mortar::MortarInput in{
      {named(slave_topology), slave.data(), slave.shape(0)},
      {named(master_topology), master.data(), master.shape(0)},
      now.data(),
      current_area ? nullptr : reference.data(),
      {{straight_points.data(), straight_weights.data(), straight_weights.shape(0)},
       {skew_points.data(), skew_weights.data(), skew_weights.shape(0)}},
      tangent};
  const std::size_t n = patch.shape(0);
  const mortar::ListView pairs{pair_offsets.data(), pair_facets.data()},
      more{more_offsets.data(), more_nodes.data()};
  const mortar::Patches patches{{around_offsets.data(), around_facets.data()},
                                {around_offsets.data(), around_local.data()},
                                patch.data(),
                                patch.shape(1)};
  std::vector<mortar::DualWeights> facets(in.slave.count);
  std::vector<std::vector<std::int32_t>> masters(n);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(in.slave.count, threads, [&](std::size_t f) {
      facets[f] = mortar::dual_weights(in, f, pairs.begin(f), pairs.size(f));
    });
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      masters[i] = mortar::masters_of(facets, patches, more, i);
    });
  }
  std::size_t most = 1;
  for (const auto& m : masters) most = std::max(most, m.size());
  const std::size_t columns = 3 * (patch.shape(1) + most), rows = tangent ? n : 0;
  Array<std::int32_t> nodes({n, most}, unset);
  std::fill_n(nodes.data, n * most, -1);
  Array<double> area({n}), weight({n, most}), d_area({rows, columns}),
      d_weight({rows, most, columns});
  {
    nb::gil_scoped_release free;
    const mortar::NodalWeights out{most,        nodes.data,  area.data,
                                   weight.data, d_area.data, d_weight.data};
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      mortar::collect(in, facets, patches, masters[i], i, out);
    });
  }
  nb::dict r;
  r["masters"] = nodes.array;
  r["area"] = area.array;
  r["weight"] = weight.array;
  r["d_area"] = d_area.array;
  r["d_weight"] = d_weight.array;
  return r;
}

using Cube = nb::ndarray<const double, nb::shape<-1, -1, -1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;

/// Derivative of the tractions of some slave nodes by the nodes of their columns, (p, 3, 3 c).
nb::ndarray<nb::numpy, double> mortar_slopes(const Indices& which, const Cube& by,
                                             const Cube& moving, const Cube& lift,
                                             const Cube& d_weight, std::size_t threads) {
  const std::size_t p = which.shape(0);
  const mortar::NodeSizes n{d_weight.shape(1), moving.shape(2)};
  Array<double> out({p, 3, 3 * n.columns}, unset);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(p, threads, [&](std::size_t q) {
      const auto i = static_cast<std::size_t>(which.data()[q]);
      with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
        mortar::traction_slopes(
            n, by.data() + q * 9 * mortar::moving_parts,
            moving.data() + i * mortar::moving_parts * n.columns, lift.data() + q * 3 * n.masters,
            d_weight.data() + i * n.masters * 3 * n.columns, out.data + q * 9 * n.columns);
      });
    });
  }
  return out.array;
}

/// Blocks of some slave nodes: rows of their support, then of the masters, (p, 3 r, 3 c).
nb::ndarray<nb::numpy, double> mortar_couplings(const Indices& which, const Cube& slopes,
                                                const Rows& traction, const Rows& support,
                                                const Scalars& area, const Rows& weight,
                                                const Rows& d_area, const Cube& d_weight,
                                                std::size_t threads) {
  const std::size_t p = which.shape(0), own = support.shape(1), masters = weight.shape(1),
                    width = d_area.shape(1), rows = own + masters;
  Array<double> out({p, 3 * rows, width}, unset);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(p, threads, [&](std::size_t q) {
      const auto i = static_cast<std::size_t>(which.data()[q]);
      const double* const t = traction.data() + 3 * q;
      const double* const dt = slopes.data() + 3 * q * width;
      double* to = out.data + 3 * q * rows * width;
      with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
        for (std::size_t r = 0; r < own; ++r, to += 3 * width)
          mortar::coupling_row(width, area.data()[i], d_area.data() + i * width,
                               support.data()[i * own + r], t, dt, to);
        for (std::size_t k = 0; k < masters; ++k, to += 3 * width)
          mortar::coupling_row(width, weight.data()[i * masters + k],
                               d_weight.data() + (i * masters + k) * width, -1.0, t, dt, to);
      });
    });
  }
  return out.array;
}

}  // namespace

void bind_mortar(nb::module_& m) {
  m.def("mortar_weights", &mortar_weights, nb::arg("slave_topology"), nb::arg("slave"),
        nb::arg("master_topology"), nb::arg("master"), nb::arg("now"), nb::arg("reference"),
        nb::arg("pair_offsets"), nb::arg("pair_facets"), nb::arg("patch"),
        nb::arg("around_offsets"), nb::arg("around_facets"), nb::arg("around_local"),
        nb::arg("more_offsets"), nb::arg("more_nodes"), nb::arg("straight_points"),
        nb::arg("straight_weights"), nb::arg("skew_points"), nb::arg("skew_weights"),
        nb::arg("current_area"), nb::arg("tangent"), nb::arg("threads"));
  m.def("mortar_slopes", &mortar_slopes, nb::arg("which"), nb::arg("by"), nb::arg("moving"),
        nb::arg("lift"), nb::arg("d_weight"), nb::arg("threads"));
  m.def("mortar_couplings", &mortar_couplings, nb::arg("which"), nb::arg("slopes"),
        nb::arg("traction"), nb::arg("support"), nb::arg("area"), nb::arg("weight"),
        nb::arg("d_area"), nb::arg("d_weight"), nb::arg("threads"));
}

}  // namespace anisocontact::bindings
