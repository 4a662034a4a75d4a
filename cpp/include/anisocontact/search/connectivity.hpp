#pragma once
// Facets of a mesh and who shares a side or a vertex with whom.

#include <algorithm>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "anisocontact/surface/facet.hpp"

namespace anisocontact::search {

using surface::FacetKind;

/// Facets share a vertex where they name the same point, and a side where they name the same two
/// points: the mesh has to conform. Sides and vertices that end the surface are its border.
class Connectivity {
 public:
  /// `nodes`: the points of each facet, one facet after the other.
  Connectivity(std::size_t points, std::vector<FacetKind> kinds, std::vector<std::int32_t> nodes)
      : kinds_(std::move(kinds)), nodes_(std::move(nodes)), first_(kinds_.size() + 1, 0) {
    for (std::size_t f = 0; f < kinds_.size(); ++f) first_[f + 1] = first_[f] + kinds_[f].nodes();
    if (first_.back() != nodes_.size())
      throw std::invalid_argument("number of nodes does not belong to the facets");
    check(points);
    gather_around(points);
    mark_borders(points);
  }

  std::size_t facets() const { return kinds_.size(); }
  const FacetKind& kind(std::size_t f) const { return kinds_[f]; }
  std::span<const std::int32_t> nodes(std::size_t f) const {
    return {nodes_.data() + first_[f], kinds_[f].nodes()};
  }
  std::int32_t vertex(std::size_t f, std::size_t k) const { return nodes_[first_[f] + k]; }

  /// Facets that have the point as a vertex.
  std::span<const std::int32_t> around(std::int32_t point) const {
    const auto p = static_cast<std::size_t>(point);
    return {around_.data() + around_first_[p], around_first_[p + 1] - around_first_[p]};
  }

  /// The side of facet f between two points; -1 if it has none.
  int side_between(std::size_t f, std::int32_t a, std::int32_t b) const {
    for (std::size_t k = 0; k < kinds_[f].sides(); ++k) {
      const auto [p, q] = side(f, k);
      if ((p == a && q == b) || (p == b && q == a)) return static_cast<int>(k);
    }
    return -1;
  }

  /// The points at the ends of a side.
  std::array<std::int32_t, 2> side(std::size_t f, std::size_t k) const {
    const auto [a, b] = surface::side_vertices(kinds_[f].topology, k);
    return {vertex(f, a), vertex(f, b)};
  }

  bool border_side(std::size_t f, std::size_t k) const { return border_sides_[f] >> k & 1U; }
  bool border_vertex(std::int32_t point) const {
    return border_vertices_[static_cast<std::size_t>(point)];
  }

  /// Calls visit(g, side of g) for the other facets at a side of f.
  template <class Visit>
  void across(std::size_t f, std::size_t k, const Visit& visit) const {
    const auto [a, b] = side(f, k);
    for (const std::int32_t g : around(a)) {
      if (static_cast<std::size_t>(g) == f) continue;
      if (const int s = side_between(static_cast<std::size_t>(g), a, b); s >= 0)
        visit(g, static_cast<std::size_t>(s));
    }
  }

  /// Facets within `count` rings of facets around f, f with them, in ascending order.
  std::vector<std::int32_t> rings(std::int32_t f, std::size_t count) const {
    std::vector<std::int32_t> found{f};
    std::size_t from = 0;
    for (std::size_t ring = 0; ring < count; ++ring) {
      const std::size_t to = found.size();
      for (; from < to; ++from) {
        const auto g = static_cast<std::size_t>(found[from]);
        for (std::size_t k = 0; k < kinds_[g].sides(); ++k)
          for (const std::int32_t h : around(vertex(g, k)))
            if (std::find(found.begin(), found.end(), h) == found.end()) found.push_back(h);
      }
    }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  void check(std::size_t points) const {
    for (std::size_t f = 0; f < facets(); ++f) {
      const auto n = nodes(f);
      for (std::size_t i = 0; i < n.size(); ++i) {
        if (n[i] < 0 || static_cast<std::size_t>(n[i]) >= points)
          throw std::invalid_argument("facet " + std::to_string(f) + ": node " +
                                      std::to_string(n[i]) + " given, 0 to " +
                                      std::to_string(points) + " (excluded) allowed");
        if (std::find(n.begin(), n.begin() + static_cast<std::ptrdiff_t>(i), n[i]) !=
            n.begin() + static_cast<std::ptrdiff_t>(i))
          throw std::invalid_argument("facet " + std::to_string(f) + ": node " +
                                      std::to_string(n[i]) + " given twice");
      }
    }
  }

  void gather_around(std::size_t points) {
    around_first_.assign(points + 1, 0);
    for (std::size_t f = 0; f < facets(); ++f)
      for (std::size_t k = 0; k < kinds_[f].sides(); ++k)
        ++around_first_[static_cast<std::size_t>(vertex(f, k)) + 1];
    for (std::size_t p = 0; p < points; ++p) around_first_[p + 1] += around_first_[p];
    around_.resize(around_first_.back());
    auto next = around_first_;
    for (std::size_t f = 0; f < facets(); ++f)
      for (std::size_t k = 0; k < kinds_[f].sides(); ++k)
        around_[next[static_cast<std::size_t>(vertex(f, k))]++] = static_cast<std::int32_t>(f);
  }

  void mark_borders(std::size_t points) {
    border_sides_.assign(facets(), 0);
    border_vertices_.assign(points, false);
    for (std::size_t f = 0; f < facets(); ++f)
      for (std::size_t k = 0; k < kinds_[f].sides(); ++k) {
        bool alone = true;
        across(f, k, [&](std::int32_t, std::size_t) { alone = false; });
        if (!alone) continue;
        border_sides_[f] = static_cast<std::uint8_t>(border_sides_[f] | 1U << k);
        for (const std::int32_t p : side(f, k))
          border_vertices_[static_cast<std::size_t>(p)] = true;
      }
  }

  std::vector<FacetKind> kinds_;
  std::vector<std::int32_t> nodes_;
  std::vector<std::size_t> first_, around_first_;
  std::vector<std::int32_t> around_;
  std::vector<std::uint8_t> border_sides_;
  std::vector<bool> border_vertices_;
};

}  // namespace anisocontact::search
