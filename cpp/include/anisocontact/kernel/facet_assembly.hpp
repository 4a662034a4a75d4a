#pragma once
// Nodal forces and tangent block of one slave point: the virtual work
//   - t . (delta x_s - delta rho) ds = - t . (sum_a N_a delta x_a - sum_b M_b(xi) delta x_b) J w
// and its derivative with respect to the nodes of the slave facet, of the master facet and of the
// facet on which the history was committed.

#include <span>

#include "anisocontact/kernel/facet_pair.hpp"

namespace anisocontact::kernel {

inline constexpr std::size_t most_nodes = 9;

/// Shape functions at a point and their first derivatives.
struct NodalShape {
  std::size_t count{0};
  std::array<double, most_nodes> n{};
  std::array<std::array<double, 2>, most_nodes> dn{};
};

/// Area of the slave point: weight of the quadrature and, where the area is the current one, the
/// tangents of the slave facet.
struct SlaveArea {
  double weight{0.0};
  bool current{true};
  std::array<Vec3<double>, 2> tangents{Vec3<double>::Zero(), Vec3<double>::Zero()};
};

using Matrix3 = Eigen::Matrix3d;

namespace detail {

/// How traction, coordinates of the projection and area change with one node.
struct NodeDerivative {
  Matrix3 traction{Matrix3::Zero()};
  Eigen::Matrix<double, 2, 3> xi{Eigen::Matrix<double, 2, 3>::Zero()};
  Vec3<double> area{Vec3<double>::Zero()};
};

inline void add_input(NodeDerivative& d, const PairResult& r, Input group, double factor) {
  const auto first = 3 * static_cast<Eigen::Index>(group);
  d.traction += factor * r.d_traction.middleCols<3>(first);
  d.xi += factor * r.d_xi.middleCols<3>(first);
}

/// Derivatives with respect to node `a` of the slave facet.
inline NodeDerivative of_slave(const PairResult& r, const NodalShape& slave, const SlaveArea& area,
                               const Vec3<double>& unit_area, std::size_t a) {
  NodeDerivative d;
  add_input(d, r, Input::slave, slave.n[a]);
  if (area.current)
    d.area = slave.dn[a][0] * area.tangents[1].cross(unit_area) +
             slave.dn[a][1] * unit_area.cross(area.tangents[0]);
  return d;
}

inline NodeDerivative of_master(const PairResult& r, const NodalShape& master, std::size_t b) {
  NodeDerivative d;
  add_input(d, r, Input::position, master.n[b]);
  add_input(d, r, Input::tangent_1, master.dn[b][0]);
  add_input(d, r, Input::tangent_2, master.dn[b][1]);
  return d;
}

inline NodeDerivative of_before(const PairResult& r, const NodalShape& before, std::size_t c) {
  NodeDerivative d;
  add_input(d, r, Input::before_position, before.n[c]);
  add_input(d, r, Input::before_tangent_1, before.dn[c][0]);
  add_input(d, r, Input::before_tangent_2, before.dn[c][1]);
  return d;
}

}  // namespace detail

/// Adds the residual, rows (slave nodes, master nodes), and its tangent, columns (slave nodes,
/// master nodes, nodes of the committed facet), three components a node. `columns` is the length
/// of a row of the tangent.
inline void assemble_pair(const PairResult& r, const NodalShape& slave, const SlaveArea& area,
                          const NodalShape& master, const NodalShape& before,
                          std::span<double> residual, std::span<double> tangent,
                          std::size_t columns) noexcept {
  const Vec3<double> normal_area = area.tangents[0].cross(area.tangents[1]);
  const double size = area.current ? normal_area.norm() : 1.0;
  const Vec3<double> unit_area =
      area.current ? Vec3<double>(normal_area / size) : Vec3<double>(Vec3<double>::Zero());
  const double w = area.weight;
  const auto row_value = [&](std::size_t a) {
    return a < slave.count ? -slave.n[a] : master.n[a - slave.count];
  };
  const std::size_t rows = slave.count + master.count;
  for (std::size_t a = 0; a < rows; ++a)
    for (std::size_t i = 0; i < 3; ++i)
      residual[3 * a + i] += w * size * row_value(a) * r.traction[static_cast<Eigen::Index>(i)];
  if (tangent.empty()) return;
  const auto add_column = [&](std::size_t c, const detail::NodeDerivative& d) {
    const Matrix3 force = r.traction * d.area.transpose() + size * d.traction;
    for (std::size_t a = 0; a < rows; ++a) {
      Matrix3 block = row_value(a) * force;
      if (a >= slave.count) {
        const auto& dn = master.dn[a - slave.count];
        block += size * r.traction * (dn[0] * d.xi.row(0) + dn[1] * d.xi.row(1));
      }
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          tangent[(3 * a + i) * columns + 3 * c + j] +=
              w * block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  };
  std::size_t c = 0;
  for (std::size_t a = 0; a < slave.count; ++a)
    add_column(c++, detail::of_slave(r, slave, area, unit_area, a));
  for (std::size_t b = 0; b < master.count; ++b) add_column(c++, detail::of_master(r, master, b));
  for (std::size_t b = 0; b < before.count; ++b) add_column(c++, detail::of_before(r, before, b));
}

}  // namespace anisocontact::kernel
