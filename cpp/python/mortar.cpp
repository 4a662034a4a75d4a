// Mortar weights of slave nodes.

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/mortar/couplings.hpp"
#include "anisocontact/mortar/nodal_weights.hpp"
#include "arrays.hpp"
#include "bindings.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

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

using Rows = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Cube = nb::ndarray<const double, nb::shape<-1, -1, -1>, nb::c_contig, nb::device::cpu>;

/// Memory of tangents, from one evaluation to the next.
struct MortarMemory {
  std::shared_ptr<Pool> pool{std::make_shared<Pool>()};
};

/// Arrays of Python that the weights refer to as long as they are there.
struct Given {
  surface::Topology slave_topology, master_topology;
  Table slave, master;
  Points now, reference;
  Offsets pair_offsets;
  Indices pair_facets;
  Table patch;
  Offsets around_offsets;
  Indices around_facets, around_local;
  Rows support;
  Coordinates straight_points;
  Scalars straight_weights;
  Coordinates skew_points;
  Scalars skew_weights;
  Scalars whole;
  bool current_area;
  std::shared_ptr<Pool> pool;
};

/// Mortar weights of the nodes of slave facets, see cpp/include/anisocontact/mortar/.
class MortarWeights {
 public:
  MortarWeights(const Given& given, const Offsets& more_offsets, const Indices& more_nodes,
                std::size_t threads)
      : given_(given), facets_(given.slave.shape(0)) {
    const std::size_t n = given_.patch.shape(0);
    const mortar::ListView more{more_offsets.data(), more_nodes.data()};
    std::vector<std::vector<std::int32_t>> masters(n);
    {
      nb::gil_scoped_release free;
      kernel::parallel_pieces(facets_.size(), threads, [&](std::size_t first, std::size_t last) {
        mortar::WeightMemory memory;
        for (std::size_t f = first; f < last; ++f) find(f, false, memory, facets_[f]);
      });
      kernel::parallel_for(n, threads, [&](std::size_t i) {
        masters[i] = mortar::masters_of(facets_, patches_, more, i);
      });
    }
    std::size_t most = 1;
    for (const auto& m : masters) most = std::max(most, m.size());
    Array<std::int32_t> nodes({n, most}, unset);
    std::fill_n(nodes.data, n * most, -1);
    Array<double> area({n}), weight({n, most});
    counts_.resize(n);
    nodal_ = {most,        nodes.data,     area.data,
              weight.data, counts_.data(), std::vector<std::vector<std::int32_t>>(n)};
    {
      nb::gil_scoped_release free;
      kernel::parallel_for(n, threads, [&](std::size_t i) {
        mortar::collect(facets_, patches_, masters[i], i, nodal_);
      });
    }
    masters_ = nodes.array;
    area_ = area.array;
    weight_ = weight.array;
  }

  const auto& masters() const { return masters_; }
  const auto& area() const { return area_; }
  const auto& weight() const { return weight_; }

  using Part = std::tuple<std::size_t, std::optional<Table>, Cube>;
  nb::tuple tangent(const Indices& which, const Cube& by, const Cube& lift, const Points& traction,
                    const std::vector<Part>& moving, std::size_t threads) const;

 private:
  void find(std::size_t f, bool slopes, mortar::WeightMemory& memory,
            mortar::DualWeights& out) const {
    mortar::MortarInput in = in_;
    in.slopes = slopes;
    mortar::dual_weights(in, f, {pairs_.begin(f), pairs_.end(f)}, memory, out);
  }

  Given given_;
  mortar::MortarInput in_{
      {given_.slave_topology, given_.slave.data(), given_.slave.shape(0)},
      {given_.master_topology, given_.master.data(), given_.master.shape(0)},
      given_.now.data(),
      given_.current_area ? nullptr : given_.reference.data(),
      {{given_.straight_points.data(), given_.straight_weights.data(),
        given_.straight_weights.shape(0)},
       {given_.skew_points.data(), given_.skew_weights.data(), given_.skew_weights.shape(0)}},
      {given_.whole.data(), given_.whole.shape(0)},
      false};
  mortar::ListView pairs_{given_.pair_offsets.data(), given_.pair_facets.data()};
  mortar::Patches patches_{{given_.around_offsets.data(), given_.around_facets.data()},
                           {given_.around_offsets.data(), given_.around_local.data()},
                           given_.patch.data(),
                           given_.patch.shape(1)};
  std::vector<mortar::DualWeights> facets_;
  std::vector<std::int32_t> counts_;
  mortar::NodalWeights nodal_{};
  nb::ndarray<nb::numpy, std::int32_t> masters_;
  nb::ndarray<nb::numpy, double> area_, weight_;
};

/// Derivative of the tractions of some slave nodes, (p, 3, columns, 4), of which the last numbers do not count,
/// and blocks of the tangent of the forces: rows, columns, (k, 3, 3).
nb::tuple MortarWeights::tangent(const Indices& which, const Cube& by, const Cube& lift,
                                 const Points& traction, const std::vector<Part>& moving,
                                 std::size_t threads) const {
  const std::size_t p = which.shape(0), slaves = in_.slave.width(), nodes = given_.now.shape(0);
  const mortar::Nodes n{in_,   facets_, patches_, given_.support.data(), given_.support.shape(1),
                        nodal_};
  const mortar::Chosen chosen{which.data(), p, by.data(), lift.data(), traction.data()};
  std::vector<mortar::MovingPart> parts;
  for (const auto& [first, named, values] : moving)
    parts.push_back(
        {first, values.shape(1), values.shape(2), named ? named->data() : nullptr, values.data()});
  std::vector<std::int32_t> chosen_at(facets_.size() * slaves, -1);
  for (std::size_t q = 0; q < p; ++q)
    for (std::size_t e = 0, i = chosen.node(q); e < patches_.facet.size(i); ++e)
      chosen_at[static_cast<std::size_t>(patches_.facet.begin(i)[e]) * slaves +
                static_cast<std::size_t>(patches_.local.begin(i)[e])] =
          static_cast<std::int32_t>(q);
  mortar::FacetRows of_facets(n, chosen, chosen_at);
  mortar::NodeRows of_nodes(n, chosen);
  const Array<double> by_facet({of_facets.size()}, given_.pool),
      by_node({of_nodes.size()}, given_.pool);
  Array<double> slopes({p, 3, n.columns(), mortar::column_size}, given_.pool);
  of_facets.use(by_facet.data);
  of_nodes.use(by_node.data, slopes.data);
  std::vector<std::vector<std::int32_t>> columns;
  std::optional<mortar::ForceRows> rows;
  std::vector<std::size_t> offset{0};
  {
    nb::gil_scoped_release free;
    kernel::parallel_pieces(facets_.size(), threads, [&](std::size_t first, std::size_t last) {
      mortar::WeightMemory memory;
      mortar::DualWeights one;
      mortar::RowMemory kept(0);
      for (std::size_t f = first; f < last; ++f) {
        if (!of_facets.any(f)) continue;
        find(f, true, memory, one);
        of_facets.put(f, one, kept);
      }
    });
    kernel::parallel_pieces(p, threads, [&](std::size_t first, std::size_t last) {
      mortar::RowMemory memory(nodes);
      for (std::size_t q = first; q < last; ++q) of_nodes.find(q, of_facets, parts, memory);
    });
    rows.emplace(n, chosen, of_nodes, of_facets, nodes);
    columns.resize(rows->nodes().size());
    kernel::parallel_pieces(columns.size(), threads, [&](std::size_t first, std::size_t last) {
      std::vector<std::int32_t> seen(nodes, -1), found;
      for (std::size_t r = first; r < last; ++r) {
        rows->columns(rows->nodes()[r], seen, found);
        columns[r].assign(found.begin(), found.end());
      }
    });
    for (const auto& one : columns) offset.push_back(offset.back() + one.size());
  }
  Array<std::int32_t> row({offset.back(), 1}, unset), column({offset.back(), 1}, unset);
  Array<double> values({offset.back(), 1, 1, 3, 3}, given_.pool);
  {
    nb::gil_scoped_release free;
    kernel::parallel_pieces(columns.size(), threads, [&](std::size_t first, std::size_t last) {
      mortar::RowMemory memory(nodes);
      for (std::size_t r = first; r < last; ++r) {
        std::fill_n(row.data + offset[r], columns[r].size(), rows->nodes()[r]);
        std::copy(columns[r].begin(), columns[r].end(), column.data + offset[r]);
        rows->write(rows->nodes()[r], columns[r], memory,
                    values.data + offset[r] * mortar::block_size);
      }
    });
  }
  return nb::make_tuple(slopes.array, row.array, column.array, values.array);
}

}  // namespace

void bind_mortar(nb::module_& m) {
  nb::class_<MortarMemory>(m, "MortarMemory").def(nb::init<>());
  nb::class_<MortarWeights>(m, "MortarWeights")
      .def(
          "__init__",
          [](MortarWeights* self, const std::string& slave_topology, const Table& slave,
             const std::string& master_topology, const Table& master, const Points& now,
             const Points& reference, const Offsets& pair_offsets, const Indices& pair_facets,
             const Table& patch, const Offsets& around_offsets, const Indices& around_facets,
             const Indices& around_local, const Rows& support, const Offsets& more_offsets,
             const Indices& more_nodes, const Coordinates& straight_points,
             const Scalars& straight_weights, const Coordinates& skew_points,
             const Scalars& skew_weights, const Scalars& whole, bool current_area,
             const MortarMemory& memory, std::size_t threads) {
            new (self) MortarWeights({named(slave_topology),
                                      named(master_topology),
                                      slave,
                                      master,
                                      now,
                                      reference,
                                      pair_offsets,
                                      pair_facets,
                                      patch,
                                      around_offsets,
                                      around_facets,
                                      around_local,
                                      support,
                                      straight_points,
                                      straight_weights,
                                      skew_points,
                                      skew_weights,
                                      whole,
                                      current_area,
                                      memory.pool},
                                     more_offsets, more_nodes, threads);
          },
          nb::arg("slave_topology"), nb::arg("slave"), nb::arg("master_topology"),
          nb::arg("master"), nb::arg("now"), nb::arg("reference"), nb::arg("pair_offsets"),
          nb::arg("pair_facets"), nb::arg("patch"), nb::arg("around_offsets"),
          nb::arg("around_facets"), nb::arg("around_local"), nb::arg("support"),
          nb::arg("more_offsets"), nb::arg("more_nodes"), nb::arg("straight_points"),
          nb::arg("straight_weights"), nb::arg("skew_points"), nb::arg("skew_weights"),
          nb::arg("whole"), nb::arg("current_area"), nb::arg("memory"), nb::arg("threads"))
      .def_prop_ro("masters", &MortarWeights::masters, nb::rv_policy::reference)
      .def_prop_ro("area", &MortarWeights::area, nb::rv_policy::reference)
      .def_prop_ro("weight", &MortarWeights::weight, nb::rv_policy::reference)
      .def("tangent", &MortarWeights::tangent, nb::arg("which"), nb::arg("by"), nb::arg("lift"),
           nb::arg("traction"), nb::arg("moving"), nb::arg("threads"));
}

}  // namespace anisocontact::bindings
