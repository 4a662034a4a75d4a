// Batches of slave points against the facets of a mesh: tractions, nodal forces and tangents.

#include <nanobind/stl/optional.h>

#include <span>

#include "anisocontact/kernel/parallel.hpp"
#include "bindings.hpp"
#include "facet_blocks.hpp"
#include "facet_output.hpp"
#include "given_law.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

using Nodes = nb::ndarray<const std::int32_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Gradients = nb::ndarray<const double, nb::shape<-1, -1, 2>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// The laws of slave points that meet facets.
struct FacetInterface {
  kernel::InterfaceLaw law;
  std::shared_ptr<Pool> pool = std::make_shared<Pool>();  ///< for blocks

  bool on(kernel::Side side) const {
    const auto is = [&](const kernel::Directions& d) { return d.field && d.side == side; };
    return is(law.adhesion_directions) || is(law.friction_directions) ||
           is(law.friction_directions_second);
  }
};

/// Arguments of a batch.
struct Input {
  Batch batch;
  States states;
  const bool* near;
  double dt;
  std::size_t points, nodes, threads;
  BatchLaw law;

  template <bool tangent>
  kernel::PairResult update(const FacetInterface& h, std::size_t p, const kernel::PointState& old,
                            const kernel::PairPoint& point, kernel::PairSlopes* slopes) const {
    return law.at(p, [&](const kernel::Law& reacts) {
      return kernel::update_pair<tangent>(h.law, reacts, old, point, dt, slopes);
    });
  }
};

using Squares = nb::ndarray<const double, nb::shape<-1, 3, 3>, nb::c_contig, nb::device::cpu>;

/// A method with the arguments of a batch, which calls `run<tangent>(interface, input)`.
template <class Run>
void def_batch(nb::class_<FacetInterface>& c, const char* name, const Run& run) {
  c.def(
      name,
      [run](const FacetInterface& h, const Bytes& state, double dt, const Nodes& slave_nodes,
            const Table& slave_shape, const Gradients& slave_gradient, const Scalars& weight,
            bool current_area, const Points& now, const Points& reference,
            const Nodes& connectivity, const Codes& topology, const Flags& flip,
            const Indices& facet, const Coordinates& xi, const Codes& feature,
            const Coordinates& edge, const Squares& held, const Flags& near, bool with_tangent,
            std::size_t threads, const std::optional<Table>& outputs) -> nb::dict {
        const std::size_t n = facet.shape(0), ks = slave_nodes.shape(1), km = connectivity.shape(1);
        if (ks > kernel::most_nodes || km > kernel::most_nodes)
          throw std::invalid_argument("a facet has at most 9 nodes");
        const Batch b{
            {now.data(), reference.data(), connectivity.data(), km, topology.data(), flip.data()},
            {slave_nodes.data(), slave_shape.data(), slave_gradient.data(), weight.data(), ks,
             current_area},
            {facet.data(), xi.data(), edge.data(), held.shape(0) == n ? held.data() : nullptr,
             feature.data()},
            h.on(kernel::Side::master),
            h.on(kernel::Side::slave)};
        const Input q{b,
                      States(state, n),
                      with_tangent ? near.data() : nullptr,
                      dt,
                      n,
                      now.shape(0),
                      threads,
                      BatchLaw(h.law, outputs, n)};
        return with_tangent ? run.template operator()<true>(h, q)
                            : run.template operator()<false>(h, q);
      },
      nb::arg("state"), nb::arg("dt"), nb::arg("slave_nodes"), nb::arg("slave_shape"),
      nb::arg("slave_gradient"), nb::arg("weight"), nb::arg("current_area"), nb::arg("now"),
      nb::arg("reference"), nb::arg("connectivity"), nb::arg("topology"), nb::arg("flip"),
      nb::arg("facet"), nb::arg("xi"), nb::arg("feature"), nb::arg("edge"), nb::arg("held"),
      nb::arg("near"), nb::arg("tangent"), nb::arg("threads"),
      nb::arg("outputs").none() = nb::none());
}

/// What a law that is not in the core sees at the points.
nb::dict law_input(const FacetInterface& h, const Input& q) {
  const LawInputs inputs(q.points);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(q.points, q.threads, [&](std::size_t i) {
      const kernel::PointState old = q.states[i];
      Seen s;
      q.batch.see(old, i, s);
      kernel::LawInput input;
      const auto r = kernel::update_pair<false>(h.law, kernel::Recorder(input), old, s.point, q.dt);
      inputs.put(i, input, r.state);
    });
  }
  return inputs.result();
}

/// Evaluates some points, one after the other. Only their blocks are for the widest registers: fused
/// products would move the digits of a point that is evaluated alone, or without a tangent.
template <bool tangent>
ANISOCONTACT_INLINE void evaluate(const FacetInterface& h, const Input& q,
                                  std::span<const std::size_t> points, Output& out,
                                  [[maybe_unused]] BlockWriter& writer) {
  constexpr std::size_t ahead = 2;
  kernel::PairSlopes by;
  Seen s;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t p = points[i];
    q.states.prefetch(points[std::min(i + ahead, points.size() - 1)]);
    const kernel::PointState old = q.states[p];
    q.batch.see(old, p, s);
    const auto r = q.update<tangent>(h, p, old, s.point, &by);
    // before the output: what goes to far memory is in the way of what is read back at once
    if constexpr (tangent)
      if (touches(r)) writer.add(p, r, by, s, old.facet);
    out.put(p, r, tangent ? &by : nullptr, s);
  }
}

/// Forces of nodes and blocks of facets that meet.
template <bool tangent>
nb::dict assemble(const FacetInterface& h, const Input& q) {
  const Slots slots(q.batch, q.states, q.near, q.points);
  Output out(q.points, q.batch);
  const std::size_t ks = q.batch.slave.width, km = q.batch.mesh.width;
  const PairBlocks blocks{{slots.facets.size(), ks + km, ks + km, h.pool},
                          {slots.history.size(), ks + km, km, h.pool}};
  {
    nb::gil_scoped_release free;
    kernel::parallel_pieces(
        slots.runs.size() - 1, q.threads, [&](std::size_t first, std::size_t last) {
          BlockWriter writer(q.batch, slots, blocks);
          const std::span points(slots.order.data() + slots.runs[first],
                                 slots.order.data() + slots.runs[last]);
          with_unfused(
              [&]() ANISOCONTACT_INLINE_LAMBDA { evaluate<tangent>(h, q, points, out, writer); });
        });
    blocks.own.clear_rest();
    blocks.earlier.clear_rest();
  }
  nb::dict d = out.result();
  d["force"] = out.forces(q.batch, q.points, q.nodes).array;
  d["blocks"] = nb::make_tuple(blocks.own.result(), blocks.earlier.result());
  return d;
}

/// Updates each point by itself, and puts what it gives into `out` and where `put` puts it: for the
/// number of the point, its result and slopes, what it has seen and the facet of its history.
template <bool tangent, class Put>
void update_each(const FacetInterface& h, const Input& q, Output& out, const Put& put) {
  nb::gil_scoped_release free;
  kernel::parallel_for(q.points, q.threads, [&](std::size_t p) {
    const kernel::PointState old = q.states[p];
    Seen s;
    q.batch.see(old, p, s);
    kernel::PairSlopes by;
    const auto r = q.update<tangent>(h, p, old, s.point, &by);
    out.put(p, r, tangent ? &by : nullptr, s);
    put(p, r, by, s, old.facet);
  });
}

/// Residual and tangent of each point by itself: rows of the slave's and the master's nodes, columns
/// of these and of the facet on which the history was committed. Beside them what slip makes of the residual.
template <bool tangent>
nb::dict update(const FacetInterface& h, const Input& q) {
  const std::size_t ks = q.batch.slave.width, km = q.batch.mesh.width, n = q.points;
  const std::size_t rows = 3 * (ks + km), columns = rows + 3 * km;
  Output out(n, q.batch);
  Array<double> residual({n, rows}), matrix({tangent ? n : 0, rows, columns}, h.pool),
      by_slip({tangent ? n : 0, 3, rows});
  Array<std::int32_t> nodes({n, ks + 2 * km}, unset);
  std::fill_n(nodes.data, n * (ks + 2 * km), -1);
  const auto put = [&](std::size_t p, const kernel::PairResult& r,
                       [[maybe_unused]] const kernel::PairSlopes& d, const Seen& s,
                       std::int64_t committed) {
    std::int32_t* const id = nodes.data + p * (ks + 2 * km);
    std::copy_n(q.batch.slave.nodes + p * ks, ks, id);
    if (!touches(r)) {
      if constexpr (tangent) std::fill_n(matrix.data + p * rows * columns, rows * columns, 0.0);
      return;
    }
    q.batch.mesh.copy_nodes(s.point.facet, id + ks);
    if (committed >= 0) q.batch.mesh.copy_nodes(committed, id + ks + km);
    kernel::add_residual(r, s.shapes, residual.data + p * rows);
    if constexpr (tangent) {
      constexpr std::size_t most = 3 * 2 * kernel::most_nodes;
      std::array<double, most * most> own, earlier;
      kernel::add_tangent(r, d, s.shapes, {own.data(), true}, {earlier.data(), true});
      kernel::add_slip_residuals(d, s.shapes, by_slip.data + 3 * p * rows);
      double* to = matrix.data + p * rows * columns;
      for (std::size_t i = 0; i < rows; ++i) {
        to = std::copy_n(own.data() + i * rows, rows, to);
        to = std::copy_n(earlier.data() + i * 3 * km, 3 * km, to);
      }
    }
  };
  update_each<tangent>(h, q, out, put);
  nb::dict d = out.result();
  d["nodes"] = nodes.array;
  d["residual"] = residual.array;
  d["tangent"] = matrix.array;
  d["by_slip"] = by_slip.array;
  return d;
}

/// Derivatives of the tractions of points that lie on the first node of their facets, with areas of one:
/// columns of the nodes of the slave, of the master and of the facet on which the history was committed;
/// and those by slip.
template <bool tangent>
nb::dict tractions(const FacetInterface& h, const Input& q) {
  const std::size_t ks = q.batch.slave.width, km = q.batch.mesh.width, n = q.points;
  const std::size_t near = 3 * (ks + km), columns = near + 3 * km;
  Output out(n, q.batch);
  Array<double> slopes({tangent ? n : 0, 3, columns}, h.pool), by_slip({tangent ? n : 0, 3, 3});
  update_each<tangent>(
      h, q, out,
      [&](std::size_t p, const kernel::PairResult& r, [[maybe_unused]] const kernel::PairSlopes& by,
          const Seen& s, std::int64_t) {
        if constexpr (tangent) {
          double* const to = slopes.data + 3 * p * columns;
          if (touches(r)) {
            kernel::traction_slopes(r, by, s.shapes, to);
            put9(by_slip.data, p, by.by_slip);
          } else {
            std::fill_n(to, 3 * columns, 0.0);
          }
        }
      });
  nb::dict d = out.result();
  d["slopes"] = slopes.array;
  d["by_slip"] = by_slip.array;
  return d;
}

}  // namespace

void bind_facet_interface(nb::module_& m) {
  nb::class_<FacetInterface> c(m, "FacetInterface");
  c.def(
      "__init__",
      [](FacetInterface* self, const LawHandle& law) { new (self) FacetInterface{law.law}; },
      nb::arg("law"));
  def_batch(c, "law_input",
            []<bool>(const FacetInterface& h, const Input& q) { return law_input(h, q); });
  def_batch(c, "update", []<bool tangent>(const FacetInterface& h, const Input& q) {
    return update<tangent>(h, q);
  });
  def_batch(c, "tractions", []<bool tangent>(const FacetInterface& h, const Input& q) {
    return tractions<tangent>(h, q);
  });
  def_batch(c, "assemble", []<bool tangent>(const FacetInterface& h, const Input& q) {
    return assemble<tangent>(h, q);
  });
}

}  // namespace anisocontact::bindings
