#pragma once
// Mortar weights of one slave facet: dual functions psi_i of its covered part,
//   integral of psi_i N_j = delta_ij integral of N_j   [Wohlmuth 2000],
// biorthogonal on what the master covers [Cichosz Bischoff 2011], and with them
//   D_i = integral of N_i,   W_ik = integral of psi_i M_k = D_i (m^-1 c)_ik .
// Where hardly anything of a node is covered, psi_i is added to those of the others.

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

#include "anisocontact/mortar/integrator.hpp"
#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::mortar {

/// Facets of a mesh.
struct Facets {
  Topology topology;
  const std::int32_t* nodes;  ///< (count, node_count)
  std::size_t count;

  std::size_t width() const { return surface::node_count(topology); }
  std::int32_t node(std::size_t f, std::size_t a) const { return nodes[f * width() + a]; }
  Facet at(std::size_t f, const double* x) const {
    Facet out{topology, {}};
    for (std::size_t a = 0; a < width(); ++a) {
      const double* p = x + 3 * static_cast<std::size_t>(node(f, a));
      out.x[a] = {p[0], p[1], p[2]};
    }
    return out;
  }
};

/// Weights of a facet and their derivatives: three columns for each node of the facet, then of
/// `masters`.
struct DualWeights {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<std::int32_t> masters;  ///< nodes, ascending
  Eigen::VectorXd area;               ///< D
  Matrix weight;                      ///< W, (slaves, masters)
  Matrix d_area, d_weight;            ///< (slaves, columns), (slaves * masters, columns)
};

namespace detail {

using Eigen::Index;

/// The inverse of m, column by column; whether there is one. Rows and columns are scaled to a diagonal
/// of one, so that the size of what is covered does not matter, and no row has to change places.
template <std::size_t L>
ANISOCONTACT_ONCE bool invert(const Integrals<L>& in, std::size_t n, std::array<Lanes<L>, L>& out) {
  constexpr double least = 1e-13;
  std::array<double, L> unit{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!(in.value[i][i] > 0.0)) return false;
    unit[i] = 1.0 / std::sqrt(in.value[i][i]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out[i].set(j, unit[i] * unit[j] * in.value[j][i]);
  for (std::size_t k = 0; k < n; ++k) {
    const double pivot = out[k][k];
    if (!(pivot > least)) return false;
    out[k].set(k, 1.0);
    out[k] = (1.0 / pivot) * out[k];
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double share = out[i][k];
      out[i].set(k, 0.0);
      out[i].add(-share, out[k]);
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out[i].set(j, unit[i] * unit[j] * out[i][j]);
  return true;
}

/// A matrix of columns side by side, times x.
template <std::size_t L>
ANISOCONTACT_INLINE Lanes<L> times(const std::array<Lanes<L>, L>& m, const Lanes<L>& x) {
  Lanes<L> product;
  each<L>([&](std::size_t j) ANISOCONTACT_INLINE_LAMBDA { product.add(x[j], m[j]); });
  return product;
}

/// Derivatives of W = D z, z = m^-1 c, where P = D m^-1: dW = P (dc - dm z) + z dD. `memory` is for P dm and
/// dD.
template <std::size_t L>
ANISOCONTACT_INLINE void put_slopes(const Integrals<L>& in, std::size_t n,
                                    const std::array<Lanes<L>, L>& p,
                                    const std::vector<Lanes<L>>& z, std::vector<Lanes<L>>& memory,
                                    DualWeights& out) {
  const std::size_t count = in.rows - n, columns = in.columns;
  out.d_area.resize(static_cast<Index>(n), static_cast<Index>(columns));
  out.d_weight.resize(static_cast<Index>(n * count), static_cast<Index>(columns));
  memory.resize((L + 1) * columns);  // functions that are not there give zero
  for (std::size_t c = 0; c < columns; ++c) {
    Lanes<L> grown;
    for (std::size_t j = 0; j < L; ++j) {
      const Lanes<L> slope = j < n ? in.slope[j * columns + c] : Lanes<L>();
      grown.add(1.0, slope);
      memory[(L + 1) * c + j] = times(p, slope);
    }
    memory[(L + 1) * c + L] = grown;
    for (std::size_t i = 0; i < n; ++i) out.d_area.data()[i * columns + c] = grown[i];
  }
  for (std::size_t k = 0; k < count; ++k) {
    double* const to = out.d_weight.data() + k * columns;
    const Lanes<L> own = z[k], minus = -own;
    for (std::size_t c = 0; c < columns; ++c) {
      const Lanes<L>* const moved = memory.data() + (L + 1) * c;
      Lanes<L> slope = times(p, in.slope[(n + k) * columns + c]) + own * moved[L];
      each<L>([&](std::size_t j) ANISOCONTACT_INLINE_LAMBDA { slope.add(minus[j], moved[j]); });
      for (std::size_t i = 0; i < n; ++i) to[i * count * columns + c] = slope[i];
    }
  }
}

/// W = D m^-1 c with its derivatives; whether m can be inverted.
template <std::size_t L>
ANISOCONTACT_INLINE bool put_weights(const Integrals<L>& in, std::size_t n,
                                     std::vector<Lanes<L>>& z, std::vector<Lanes<L>>& memory,
                                     DualWeights& out) {
  const std::size_t count = in.rows - n;
  std::array<Lanes<L>, L> inverse;  // zero from n on
  if (!invert(in, n, inverse)) return false;
  Lanes<L> area;
  for (std::size_t j = 0; j < n; ++j) area.add(1.0, in.value[j]);
  z.resize(count);
  out.area.resize(static_cast<Index>(n));
  out.weight.resize(static_cast<Index>(n), static_cast<Index>(count));
  // On a part near a corner functions are close to dependent: a second step takes what the inverse has lost.
  for (std::size_t k = 0; k < count; ++k) {
    z[k] = times(inverse, in.value[n + k]);
    Lanes<L> left = in.value[n + k];
    for (std::size_t j = 0; j < n; ++j) left.add(-z[k][j], in.value[j]);
    z[k].add(1.0, times(inverse, left));
  }
  for (std::size_t i = 0; i < n; ++i) {
    out.area[static_cast<Index>(i)] = area[i];
    for (std::size_t k = 0; k < count; ++k) out.weight.data()[i * count + k] = area[i] * z[k][i];
  }
  if (in.slope.empty()) return true;
  for (Lanes<L>& one : inverse) one = area * one;
  put_slopes(in, n, inverse, z, memory, out);
  return true;
}

/// Shares of its weight that are covered, over that of the node of the facet of which most is, below
/// which a node gives all of its weights away and above which it keeps them: dual functions of less
/// extrapolate from a strip to where nothing is covered.
inline constexpr double given = 0.15, kept = 0.25;

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
inline std::array<DualWeights::Matrix, 2> slopes_handed_over(const Eigen::VectorXd& per_whole,
                                                             const DualWeights& in,
                                                             const HandOver& by) {
  if (in.d_area.cols() == 0) return {};
  const double largest = in.area[by.most] * per_whole[by.most];
  const Eigen::ArrayXd t = ((kept - by.covered.array()) / (kept - given)).max(0.0).min(1.0);
  const Eigen::VectorXd slope = -6.0 * t * (1.0 - t) / ((kept - given) * largest);
  DualWeights::Matrix gives = per_whole.asDiagonal() * in.d_area;
  gives -= by.covered * Eigen::RowVectorXd(gives.row(by.most));
  gives = slope.asDiagonal() * gives;
  const Eigen::VectorXd whole = per_whole.cwiseInverse();
  DualWeights::Matrix gets = by.gets * (whole.transpose() * gives) - whole.asDiagonal() * gives;
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

/// Gives the weights of nodes that would be extrapolated to the other nodes of the facet, so that a
/// uniform traction is still handed over exactly; `whole` are the weights where all is covered.
inline void hand_over(std::span<const double> whole, DualWeights& out) {
  if (!any_gives(whole, out.area)) return;
  const auto n = static_cast<Index>(whole.size()), columns = out.d_area.cols();
  const Eigen::VectorXd per_whole =
      Eigen::Map<const Eigen::VectorXd>(whole.data(), n).cwiseInverse();
  const HandOver by = shares_handed_over(per_whole, out.area);
  if (!(by.gives.maxCoeff() > 0.0)) return;
  const auto [d_gives, d_gets] = slopes_handed_over(per_whole, out, by);
  const Eigen::VectorXd keeps = 1.0 - by.gives.array();
  // x_i becomes (1 - lambda_i) x_i + q_i sum_j lambda_j x_j
  const auto move = [&, &d_give = d_gives, &d_get = d_gets](DualWeights::Matrix& x,
                                                            DualWeights::Matrix& dx) {
    const Eigen::RowVectorXd sum = by.gives.transpose() * x;
    for (Index k = 0; k < x.cols() && columns > 0; ++k) {
      Eigen::RowVectorXd d_sum = Eigen::RowVectorXd::Zero(columns);
      for (Index j = 0; j < n; ++j)
        d_sum += d_give.row(j) * x(j, k) + by.gives[j] * dx.row(j * x.cols() + k);
      for (Index i = 0; i < n; ++i) {
        auto row = dx.row(i * x.cols() + k);
        row = keeps[i] * row - d_give.row(i) * x(i, k) + d_get.row(i) * sum[k] + by.gets[i] * d_sum;
      }
    }
    x = (keeps.asDiagonal() * x + by.gets * sum).eval();
  };
  move(out.weight, out.d_weight);
  DualWeights::Matrix area = out.area;
  move(area, out.d_area);
  out.area = area;
}

}  // namespace detail

/// What the weights of facets are found from.
struct MortarInput {
  Facets slave, master;
  const double *now,
      *reference;  ///< positions of the nodes; no reference where areas are those of now
  Rules rules;
  std::span<const double>
      whole;  ///< weights of a facet all of which is covered; none: see `hand_over`
  bool slopes;
};

/// What weights are found in; it keeps its memory from one facet to the next.
class WeightMemory {
 public:
  template <std::size_t L>
  struct Of {
    Integrals<L> total;
    IntegratorMemory<L> integrator;
    std::vector<Lanes<L>> solved, moved;
  };
  template <std::size_t L>
  Of<L>& of() {
    return std::get<Of<L>>(of_);
  }
  std::vector<SlavePart> parts;
  std::vector<Overlap> found;

 private:
  std::tuple<Of<4>, Of<8>, Of<12>> of_;
};

namespace detail {

/// Overlaps of a slave facet with facets of the master; none where it has no plane.
inline void find_overlaps(const MortarInput& in, const Facet& slave, std::size_t f,
                          std::span<const std::int32_t> candidates, WeightMemory& memory) {
  memory.parts.clear();
  memory.found.clear();
  const auto sub = sub_facets(slave.topology);
  memory.parts.reserve(sub.size());
  for (const SubFacet& part : sub) {
    SlavePart& own = memory.parts.emplace_back(slave, part);
    if (!own.valid()) return memory.found.clear();
    if (in.reference != nullptr) own.scale_to(in.slave.at(f, in.reference));
    for (const std::int32_t c : candidates) {
      const auto g = static_cast<std::size_t>(c);
      own.find(in.master.at(g, in.now), g, memory.found);
    }
  }
}

}  // namespace detail

/// Weights of a slave facet against facets of the master; none where nothing is covered.
inline void dual_weights(const MortarInput& in, std::size_t f,
                         std::span<const std::int32_t> candidates, WeightMemory& memory,
                         DualWeights& out) {
  const Facet slave = in.slave.at(f, in.now);
  detail::find_overlaps(in, slave, f, candidates, memory);
  out.masters.clear();
  out.masters.reserve(memory.found.size() * in.master.width());
  for (const Overlap& o : memory.found)
    for (std::size_t a = 0; a < in.master.width(); ++a)
      out.masters.push_back(in.master.node(o.facet, a));
  std::sort(out.masters.begin(), out.masters.end());
  out.masters.erase(std::unique(out.masters.begin(), out.masters.end()), out.masters.end());
  if (memory.found.empty()) return;
  const SubFacet* const first = sub_facets(slave.topology).data();
  const bool any = with_lanes(slave.nodes(), [&](auto lanes) {
    auto& own = memory.of<lanes>();
    own.total.begin(slave.nodes(), out.masters.size(), in.slopes);
    Integrator<lanes> integrator(slave, in.rules, own.integrator, own.total);
    bool good = false;
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (const Overlap& o : memory.found) {
        std::array<std::size_t, most> column{};
        for (std::size_t a = 0; a < in.master.width(); ++a)
          column[a] =
              3 * (slave.nodes() +
                   static_cast<std::size_t>(std::lower_bound(out.masters.begin(), out.masters.end(),
                                                             in.master.node(o.facet, a)) -
                                            out.masters.begin()));
        integrator.add(memory.parts[static_cast<std::size_t>(o.slave - first)], o,
                       in.master.at(o.facet, in.now), column);
      }
      good = detail::put_weights(own.total, slave.nodes(), own.solved, own.moved, out);
    });
    return good;
  });
  if (!any) return out.masters.clear();
  if (!in.whole.empty()) detail::hand_over(in.whole, out);
}

}  // namespace anisocontact::mortar
