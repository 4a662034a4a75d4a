#pragma once
// Tree of axis-aligned boxes in flat arrays: built once, refitted as the boxes move.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::search {

struct Box {
  std::array<double, 3> lower, upper;

  static Box empty() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {{inf, inf, inf}, {-inf, -inf, -inf}};
  }
  void add(const Vec3<double>& x) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], x[static_cast<Eigen::Index>(i)]);
      upper[i] = std::max(upper[i], x[static_cast<Eigen::Index>(i)]);
    }
  }
  void add(const Box& b) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], b.lower[i]);
      upper[i] = std::max(upper[i], b.upper[i]);
    }
  }
  double centre(std::size_t i) const { return 0.5 * (lower[i] + upper[i]); }

  /// Distance of x to the nearest face from inside; negative outside.
  double depth(const Vec3<double>& x) const {
    double d = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      const double c = x[static_cast<Eigen::Index>(i)];
      d = std::min(d, std::min(c - lower[i], upper[i] - c));
    }
    return d;
  }

  /// Squared distance of x to the box, zero inside it.
  double distance2(const Vec3<double>& x) const {
    double d2 = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double c = x[static_cast<Eigen::Index>(i)];
      const double d = std::max(0.0, std::max(lower[i] - c, c - upper[i]));
      d2 += d * d;
    }
    return d2;
  }
};

/// A leaf holds one item; children lie after their parent, so that a pass from the back refits, and
/// in pairs, the first of which has an odd number.
class Tree {
 public:
  explicit Tree(std::span<const Box> items) {
    if (items.empty()) return;
    std::vector<std::int32_t> order(items.size());
    std::iota(order.begin(), order.end(), 0);
    nodes_.reserve(2 * items.size() - 1);
    parent_.reserve(2 * items.size() - 1);
    leaf_.resize(items.size());
    nodes_.push_back({});
    parent_.push_back(0);
    struct Range {
      std::size_t node, first, last;
    };
    std::vector<Range> waiting{{0, 0, items.size()}};
    while (!waiting.empty()) {
      const auto [node, first, last] = waiting.back();
      waiting.pop_back();
      if (last - first == 1) {
        nodes_[node].item = order[first];
        leaf_[static_cast<std::size_t>(order[first])] = static_cast<std::int32_t>(node);
        continue;
      }
      const std::size_t middle =
          split(items, std::span(order).subspan(first, last - first)) + first;
      const std::size_t child = nodes_.size();
      nodes_[node].child = static_cast<std::int32_t>(child);
      nodes_.resize(child + 2);
      parent_.resize(child + 2, static_cast<std::int32_t>(node));
      waiting.push_back({child, first, middle});
      waiting.push_back({child + 1, middle, last});
    }
    refit(items);
  }

  void refit(std::span<const Box> items) {
    for (std::size_t k = nodes_.size(); k-- > 0;) {
      Node& n = nodes_[k];
      if (n.item >= 0) {
        n.box = items[static_cast<std::size_t>(n.item)];
      } else {
        const auto c = static_cast<std::size_t>(n.child);
        n.box = nodes_[c].box;
        n.box.add(nodes_[c + 1].box);
      }
    }
    free_.resize(nodes_.size());
    constexpr double inf = std::numeric_limits<double>::infinity();
    if (!free_.empty()) free_[0] = {{-inf, -inf, -inf}, {inf, inf, inf}};
    for (std::size_t k = 1; k < nodes_.size(); ++k)
      free_[k] = beside(free_[static_cast<std::size_t>(parent_[k])], nodes_[k].box,
                        nodes_[sibling(k)].box);
  }

  /// Calls visit(item, squared distance to its box) for the items whose boxes are nearer than
  /// `bound2`, the near half of the tree first; `visit` may lower `bound2` on the way.
  template <class Visit>
  void descend(const Vec3<double>& x, const double& bound2, const Visit& visit) const {
    if (!nodes_.empty()) descend(0, x, bound2, visit);
  }

  /// The same from an item on which x is expected: up until x is deep enough in what is free of all
  /// other boxes, down where a box on the way is nearer than `bound2`. The item itself is left out.
  template <class Visit>
  void descend_beside(std::size_t item, const Vec3<double>& x, const double& bound2,
                      const Visit& visit) const {
    for (auto k = static_cast<std::size_t>(leaf_[item]); k != 0;
         k = static_cast<std::size_t>(parent_[k])) {
      const double depth = free_[k].depth(x);
      if (depth >= 0.0 && depth * depth >= bound2) return;
      descend(sibling(k), x, bound2, visit);
    }
  }

  /// Sum of the areas of all boxes over that of the root: what a descent has to expect.
  double cost() const {
    if (nodes_.empty()) return 0.0;
    double sum = 0.0;
    for (const Node& n : nodes_) sum += area(n.box);
    const double root = area(nodes_[0].box);
    return root > 0.0 ? sum / root : 0.0;
  }

 private:
  /// No part has less than a third of the items: a tree of 2^32 items is at most 55 deep.
  static constexpr std::size_t depth_limit = 64;

  struct Node {
    Box box{Box::empty()};
    std::int32_t child{-1};
    std::int32_t item{-1};
  };

  static std::size_t sibling(std::size_t k) { return k % 2 == 1 ? k + 1 : k - 1; }

  /// The part of `region` on that side of the box `other` that leaves most of `box`, of several the
  /// one across which it is widest.
  static Box beside(Box region, const Box& box, const Box& other) {
    std::size_t axis = 0;
    bool below = true;
    std::array<double, 2> most{-std::numeric_limits<double>::infinity(), 0.0};
    const auto consider = [&](std::size_t i, bool under, double length, double width) {
      const std::array<double, 2> left{std::min(length, width) / width, width};
      if (!(left > most)) return;
      most = left;
      axis = i;
      below = under;
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const double width = box.upper[i] - box.lower[i];
      consider(i, true, other.lower[i] - box.lower[i], width);
      consider(i, false, box.upper[i] - other.upper[i], width);
    }
    if (below)
      region.upper[axis] = std::min(region.upper[axis], other.lower[axis]);
    else
      region.lower[axis] = std::max(region.lower[axis], other.upper[axis]);
    return region;
  }

  /// Below a node.
  template <class Visit>
  void descend(std::size_t node, const Vec3<double>& x, const double& bound2,
               const Visit& visit) const {
    struct Entry {
      std::size_t node;
      double d2;
    };
    const double start = nodes_[node].box.distance2(x);
    if (!(start < bound2)) return;
    std::array<Entry, depth_limit> waiting;
    std::size_t count = 0;
    waiting[count++] = {node, start};
    while (count > 0) {
      auto [k, d2] = waiting[--count];
      while (d2 < bound2) {
        const Node& n = nodes_[k];
        if (n.item >= 0) {
          visit(n.item, d2);
          break;
        }
        const auto c = static_cast<std::size_t>(n.child);
        Entry near{c, nodes_[c].box.distance2(x)}, far{c + 1, nodes_[c + 1].box.distance2(x)};
        if (far.d2 < near.d2) std::swap(near, far);
        waiting[count++] = far;
        k = near.node;
        d2 = near.d2;
      }
    }
  }

  static double area(const Box& b) {
    const double x = b.upper[0] - b.lower[0], y = b.upper[1] - b.lower[1],
                 z = b.upper[2] - b.lower[2];
    return x * y + y * z + z * x;
  }

  /// Orders the items about the median along the axis on which their centres spread most. Rows of a
  /// regular mesh are not torn where that leaves both parts large enough: their boxes would overlap.
  static std::size_t split(std::span<const Box> items, std::span<std::int32_t> order) {
    Box centres = Box::empty();
    for (const std::int32_t i : order) {
      const Box& b = items[static_cast<std::size_t>(i)];
      centres.add(Vec3<double>(b.centre(0), b.centre(1), b.centre(2)));
    }
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (centres.upper[i] - centres.lower[i] > centres.upper[axis] - centres.lower[axis]) axis = i;
    const auto at = [&](std::int32_t i) { return items[static_cast<std::size_t>(i)].centre(axis); };
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::nth_element(order.begin(), middle, order.end(), [&](std::int32_t a, std::int32_t b) {
      const double p = at(a), q = at(b);
      return p < q || (p == q && a < b);
    });
    constexpr double same = 1e-6;  // of the spread: centres of a row, to rounding
    const double row = same * (centres.upper[axis] - centres.lower[axis]), here = at(*middle);
    const auto before =
        std::partition(order.begin(), middle, [&](std::int32_t i) { return at(i) < here - row; });
    const auto after =
        std::partition(middle, order.end(), [&](std::int32_t i) { return at(i) <= here + row; });
    const auto nearest = middle - before <= after - middle ? before : after;
    const bool large =
        3 * std::min(nearest - order.begin(), order.end() - nearest) >= std::ssize(order);
    return static_cast<std::size_t>((large ? nearest : middle) - order.begin());
  }

  std::vector<Node> nodes_;
  std::vector<std::int32_t> parent_;  ///< of each node
  std::vector<std::int32_t> leaf_;    ///< node of each item
  std::vector<Box> free_;             ///< of each node, where no box of an item outside it is
};

}  // namespace anisocontact::search
