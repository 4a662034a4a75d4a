// Mortar weights of one slave facet over a grid of master facets, for all pairs of topologies: they
// add up to the area, and their derivatives are those of central differences, to second order.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "anisocontact/mortar/dual_weights.hpp"

namespace anisocontact {
namespace {

using surface::Topology;

/// Weights and points of the middle of a triangle and of its edges' middles: enough for a test of
/// derivatives, whatever the functions.
const std::vector<double> rule_points{1.0 / 6, 1.0 / 6, 2.0 / 3, 1.0 / 6, 1.0 / 6, 2.0 / 3};
const std::vector<double> rule_weights{1.0 / 6, 1.0 / 6, 1.0 / 6};

/// Nodes of a grid of n x n facets over a square, moved at random, and the facets.
struct Grid {
  Topology topology;
  std::vector<double> x;
  std::vector<std::int32_t> nodes;
};

/// Every facet has its own copies of the nodes: neighbours need not share them here.
Grid grid(Topology t, int n, double size, double height, std::mt19937& random) {
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  Grid g{t, {}, {}};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (std::size_t a = 0; a < surface::node_count(t); ++a) {
        constexpr std::array<std::array<double, 2>, 9> at{
            {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0}, {0, 0.5}, {1, 0.5}, {0.5, 1}, {0.5, 0.5}}};
        constexpr std::array<std::array<double, 2>, 6> three{
            {{0, 0}, {1, 0}, {0, 1}, {0.5, 0.5}, {0, 0.5}, {0.5, 0}}};
        const auto& xi = surface::triangular(t) ? three[a] : at[a];
        g.nodes.push_back(static_cast<std::int32_t>(g.x.size() / 3));
        g.x.push_back((i + xi[0]) * size / n + noise(random));
        g.x.push_back((j + xi[1]) * size / n + noise(random));
        g.x.push_back(height + noise(random));
      }
  return g;
}

/// Both grids in one mesh: nodes of the slave first.
struct Pair {
  std::vector<double> x;
  std::vector<std::int32_t> slave, master, candidates;
  mortar::MortarInput input;

  Pair(const Grid& s, const Grid& m, bool current) : x(s.x), slave(s.nodes), master(m.nodes) {
    const auto first = static_cast<std::int32_t>(x.size() / 3);
    x.insert(x.end(), m.x.begin(), m.x.end());
    for (auto& node : master) node += first;
    reference = x;
    for (double& v : reference) v *= 1.1;
    const mortar::TriangleRule rule{rule_points.data(), rule_weights.data(), rule_weights.size()};
    const std::size_t count = master.size() / surface::node_count(m.topology);
    input = {{s.topology, slave.data(), 1},
             {m.topology, master.data(), count},
             x.data(),
             current ? nullptr : reference.data(),
             {rule, rule},
             true};
    for (std::size_t i = 0; i < count; ++i) candidates.push_back(static_cast<std::int32_t>(i));
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  ~Pair() = default;

  mortar::DualWeights weights() const {
    return mortar::dual_weights(input, 0, candidates.data(), candidates.size());
  }

 private:
  std::vector<double> reference;
};

bool right(Topology s, Topology m, bool current) {
  std::mt19937 random(7);
  Pair pair(grid(s, 1, 1.0, 0.02, random), grid(m, 2, 1.2, 0.0, random), current);
  const mortar::DualWeights w = pair.weights();
  if (w.masters.empty()) return false;
  const double off = (w.weight.rowwise().sum() - w.area).cwiseAbs().maxCoeff();
  std::normal_distribution<double> normal;
  std::vector<double> way(pair.x.size());
  for (double& v : way) v = normal(random);
  const auto slaves = static_cast<Eigen::Index>(surface::node_count(s));
  Eigen::VectorXd along(w.d_area.cols());
  for (Eigen::Index c = 0; c < along.size() / 3; ++c) {
    const auto node =
        static_cast<std::size_t>(c < slaves ? pair.slave[static_cast<std::size_t>(c)]
                                            : w.masters[static_cast<std::size_t>(c - slaves)]);
    for (std::size_t i = 0; i < 3; ++i)
      along[3 * c + static_cast<Eigen::Index>(i)] = way[3 * node + i];
  }
  const auto moved = [&](double h) {
    for (std::size_t i = 0; i < way.size(); ++i) pair.x[i] += h * way[i];
    const mortar::DualWeights there = pair.weights();
    for (std::size_t i = 0; i < way.size(); ++i) pair.x[i] -= h * way[i];
    return there;
  };
  std::array<double, 2> error{};
  for (std::size_t k = 0; k < 2; ++k) {
    const double h = k == 0 ? 1e-5 : 1e-6;
    const mortar::DualWeights plus = moved(h), minus = moved(-h);
    const Eigen::VectorXd area = (plus.area - minus.area) / (2.0 * h) - w.d_area * along;
    Eigen::VectorXd weight = w.d_weight * along;
    for (Eigen::Index i = 0; i < w.weight.rows(); ++i)
      for (Eigen::Index j = 0; j < w.weight.cols(); ++j)
        weight[i * w.weight.cols() + j] -= (plus.weight(i, j) - minus.weight(i, j)) / (2.0 * h);
    error[k] = std::max(area.cwiseAbs().maxCoeff(), weight.cwiseAbs().maxCoeff());
  }
  const bool good = off < 1e-12 && (error[1] < 0.02 * error[0] || error[1] < 1e-7);
  if (!good)
    std::printf("topologies %d on %d: sum off by %.1e, errors %.1e %.1e\n", static_cast<int>(s),
                static_cast<int>(m), off, error[0], error[1]);
  return good;
}

}  // namespace
}  // namespace anisocontact

int main() {
  using anisocontact::surface::Topology;
  bool good = true;
  for (const Topology s : {Topology::tri3, Topology::quad4, Topology::tri6, Topology::quad9})
    for (const Topology m : {Topology::tri3, Topology::quad4, Topology::tri6, Topology::quad9})
      for (const bool current : {true, false}) good &= anisocontact::right(s, m, current);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
