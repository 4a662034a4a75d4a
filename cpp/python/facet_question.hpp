#pragma once
// Batches of slave points against the facets of a mesh: tractions, nodal forces and tangents. What a
// law does at a point is said by its handle:
//   at<tangent>(number of the point, committed state, point, dt, slopes).

#include <nanobind/stl/pair.h>

#include "anisocontact/kernel/parallel.hpp"
#include "facet_answer.hpp"
#include "facet_blocks.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

using Nodes = nb::ndarray<const std::int32_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Gradients = nb::ndarray<const double, nb::shape<-1, -1, 2>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// A law for slave points that meet facets.
struct PairHandle {
  kernel::InterfaceLaw law;
  bool mirrored;
  std::shared_ptr<Pool> pool = std::make_shared<Pool>();  ///< for blocks

  bool on(kernel::Side side) const {
    const auto is = [&](const kernel::Directions& d) { return d.field && d.side == side; };
    return is(law.adhesion_directions) || is(law.friction_directions) ||
           is(law.friction_directions_second);
  }

  template <bool tangent>
  kernel::PairResult at(std::size_t, const kernel::PointState& state, const kernel::PairPoint& p,
                        double dt, kernel::PairSlopes* d) const noexcept {
    return kernel::update_pair<tangent>(law, state, p, dt, d);
  }
};

/// Arguments of both ways to ask for a batch.
struct Question {
  Batch batch;
  const std::uint8_t* state;
  const bool* near;
  double dt;
  std::size_t points, nodes, threads;
};

template <class Handle, class Ask>
auto with_question(const Ask& ask) {
  return [ask](const Handle& h, const Bytes& state, double dt, const Nodes& slave_nodes,
               const Table& slave_shape, const Gradients& slave_gradient, const Scalars& weight,
               bool current_area, const Points& now, const Points& reference,
               const Nodes& connectivity, const Codes& topology, const Flags& flip,
               const Indices& facet, const Coordinates& xi, const Codes& feature,
               const Coordinates& edge, const Flags& near, bool with_tangent,
               std::size_t threads) -> nb::dict {
    const std::size_t n = facet.shape(0), ks = slave_nodes.shape(1), km = connectivity.shape(1);
    check_states(state, n);
    if (ks > kernel::most_nodes || km > kernel::most_nodes)
      throw std::invalid_argument("a facet has at most 9 nodes");
    const Batch b{
        {now.data(), reference.data(), connectivity.data(), km, topology.data(), flip.data()},
        {slave_nodes.data(), slave_shape.data(), slave_gradient.data(), weight.data(), ks,
         current_area},
        {facet.data(), xi.data(), edge.data(), feature.data()},
        h.mirrored,
        h.on(kernel::Side::master),
        h.on(kernel::Side::slave)};
    const Question q{
        b, state.data(), with_tangent ? near.data() : nullptr, dt, n, now.shape(0), threads};
    return with_tangent ? ask.template operator()<true>(h, q)
                        : ask.template operator()<false>(h, q);
  };
}

inline nb::dict common(const Answer& a) {
  nb::dict d;
  d["state"] = a.state.array;
  d["traction"] = a.traction.array;
  d["normal"] = a.normal.array;
  d["adhesion_axes"] = a.adhesion.array;
  d["friction_axes"] = a.friction.array;
  d["failure"] = a.failure.array;
  d["area"] = a.area.array;
  d["stiffness"] = a.stiffness.array;
  return d;
}

/// Forces of nodes and blocks of facets that meet.
template <bool tangent, class Handle>
nb::dict assemble(const Handle& h, const Question& q) {
  const Slots slots(q.batch, q.state, q.near, q.points);
  Answer out(q.points, q.batch);
  const std::size_t ks = q.batch.slave.width, km = q.batch.mesh.width;
  const PairBlocks blocks{{slots.facets.size(), ks + km, ks + km, h.pool},
                          {slots.history.size(), ks + km, km, h.pool}};
  {
    nb::gil_scoped_release free;
    kernel::parallel_pieces(slots.runs.size() - 1, q.threads,
                            [&](std::size_t first, std::size_t last) {
                              BlockWriter writer(q.batch, slots, blocks);
                              kernel::PairSlopes by;
                              Seen s;
                              for (std::size_t i = slots.runs[first]; i < slots.runs[last]; ++i) {
                                const std::size_t p = slots.order[i];
                                prefetch(q.state, slots.order[std::min(i + 2, q.points - 1)]);
                                const kernel::PointState old = load(q.state, p);
                                q.batch.see(old, p, s);
                                const auto r = h.template at<tangent>(p, old, s.point, q.dt, &by);
                                out.put(p, r, tangent ? &by : nullptr, s);
                                if constexpr (tangent)
                                  if (touches(r)) writer.add(p, r, by, s, old.facet);
                              }
                            });
    blocks.own.clear_rest();
    blocks.earlier.clear_rest();
  }
  nb::dict d = common(out);
  d["force"] = out.forces(q.batch, q.points, q.nodes).array;
  d["blocks"] = nb::make_tuple(blocks.own.result(), blocks.earlier.result());
  return d;
}

/// Residual and tangent of each point by itself: rows of the slave's and the master's nodes, columns
/// of these and of the facet on which the history was committed.
template <bool tangent, class Handle>
nb::dict update(const Handle& h, const Question& q) {
  const std::size_t ks = q.batch.slave.width, km = q.batch.mesh.width, n = q.points;
  const std::size_t rows = 3 * (ks + km), columns = rows + 3 * km;
  Answer out(n, q.batch);
  Array<double> residual({n, rows}), matrix({tangent ? n : 0, rows, columns});
  Array<std::int32_t> nodes({n, ks + 2 * km});
  std::fill_n(residual.data, n * rows, 0.0);
  std::fill_n(matrix.data, tangent ? n * rows * columns : 0, 0.0);
  std::fill_n(nodes.data, n * (ks + 2 * km), -1);
  const auto put = [&](std::size_t p, const kernel::PairResult& r,
                       [[maybe_unused]] const kernel::PairSlopes& d, const Seen& s,
                       std::int64_t committed) {
    std::int32_t* const id = nodes.data + p * (ks + 2 * km);
    std::copy_n(q.batch.slave.nodes + p * ks, ks, id);
    if (!touches(r)) return;
    q.batch.mesh.copy_nodes(s.point.facet, id + ks);
    if (committed >= 0) q.batch.mesh.copy_nodes(committed, id + ks + km);
    kernel::add_residual(r, s.shapes, residual.data + p * rows);
    if constexpr (tangent) {
      constexpr std::size_t most = 3 * 2 * kernel::most_nodes;
      std::array<double, most * most> own, earlier;
      kernel::add_tangent(r, d, s.shapes, {own.data(), true}, {earlier.data(), true});
      double* to = matrix.data + p * rows * columns;
      for (std::size_t i = 0; i < rows; ++i) {
        to = std::copy_n(own.data() + i * rows, rows, to);
        to = std::copy_n(earlier.data() + i * 3 * km, 3 * km, to);
      }
    }
  };
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, q.threads, [&](std::size_t p) {
      const kernel::PointState old = load(q.state, p);
      Seen s;
      q.batch.see(old, p, s);
      kernel::PairSlopes by;
      const auto r = h.template at<tangent>(p, old, s.point, q.dt, &by);
      out.put(p, r, tangent ? &by : nullptr, s);
      put(p, r, by, s, old.facet);
    });
  }
  nb::dict d = common(out);
  d["nodes"] = nodes.array;
  d["residual"] = residual.array;
  d["tangent"] = matrix.array;
  return d;
}

/// A method that asks a handle with the arguments of a batch.
template <class Handle, class Ask>
void def_question(nb::class_<Handle>& c, const char* name, const Ask& ask) {
  c.def(name, with_question<Handle>(ask), nb::arg("state"), nb::arg("dt"), nb::arg("slave_nodes"),
        nb::arg("slave_shape"), nb::arg("slave_gradient"), nb::arg("weight"),
        nb::arg("current_area"), nb::arg("now"), nb::arg("reference"), nb::arg("connectivity"),
        nb::arg("topology"), nb::arg("flip"), nb::arg("facet"), nb::arg("xi"), nb::arg("feature"),
        nb::arg("edge"), nb::arg("near"), nb::arg("tangent"), nb::arg("threads"));
}

/// Both ways to ask for a batch.
template <class Handle>
void def_questions(nb::class_<Handle>& c) {
  def_question(c, "update", []<bool tangent>(const Handle& h, const Question& q) {
    return update<tangent>(h, q);
  });
  def_question(c, "assemble", []<bool tangent>(const Handle& h, const Question& q) {
    return assemble<tangent>(h, q);
  });
}

}  // namespace anisocontact::bindings
