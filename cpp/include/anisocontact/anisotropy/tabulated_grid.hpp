#pragma once
// Directions tabulated on a regular grid of the surface coordinates.

#include <memory>

#include "anisocontact/anisotropy/grid_table.hpp"

namespace anisocontact::anisotropy {

/// Direction of the interpolated tensor v (x) v, projected on the tangent plane.
class TabulatedGrid {
 public:
  explicit TabulatedGrid(std::shared_ptr<const GridTable> table) : table_(std::move(table)) {}

  static Descriptor describe() {
    return {
        "tabulated-grid",
        "Directions at the nodes of a grid of the surface coordinates, interpolated as lines: v "
        "and "
        "-v are the same.",
        {{"lower", Kind::pair, "1", "coordinates of the first node"},
         {"upper", Kind::pair, "1",
          "coordinates of the last node; on a periodic coordinate of the first node one period on"},
         {"counts", Kind::integers, "1", "number of nodes along each coordinate", Bound::positive},
         {"vectors", Kind::array, "1",
          "direction of the first axis at each node, the second coordinate running fastest"},
         {"second_vectors",
          Kind::array,
          "1",
          "direction of the second axis at each node; orthogonal to the first if left out",
          Bound::any,
          false,
          {}},
         {"periodic",
          Kind::choice,
          "1",
          "which coordinates are periodic",
          Bound::any,
          false,
          {0.0},
          {"none", "first", "second", "both"}},
         {"interpolation",
          Kind::choice,
          "1",
          "bicubic is of fourth order with continuous slopes, bilinear of second order",
          Bound::any,
          false,
          {0.0},
          {"bicubic", "bilinear"}}}};
  }

  static TabulatedGrid make(const Values& v) {
    const auto &lower = v.pair("lower"), &upper = v.pair("upper"), &counts = v.list("counts");
    if (counts.size() != 2)
      throw std::invalid_argument("counts: " + std::to_string(counts.size()) +
                                  " given, two whole numbers needed");
    const auto periodic = static_cast<std::size_t>(v.scalar("periodic"));  // a bit a coordinate
    const bool cubic = v.scalar("interpolation") == 0.0;
    std::array<GridLine, 2> lines;
    for (std::size_t i = 0; i < 2; ++i)
      lines[i] = line_from(lower[i], upper[i], counts[i], ((periodic >> i) & 1U) != 0, cubic);
    auto tables = tables_from(v, lines[0].count * lines[1].count);
    return TabulatedGrid(std::make_shared<GridTable>(lines, std::move(tables), cubic));
  }

  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>& xi) const {
    const std::array<Cell<S>, 2> cell{locate(table_->line(0), xi[0]),
                                      locate(table_->line(1), xi[1])};
    if (!cell[0].inside || !cell[1].inside) return no_axes(g);
    std::array<std::optional<Vec3<S>>, 2> e;
    for (std::size_t a = 0; a < table_->tables(); ++a)
      e[a] = along_line(g, table_->interpolate(cell, a), table_->nearest(cell, a));
    return tabulated_axes(g, e, table_->tables());
  }

 private:
  static GridLine line_from(double lower, double upper, double count, bool periodic, bool cubic) {
    const std::size_t least = cubic ? 5 : 2;
    const auto n = static_cast<std::size_t>(count);
    if (n < least)
      throw std::invalid_argument("counts: " + std::to_string(n) + " given, at least " +
                                  std::to_string(least) + " needed for " +
                                  (cubic ? "bicubic" : "bilinear") + " interpolation");
    if (!(upper > lower)) throw std::invalid_argument("upper: must be greater than lower");
    return {lower, (upper - lower) / static_cast<double>(periodic ? n : n - 1), n, periodic};
  }

  std::shared_ptr<const GridTable> table_;
};

static_assert(Field<TabulatedGrid>);

}  // namespace anisocontact::anisotropy
