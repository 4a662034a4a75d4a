#pragma once
// The output of a batch at its points, and the forces on the nodes that follow.

#include <vector>

#include "facet_batch.hpp"

namespace anisocontact::bindings {

inline bool touches(const kernel::PairResult& r) {
  return r.state.status != 0 && r.failure == kernel::Failure::none;
}

/// The output of a batch at the points.
struct Output {
  std::size_t ks, km;
  Array<std::uint8_t> state;
  Array<double> traction, normal, adhesion, friction, area, stiffness;
  Array<double> on_master;  ///< forces on the nodes of the facet, of points that touch
  Array<std::int8_t> failure;
  std::vector<std::uint8_t> touching;  ///< of each point, whether it has forces

  Output(std::size_t n, const Batch& b)
      : ks(b.slave.width),
        km(b.mesh.width),
        state({n, sizeof(kernel::PointState)}, unset),
        traction({n, 3}, unset),
        normal({n, 3}, unset),
        adhesion({n, 2, 3}, unset),
        friction({n, 2, 3}, unset),
        area({n}, unset),
        stiffness({n}, unset),
        on_master({n, b.mesh.width, 3}, unset),
        failure({n}, unset),
        touching(n) {}

  /// With the slopes of a point that touches.
  ANISOCONTACT_INLINE void put(std::size_t p, const kernel::PairResult& r,
                               const kernel::PairSlopes* d, const Seen& s) {
    store(state.data, p, r.state);
    put3(traction.data, p, r.traction);
    put3(normal.data, p, r.normal);
    for (std::size_t k = 0; k < 2; ++k) {
      put3(adhesion.data, 2 * p + k, r.adhesion_axes[k]);
      put3(friction.data, 2 * p + k, r.friction_axes[k]);
    }
    failure.data[p] = static_cast<std::int8_t>(r.failure);
    area.data[p] = s.shapes.area.value();
    stiffness.data[p] = d != nullptr && touches(r) ? size_of_block(p, *d, s) : 0.0;
    touching[p] = touches(r) ? 1 : 0;
    if (touches(r)) put_on_master(p, r, s.shapes.master);
  }

  nb::dict result() const {
    nb::dict d;
    d["state"] = state.array;
    d["traction"] = traction.array;
    d["normal"] = normal.array;
    d["adhesion_axes"] = adhesion.array;
    d["friction_axes"] = friction.array;
    d["failure"] = failure.array;
    d["area"] = area.array;
    d["stiffness"] = stiffness.array;
    return d;
  }

  /// Forces on the nodes, point after point.
  Array<double> forces(const Batch& b, std::size_t n, std::size_t nodes) const {
    Array<double> f({nodes, 3});
    std::fill_n(f.data, 3 * nodes, 0.0);
    const auto add = [&](std::int32_t node, const Vec3<double>& t) {
      if (node >= 0)
        put3(f.data, static_cast<std::size_t>(node),
             row3(f.data, static_cast<std::size_t>(node)) + t);
    };
    for (std::size_t p = 0; p < n; ++p) {
      if (touching[p] == 0) continue;
      const Vec3<double> t = area.data[p] * row3(traction.data, p);
      for (std::size_t a = 0; a < ks; ++a)
        add(b.slave.nodes[p * ks + a], b.slave.shape[p * ks + a] * t);
      for (std::size_t c = 0; c < km; ++c)
        add(b.mesh.node_or_none(b.hits.facet[p], c), row3(on_master.data, p * km + c));
    }
    return f;
  }

 private:
  ANISOCONTACT_INLINE void put_on_master(std::size_t p, const kernel::PairResult& r,
                                         const NodalShape& shape) const {
    const double dA = area.data[p];
    const Vec3<double> t = dA * r.traction, m0 = dA * r.couple[0], m1 = dA * r.couple[1];
    for (std::size_t c = 0; c < km; ++c)
      put3(on_master.data, p * km + c, shape.dN[c][0] * m0 + shape.dN[c][1] * m1 - shape.N[c] * t);
  }
  /// Size of a point's block: of |dt/dx| and of the shape functions on both sides.
  ANISOCONTACT_INLINE double size_of_block(std::size_t p, const kernel::PairSlopes& d,
                                           const Seen& s) const {
    double squares = 0.0;
    for (const auto* shape : {&s.shapes.slave, &s.shapes.master})
      for (std::size_t a = 0; a < shape->count; ++a) squares += shape->N[a] * shape->N[a];
    return area.data[p] * squares * d.size();
  }
};

}  // namespace anisocontact::bindings
