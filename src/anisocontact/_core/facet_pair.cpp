// Batches of slave points against the facets of a mesh: tractions, nodal forces and tangents.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <vector>

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
  /// -1 beyond the nodes of a facet.
  std::int32_t node_or_none(std::int64_t facet, std::size_t i) const {
    const auto f = static_cast<std::size_t>(facet);
    return i < kind(f).nodes() ? node(f, i) : -1;
  }
  void copy_nodes(std::int64_t facet, std::int32_t* to) const {
    for (std::size_t i = 0; i < width; ++i) to[i] = node_or_none(facet, i);
  }
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

/// Facets of fewer nodes than the widest have zeros at the end.
NodalShape nodal(std::size_t count, const surface::Shape<double>& s) {
  NodalShape r;
  r.count = count;
  r.n = s.N;
  r.dn = s.dN;
  return r;
}

struct PairHandle {
  kernel::InterfaceLaw law;
  bool mirrored;
  std::shared_ptr<Pool> pool = std::make_shared<Pool>();  ///< for blocks

  bool on(kernel::Side side) const {
    const auto is = [&](const kernel::Directions& d) { return d.field && d.side == side; };
    return is(law.adhesion_directions) || is(law.friction_directions) ||
           is(law.friction_directions_second);
  }
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
  bool mirrored, on_master, on_slave;  ///< on whose reference there are directions

  void see_slave(std::size_t p, Seen& s) const {
    auto& own = s.point.own;
    for (auto* j : {&own.now, &own.reference}) {
      j->position.setZero();
      j->d1 = {Vec3<double>::Zero(), Vec3<double>::Zero()};
    }
    for (std::size_t a = 0; a < slave.width; ++a) {
      const auto node = static_cast<std::size_t>(slave.nodes[p * slave.width + a]);
      add_node(s.shapes.slave, a, row3(mesh.now, node), own.now);
      if (on_slave) add_node(s.shapes.slave, a, row3(mesh.reference, node), own.reference);
    }
    s.point.slave = own.now.position;
    s.shapes.area.tangents = own.now.d1;
  }

  surface::Shape<double> master_shape(std::size_t p) const {
    surface::Shape<double> shape;
    surface::shape(mesh.kind(static_cast<std::size_t>(hits.facet[p])), hits.xi[2 * p],
                   hits.xi[2 * p + 1], shape);
    return shape;
  }

  void see_master(std::size_t p, Seen& s) const {
    const auto f = static_cast<std::size_t>(hits.facet[p]);
    s.point.facet = hits.facet[p];
    s.point.master.xi = {hits.xi[2 * p], hits.xi[2 * p + 1]};
    s.point.edge = {hits.edge[2 * p], hits.edge[2 * p + 1]};
    const surface::Shape<double> shape = master_shape(p);
    s.shapes.master = nodal(mesh.width, shape);
    s.shapes.bend = shape.d2N;
    s.point.master.now = surface::facet_jet(mesh.kind(f), mesh.nodes(mesh.now, f), shape);
    if (on_master)
      s.point.master.reference =
          surface::facet_jet(mesh.kind(f), mesh.nodes(mesh.reference, f), shape);
  }

  void see_committed(const kernel::PointState& state, Seen& s) const {
    const auto c = static_cast<std::size_t>(state.facet);
    surface::Shape<double> shape;
    surface::shape(mesh.kind(c), state.xi[0], state.xi[1], shape);
    s.shapes.before = nodal(mesh.width, shape);
    s.point.before = surface::facet_jet(mesh.kind(c), mesh.nodes(mesh.now, c), shape);
  }

  Seen see(const kernel::PointState& state, std::size_t p) const {
    Seen s;
    s.shapes.slave = slave.at(p);
    s.shapes.area.weight = slave.weight[p];
    s.shapes.area.current = slave.current_area;
    see_slave(p, s);
    s.point.mirrored = mirrored;
    s.point.feature = static_cast<kernel::Feature>(hits.feature[p]);
    if (s.point.feature == kernel::Feature::off) return s;
    see_master(p, s);
    if (state.facet >= 0) see_committed(state, s);
    return s;
  }

 private:
  static void add_node(const NodalShape& s, std::size_t a, const Vec3<double>& x,
                       surface::Jet<double>& j) {
    j.position += s.n[a] * x;
    for (std::size_t i = 0; i < 2; ++i) j.d1[i] += s.dn[a][i] * x;
  }
};

/// Points of one slave facet that lie one after the other share a block where they meet the same
/// facet, and one more where their history is from the same other facet. Blocks belong to a run of
/// points, so that a run can be summed by one thread, in the same order whatever the threads.
struct Slots {
  static constexpr std::int32_t none = -1;
  std::vector<std::size_t> runs;                     ///< first point of each run, and the end
  std::vector<std::int32_t> own, earlier;            ///< of each point
  std::vector<std::array<std::int32_t, 2>> facets;   ///< run and facet of each own block
  std::vector<std::array<std::int32_t, 2>> history;  ///< own block and facet of each earlier one

  Slots(const Batch& b, const std::uint8_t* state, const bool* near, std::size_t n)
      : own(n, none), earlier(n, none) {
    for (std::size_t p = 0; p < n; ++p) {
      if (p == 0 || !same_slave(b.slave, p - 1, p)) begin(p);
      if (near == nullptr || !near[p] || b.hits.feature[p] == off) continue;
      const std::array<std::int32_t, 2> key{static_cast<std::int32_t>(runs.size()) - 1,
                                            b.hits.facet[p]};
      own[p] = find(facets, first_own_, key);
      const auto committed = static_cast<std::int32_t>(load(state, p).facet);
      if (committed >= 0 && committed != b.hits.facet[p])
        earlier[p] = find(history, first_earlier_, {own[p], committed});
    }
    runs.push_back(n);
  }

 private:
  static constexpr auto off = static_cast<std::int8_t>(kernel::Feature::off);

  static bool same_slave(const Slave& s, std::size_t p, std::size_t q) {
    return std::equal(s.nodes + p * s.width, s.nodes + (p + 1) * s.width, s.nodes + q * s.width);
  }
  void begin(std::size_t p) {
    runs.push_back(p);
    first_own_ = facets.size();
    first_earlier_ = history.size();
  }
  static std::int32_t find(std::vector<std::array<std::int32_t, 2>>& keys, std::size_t from,
                           const std::array<std::int32_t, 2>& key) {
    const auto at = std::find(keys.begin() + static_cast<std::ptrdiff_t>(from), keys.end(), key);
    const auto i = static_cast<std::int32_t>(at - keys.begin());
    if (at == keys.end()) keys.push_back(key);
    return i;
  }

  std::size_t first_own_{0}, first_earlier_{0};
};

/// Blocks of nodes in rows and columns, row by row; nodes that are -1 have none.
struct Blocks {
  std::size_t count, rows, columns;  ///< rows and columns: nodes
  Array<std::int32_t> row_nodes, column_nodes;
  Array<double> values;

  Blocks(std::size_t n, std::size_t r, std::size_t c, const std::shared_ptr<Pool>& pool)
      : count(n),
        rows(r),
        columns(c),
        row_nodes({n, r}),
        column_nodes({n, c}),
        values({n, 3 * r, 3 * c}, pool) {
    std::fill_n(row_nodes.data, n * r, -1);
    std::fill_n(column_nodes.data, n * c, -1);
  }

  double* at(std::int32_t slot) const {
    return slot < 0 ? nullptr : values.data + static_cast<std::size_t>(slot) * 9 * rows * columns;
  }
  std::int32_t* row_nodes_of(std::int32_t slot) const {
    return row_nodes.data + static_cast<std::size_t>(slot) * rows;
  }
  std::int32_t* column_nodes_of(std::int32_t slot) const {
    return column_nodes.data + static_cast<std::size_t>(slot) * columns;
  }
  bool fresh(std::int32_t slot) const { return *row_nodes_of(slot) < 0; }
  /// Blocks that no point was added to.
  void clear_rest() const {
    for (std::size_t i = 0; i < count; ++i)
      if (const auto slot = static_cast<std::int32_t>(i); fresh(slot))
        std::fill_n(at(slot), 9 * rows * columns, 0.0);
  }

  nb::tuple result() const {
    return nb::make_tuple(row_nodes.array, column_nodes.array, values.array);
  }
};

bool touches(const kernel::PairResult& r) {
  return r.state.status != 0 && r.failure == kernel::Failure::none;
}

/// Blocks of the facets that meet, and of those on which only the history was committed.
struct PairBlocks {
  Blocks own, earlier;

  /// Adds a point to its blocks; names their nodes where it is the first.
  void add(const Batch& b, const Slots& slots, std::size_t p, const kernel::PairResult& r,
           const kernel::PairSlopes& d, const Seen& s, std::int64_t committed) const {
    const std::int32_t o = slots.own[p], e = slots.earlier[p];
    if (o < 0) return;
    const std::size_t ks = b.slave.width;
    const auto name_rows = [&](std::int32_t* to) {
      to = std::copy_n(b.slave.nodes + p * ks, ks, to);
      b.mesh.copy_nodes(b.hits.facet[p], to);
    };
    const bool first = own.fresh(o), first_earlier = e >= 0 && earlier.fresh(e);
    if (first) {
      name_rows(own.row_nodes_of(o));
      name_rows(own.column_nodes_of(o));
    }
    if (first_earlier) {
      name_rows(earlier.row_nodes_of(e));
      b.mesh.copy_nodes(committed, earlier.column_nodes_of(e));
    }
    kernel::add_tangent(r, d, s.shapes, {own.at(o), first}, {earlier.at(e), first_earlier});
  }
};

/// What a batch answers at the points.
struct Answer {
  std::size_t ks, km;
  Array<std::uint8_t> state;
  Array<double> traction, couple, normal, adhesion, friction, area, stiffness;
  Array<std::int8_t> failure;

  Answer(std::size_t n, const Batch& b)
      : ks(b.slave.width),
        km(b.mesh.width),
        state({n, sizeof(kernel::PointState)}),
        traction({n, 3}),
        couple({n, 2, 3}),
        normal({n, 3}),
        adhesion({n, 2, 3}),
        friction({n, 2, 3}),
        area({n}),
        stiffness({n}),
        failure({n}) {}

  /// With the slopes of a point that touches.
  void put(std::size_t p, const kernel::PairResult& r, const kernel::PairSlopes* d,
           const Seen& s) const {
    store(state.data, p, r.state);
    put3(traction.data, p, r.traction);
    put3(normal.data, p, r.normal);
    for (std::size_t k = 0; k < 2; ++k) {
      put3(couple.data, 2 * p + k, r.couple[k]);
      put3(adhesion.data, 2 * p + k, r.adhesion_axes[k]);
      put3(friction.data, 2 * p + k, r.friction_axes[k]);
    }
    failure.data[p] = static_cast<std::int8_t>(r.failure);
    area.data[p] = s.shapes.area.value();
    stiffness.data[p] = d != nullptr && touches(r) ? size_of_block(p, *d, s) : 0.0;
  }

  /// Forces on the nodes, point after point.
  Array<double> forces(const Batch& b, std::size_t n, std::size_t nodes) const {
    Array<double> f({nodes, 3});
    std::fill_n(f.data, 3 * nodes, 0.0);
    const auto add = [&](std::int32_t node, const Vec3<double>& t) {
      if (node < 0) return;
      for (std::size_t i = 0; i < 3; ++i)
        f.data[3 * static_cast<std::size_t>(node) + i] += t[static_cast<Eigen::Index>(i)];
    };
    for (std::size_t p = 0; p < n; ++p) {
      if (load(state.data, p).status == 0 || failure.data[p] != 0) continue;
      const double dA = area.data[p];
      const Vec3<double> t = dA * row3(traction.data, p), m0 = dA * row3(couple.data, 2 * p),
                         m1 = dA * row3(couple.data, 2 * p + 1);
      for (std::size_t a = 0; a < ks; ++a)
        add(b.slave.nodes[p * ks + a], b.slave.shape[p * ks + a] * t);
      const auto shape = b.master_shape(p);
      for (std::size_t c = 0; c < km; ++c)
        add(b.mesh.node_or_none(b.hits.facet[p], c),
            shape.dN[c][0] * m0 + shape.dN[c][1] * m1 - shape.N[c] * t);
    }
    return f;
  }

 private:
  /// Size of a point's block: of |dt/dx| and of the shape functions on both sides.
  double size_of_block(std::size_t p, const kernel::PairSlopes& d, const Seen& s) const {
    double squares = 0.0;
    for (const auto* shape : {&s.shapes.slave, &s.shapes.master})
      for (std::size_t a = 0; a < shape->count; ++a) squares += shape->n[a] * shape->n[a];
    return area.data[p] * squares * d.matrix(0, kernel::index(kernel::Input::slave)).norm();
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

template <class Ask>
auto with_question(const Ask& ask) {
  return [ask](const PairHandle& h, const Bytes& state, double dt, const Nodes& slave_nodes,
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

nb::dict common(const Answer& a) {
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
template <bool tangent>
nb::dict assemble(const PairHandle& h, const Question& q) {
  const Slots slots(q.batch, q.state, q.near, q.points);
  Answer out(q.points, q.batch);
  const std::size_t ks = q.batch.slave.width, km = q.batch.mesh.width;
  const PairBlocks blocks{{slots.facets.size(), ks + km, ks + km, h.pool},
                          {slots.history.size(), ks + km, km, h.pool}};
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(slots.runs.size() - 1, q.threads, [&](std::size_t run) {
      for (std::size_t p = slots.runs[run]; p < slots.runs[run + 1]; ++p) {
        const kernel::PointState old = load(q.state, p);
        const Seen s = q.batch.see(old, p);
        kernel::PairSlopes by;
        const auto r = kernel::update_pair<tangent>(h.law, old, s.point, q.dt, &by);
        out.put(p, r, tangent ? &by : nullptr, s);
        if constexpr (tangent)
          if (touches(r)) blocks.add(q.batch, slots, p, r, by, s, old.facet);
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
template <bool tangent>
nb::dict update(const PairHandle& h, const Question& q) {
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
      const Seen s = q.batch.see(old, p);
      kernel::PairSlopes by;
      const auto r = kernel::update_pair<tangent>(h.law, old, s.point, q.dt, &by);
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

}  // namespace

void bind_facet_pair(nb::module_& m) {
  nb::class_<PairHandle>(m, "FacetPairs")
      .def(
          "__init__",
          [](PairHandle* self, const Named& normal, const Named& adhesion,
             const FieldHandle* adhesion_directions, const Named& friction,
             const FieldHandle* friction_directions, const FieldHandle* friction_second,
             const Named& rule, bool mirrored, const OnSlave& on_slave) {
            new (self) PairHandle{
                make_law(normal, adhesion, adhesion_directions, friction, friction_directions,
                         friction_second, rule, "transport", on_slave),
                mirrored};
          },
          nb::arg("normal"), nb::arg("adhesion"), nb::arg("adhesion_directions").none(),
          nb::arg("friction"), nb::arg("friction_directions").none(),
          nb::arg("friction_directions_second").none(), nb::arg("rule"),
          nb::arg("mirrored") = false, nb::arg("on_slave") = OnSlave{})
      .def("update", with_question([]<bool tangent>(const PairHandle& h, const Question& q) {
             return update<tangent>(h, q);
           }),
           nb::arg("state"), nb::arg("dt"), nb::arg("slave_nodes"), nb::arg("slave_shape"),
           nb::arg("slave_gradient"), nb::arg("weight"), nb::arg("current_area"), nb::arg("now"),
           nb::arg("reference"), nb::arg("connectivity"), nb::arg("topology"), nb::arg("flip"),
           nb::arg("facet"), nb::arg("xi"), nb::arg("feature"), nb::arg("edge"), nb::arg("near"),
           nb::arg("tangent"), nb::arg("threads"))
      .def("assemble", with_question([]<bool tangent>(const PairHandle& h, const Question& q) {
             return assemble<tangent>(h, q);
           }),
           nb::arg("state"), nb::arg("dt"), nb::arg("slave_nodes"), nb::arg("slave_shape"),
           nb::arg("slave_gradient"), nb::arg("weight"), nb::arg("current_area"), nb::arg("now"),
           nb::arg("reference"), nb::arg("connectivity"), nb::arg("topology"), nb::arg("flip"),
           nb::arg("facet"), nb::arg("xi"), nb::arg("feature"), nb::arg("edge"), nb::arg("near"),
           nb::arg("tangent"), nb::arg("threads"));
}

}  // namespace anisocontact::bindings
