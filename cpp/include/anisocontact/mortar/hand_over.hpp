#pragma once
// What nodes of a slave facet of which hardly anything is covered give to the others: dual functions,
//   psi_i' = (1 - lambda_i) psi_i + q_i sum_j lambda_j psi_j .
// So psi_i' has integrals with the functions of several nodes of the slave,
//   integral of psi_i' N_j = delta_ij D_i' - E_ij ,   E_ij = q_i (delta_ij sum_k lambda_k D_k - lambda_j D_j) ,
// and forces act where the traction is. E stands beside W: the gap is D_i' x_i - sum_k W_ik x_k - sum_j E_ij x_j.

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "anisocontact/mortar/facet_weights.hpp"

namespace anisocontact::mortar::detail {

using Eigen::Index;
using Matrix = DualWeights::Matrix;

/// Shares of its weight that are covered, over that of the node of the facet of which most is, below
/// which a node gives all of its weights away and above which it keeps them: dual functions of less
/// extrapolate from a strip to where nothing is covered.
inline constexpr double given = 0.2, kept = 0.3;

/// What nodes of a facet give away and what they get of it.
struct HandOver {
  Eigen::VectorXd covered, gives,
      gets;    ///< shares: covered, of the node's own, and of what all give
  Index most;  ///< the node of which most is covered
};

/// Shares lambda that nodes give, smooth in what is covered, and those q that they get,
///   lambda = t^2 (3 - 2 t), t = (kept - s) / (kept - given), s = D_i / D_i^whole over the largest,
///   q_i = (1 - lambda_i) D_i^whole / sum_k (1 - lambda_k) D_k^whole .
/// So a node gets no more of others than suits its own: in equal shares the mean of the master that a vertex
/// of order 2 meets would lie facets away. Weights of now would let those of which little is covered get
/// next to nothing, and carry a force on a sliver that a slip of the border takes away.
inline HandOver shares_handed_over(const Eigen::VectorXd& per_whole, const Eigen::VectorXd& area) {
  HandOver out;
  const Eigen::VectorXd covered = area.cwiseProduct(per_whole);
  const double largest = covered.maxCoeff(&out.most);
  out.covered = covered / largest;
  const Eigen::ArrayXd t = ((kept - out.covered.array()) / (kept - given)).max(0.0).min(1.0);
  out.gives = t * t * (3.0 - 2.0 * t);
  out.gets = (1.0 - out.gives.array()) / per_whole.array();
  out.gets /= out.gets.sum();
  return out;
}

/// Derivatives of what nodes give and get, (slaves, columns) each.
inline std::array<Matrix, 2> slopes_handed_over(const Eigen::VectorXd& per_whole,
                                                const DualWeights& in, const HandOver& by) {
  if (in.d_area.cols() == 0) return {};
  const double largest = in.area[by.most] * per_whole[by.most];
  const Eigen::ArrayXd t = ((kept - by.covered.array()) / (kept - given)).max(0.0).min(1.0);
  const Eigen::VectorXd slope = -6.0 * t * (1.0 - t) / ((kept - given) * largest);
  Matrix gives = per_whole.asDiagonal() * in.d_area;
  gives -= by.covered * Eigen::RowVectorXd(gives.row(by.most));
  gives = slope.asDiagonal() * gives;
  const Eigen::VectorXd whole = per_whole.cwiseInverse();
  Matrix gets = by.gets * (whole.transpose() * gives) - whole.asDiagonal() * gives;
  gets /= whole.dot(Eigen::VectorXd(1.0 - by.gives.array()));
  return {gives, gets};
}

/// Whether any node of a facet gives anything away.
inline bool any_gives(std::span<const double> whole, const Eigen::VectorXd& area) {
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const double covered = area[static_cast<Index>(i)] / whole[i];
    least = std::min(least, covered);
    largest = std::max(largest, covered);
  }
  return !(least >= kept * largest);
}

/// Shares of the nodes of a facet in its slave points, whose functions the multipliers are dual to, (n, n);
/// see `transform`.
inline Matrix points_of(Topology t) {
  const auto n = static_cast<Index>(surface::node_count(t));
  Matrix out = Matrix::Identity(n, n);
  if (t != Topology::tri6) return out;
  for (Index e = 3; e < n; ++e) {
    out.row(e).head(3).setConstant(-edge_share / (1.0 - 2.0 * edge_share));
    out(e, e - 3) = 0.0;
    out(e, e) = 1.0 / (1.0 - 2.0 * edge_share);
  }
  return out;
}

/// E of the nodes of a facet and its derivatives by the columns of the weights, (n n, columns).
struct OwnWeights {
  Matrix value, slope;

  OwnWeights(Topology t, const HandOver& by, const std::array<Matrix, 2>& slopes,
             const DualWeights& in) {
    const Matrix points = points_of(t);
    const Index n = points.rows(), columns = in.d_area.cols();
    const Eigen::VectorXd moved = by.gives.cwiseProduct(in.area);
    Matrix rest = moved.sum() * points;
    rest.rowwise() -= moved.transpose() * points;
    value = by.gets.asDiagonal() * rest;
    if (columns == 0) return;
    const auto& [d_gives, d_gets] = slopes;
    Matrix d_moved = by.gives.asDiagonal() * in.d_area;
    d_moved += in.area.asDiagonal() * d_gives;
    const Eigen::RowVectorXd d_sum = d_moved.colwise().sum();
    const Matrix at_nodes = points.transpose() * d_moved;
    slope.resize(n * n, columns);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        slope.row(i * n + j) =
            rest(i, j) * d_gets.row(i) + by.gets[i] * (points(i, j) * d_sum - at_nodes.row(j));
  }
};

/// x_i becomes (1 - lambda_i) x_i + q_i sum_j lambda_j x_j, x of (n, k).
inline void hand_over_rows(const HandOver& by, const std::array<Matrix, 2>& slopes, Matrix& x,
                           Matrix& dx) {
  const auto& [d_gives, d_gets] = slopes;
  const Eigen::VectorXd keeps = 1.0 - by.gives.array();
  const Eigen::RowVectorXd sum = by.gives.transpose() * x;
  const Index n = x.rows(), columns = dx.cols();
  for (Index k = 0; k < x.cols() && columns > 0; ++k) {
    Eigen::RowVectorXd d_sum = Eigen::RowVectorXd::Zero(columns);
    for (Index j = 0; j < n; ++j)
      d_sum += d_gives.row(j) * x(j, k) + by.gives[j] * dx.row(j * x.cols() + k);
    for (Index i = 0; i < n; ++i) {
      auto row = dx.row(i * x.cols() + k);
      row = keeps[i] * row - d_gives.row(i) * x(i, k) + d_gets.row(i) * sum[k] + by.gets[i] * d_sum;
    }
  }
  x = (keeps.asDiagonal() * x + by.gets * sum).eval();
}

/// Places of nodes among others that are ascending.
inline std::vector<Index> places_in(const std::vector<std::int32_t>& all,
                                    std::span<const std::int32_t> nodes) {
  std::vector<Index> out;
  for (const std::int32_t node : nodes)
    out.push_back(std::lower_bound(all.begin(), all.end(), node) - all.begin());
  return out;
}

/// Has the nodes of the slave facet among those that there are weights on, without any.
inline void make_room(std::span<const std::int32_t> own, DualWeights& out) {
  std::vector<std::int32_t> nodes(own.begin(), own.end());
  nodes.insert(nodes.end(), out.masters.begin(), out.masters.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const auto n = static_cast<Index>(own.size()), count = static_cast<Index>(nodes.size());
  const std::vector<Index> to = places_in(nodes, out.masters);
  Matrix weight = Matrix::Zero(n, count);
  weight(Eigen::all, to) = out.weight;
  out.weight = weight;
  out.masters = nodes;
  if (out.d_area.cols() == 0) return;
  std::vector<Index> rows, columns(3 * own.size());
  std::iota(columns.begin(), columns.end(), Index{0});
  for (const Index k : to)
    for (Index axis = 0; axis < 3; ++axis) columns.push_back(3 * (n + k) + axis);
  for (Index i = 0; i < n; ++i)
    for (const Index k : to) rows.push_back(i * count + k);
  Matrix d_area = Matrix::Zero(n, 3 * (n + count));
  Matrix d_weight = Matrix::Zero(n * count, 3 * (n + count));
  d_area(Eigen::all, columns) = out.d_area;
  d_weight(rows, columns) = out.d_weight;
  out.d_area = d_area;
  out.d_weight = d_weight;
}

/// Gives the weights of nodes that would be extrapolated to the other nodes of the facet, so that a
/// uniform traction is still handed over exactly and moments balance. Its nodes are then among those that
/// there are weights on, with E.
///
/// `whole` are the weights where all is covered, `own` the nodes of the facet.
inline void hand_over(std::span<const double> whole, Topology topology,
                      std::span<const std::int32_t> own, DualWeights& out) {
  if (!any_gives(whole, out.area)) return;
  const auto n = static_cast<Index>(whole.size());
  const Eigen::VectorXd per_whole =
      Eigen::Map<const Eigen::VectorXd>(whole.data(), n).cwiseInverse();
  const HandOver by = shares_handed_over(per_whole, out.area);
  if (!(by.gives.maxCoeff() > 0.0)) return;
  make_room(own, out);
  const std::array<Matrix, 2> slopes = slopes_handed_over(per_whole, out, by);
  const OwnWeights of_own(topology, by, slopes, out);
  hand_over_rows(by, slopes, out.weight, out.d_weight);
  Matrix area = out.area;
  hand_over_rows(by, slopes, area, out.d_area);
  out.area = area;
  const std::vector<Index> to = places_in(out.masters, own);
  out.own = of_own.value;
  out.weight(Eigen::all, to) += out.own;
  std::vector<Index> rows;
  for (Index i = 0; i < n; ++i)
    for (const Index k : to) rows.push_back(i * out.weight.cols() + k);
  if (of_own.slope.size() > 0) out.d_weight(rows, Eigen::all) += of_own.slope;
}

}  // namespace anisocontact::mortar::detail
