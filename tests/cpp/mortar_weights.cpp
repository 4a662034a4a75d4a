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

/// Three points in each quarter of a triangle: as many as there are functions, whatever is covered.
/// Derivatives of what is integrated are exact by any rule.
const std::vector<double> rule_points = [] {
  const std::array<std::array<double, 3>, 4> quarter{
      {{0.0, 0.0, 0.5}, {0.5, 0.0, 0.5}, {0.0, 0.5, 0.5}, {0.5, 0.5, -0.5}}};
  std::vector<double> out;
  for (const auto& [x, y, size] : quarter)
    for (const auto& [u, v] : {std::pair{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}})
      out.insert(out.end(), {x + size * u, y + size * v});
  return out;
}();
const std::vector<double> rule_weights(12, 1.0 / 24);

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
             {},
             true};
    for (std::size_t i = 0; i < count; ++i) candidates.push_back(static_cast<std::int32_t>(i));
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  ~Pair() = default;

  mortar::DualWeights weights() const {
    mortar::WeightMemory memory;
    mortar::DualWeights out;
    mortar::dual_weights(input, 0, candidates, memory, out);
    return out;
  }

  /// How far from a node of the slave the mean of the master is that it meets, in the plane.
  double off(const mortar::DualWeights& w, Eigen::Index i) const {
    std::array<double, 2> way{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      way[axis] = -at(slave[static_cast<std::size_t>(i)], axis);
      for (std::size_t k = 0; k < w.masters.size(); ++k)
        way[axis] += w.weight(i, static_cast<Eigen::Index>(k)) / w.area[i] * at(w.masters[k], axis);
    }
    return std::hypot(way[0], way[1]);
  }

 private:
  double at(std::int32_t node, std::size_t axis) const {
    return x[3 * static_cast<std::size_t>(node) + axis];
  }

  std::vector<double> reference;
};

/// Weights of a facet all of which is covered, its size one.
std::vector<double> whole(Topology t) {
  switch (t) {
    case Topology::tri3:
      return {1.0 / 3, 1.0 / 3, 1.0 / 3};
    case Topology::quad4:
      return {0.25, 0.25, 0.25, 0.25};
    case Topology::tri6:
      return {2.0 / 15, 2.0 / 15, 2.0 / 15, 0.2, 0.2, 0.2};
    default:
      return {1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 9, 1.0 / 9, 1.0 / 9, 1.0 / 9, 4.0 / 9};
  }
}

/// A master over a facet of size one, up to coordinates x, y of it.
Grid master_up_to(Topology m, double x, double y, std::mt19937& random) {
  Grid master = grid(m, 2, 1.2, 0.0, random);
  for (std::size_t k = 0; k < master.x.size(); k += 3) {
    master.x[k] += x - 1.2;
    master.x[k + 1] += y - 1.2;
  }
  return master;
}

/// The nodes that keep weights of a facet which is covered in part meet what is near them: the mean of the
/// master that each is held against lies within 0.5 of a facet of it. The master is flat, so were nothing
/// handed over it would be at the node. In shares of the weights of a whole facet that is 0.43 at most; in
/// equal shares vertices of quadrilaterals of order 2, of little weight, met what is 1.2 facets off.
bool meets_what_is_near(Topology s) {
  constexpr double allowed = 0.5;
  double most = 0.0, least = 0.0;
  Eigen::Index handed = 0;
  const std::vector<double> all = whole(s);
  for (int a = 2; a < 20; ++a)
    for (int b = 2; b < 20; ++b) {
      std::mt19937 random(7);
      const Grid slave = grid(s, 1, 1.0, 0.02, random);
      Pair pair(slave, master_up_to(Topology::quad4, 0.05 * a, 0.05 * b, random), true);
      pair.input.whole = all;
      const mortar::DualWeights w = pair.weights();
      handed += (w.area.array() == 0.0).count();
      least = std::min(least, w.area.minCoeff());
      for (Eigen::Index i = 0; i < w.area.size(); ++i)
        if (w.area[i] > 0.0) most = std::max(most, pair.off(w, i));
    }
  const bool good = handed > 0 && least == 0.0 && most < allowed;
  if (!good)
    std::printf("topology %d: means up to %.2f off, weights down to %.1e\n", static_cast<int>(s),
                most, least);
  return good;
}

/// Up to which coordinate a facet is covered where a node hands over a part of its weights.
double covered_in_part(Topology s) {
  const std::vector<double> all = whole(s);
  for (double x = 0.1; x < 1.0; x += 0.01) {
    std::mt19937 random(7);
    const Grid slave = grid(s, 1, 1.0, 0.02, random);
    const Pair pair(slave, master_up_to(Topology::quad4, x, 1.2, random), true);
    const Eigen::Map<const Eigen::ArrayXd> of(all.data(), static_cast<Eigen::Index>(all.size()));
    const Eigen::ArrayXd share = pair.weights().area.array() / of;
    const Eigen::ArrayXd relative = share / share.maxCoeff();
    if (((relative - 0.2).abs() < 0.02).any()) return x;
  }
  return 0.0;
}

/// `x`: up to where the facet is covered.
bool right(Topology s, Topology m, bool current, double x) {
  std::mt19937 random(7);
  const Grid slave = grid(s, 1, 1.0, 0.02, random);
  Pair pair(slave, master_up_to(m, x, 1.2, random), current);
  const mortar::DualWeights before = pair.weights();
  const std::vector<double> all = whole(s);
  if (x < 1.0) pair.input.whole = all;
  const mortar::DualWeights w = pair.weights();
  if (w.masters.empty()) return false;
  const double off = std::max((w.weight.rowwise().sum() - w.area).cwiseAbs().maxCoeff(),
                              std::abs(w.area.sum() - before.area.sum()));
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
    const double h = k == 0 ? 1e-4 : 1e-5;
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
    good &= anisocontact::meets_what_is_near(s);
  for (const Topology s : {Topology::tri3, Topology::quad4, Topology::tri6, Topology::quad9})
    for (const Topology m : {Topology::tri3, Topology::quad4, Topology::tri6, Topology::quad9})
      for (const bool current : {true, false})
        for (const double x : {1.2, 0.08, anisocontact::covered_in_part(s)})
          good &= anisocontact::right(s, m, current, x);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
