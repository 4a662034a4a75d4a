#pragma once
// Directions tabulated at scattered points in space.

#include <limits>
#include <memory>

#include "anisocontact/anisotropy/plane_fit.hpp"
#include "anisocontact/anisotropy/point_tree.hpp"

namespace anisocontact::anisotropy {

/// Points and the unit directions at them.
struct PointTable {
  PointTree tree;
  std::vector<std::vector<Vec3<double>>> directions;
  double radius{0.0};  ///< of smoothing; 0 takes the nearest point alone
};

/// Nearest point, or a moving least-squares fit of the tensors v (x) v around the point: second
/// order in the spacing, with continuous second derivatives.
class TabulatedPoints {
 public:
  explicit TabulatedPoints(std::shared_ptr<const PointTable> table) : table_(std::move(table)) {}

  static Descriptor describe() {
    return {"tabulated-points",
            "Directions at scattered points, interpolated as lines: v and -v are the same.",
            {{"points", Kind::array, "length", "positions, three numbers each"},
             {"vectors", Kind::array, "1", "direction of the first axis at each point"},
             {"second_vectors",
              Kind::array,
              "1",
              "direction of the second axis at each point; orthogonal to the first if left out",
              Bound::any,
              false,
              {}},
             {"interpolation",
              Kind::choice,
              "1",
              "smooth fits the points within the radius, nearest takes the nearest one",
              Bound::any,
              false,
              {0.0},
              {"smooth", "nearest"}},
             {"radius",
              Kind::scalar,
              "length",
              "radius of smoothing; 0 takes it from the spacing of the points",
              Bound::non_negative,
              false,
              {0.0}}}};
  }

  static TabulatedPoints make(const Values& v) {
    auto table = std::make_shared<PointTable>();
    table->tree = PointTree(vectors_from(v.list("points"), "points"));
    const bool smooth = v.scalar("interpolation") == 0.0;
    const std::size_t least = smooth ? 3 : 1, n = table->tree.size();
    if (n < least)
      throw std::invalid_argument("points: " + std::to_string(n) + " given, at least " +
                                  std::to_string(least) + " needed");
    table->directions = tables_from(v, n);
    if (smooth)
      table->radius = v.scalar("radius") > 0.0 ? v.scalar("radius") : usual_radius(table->tree);
    return TabulatedPoints(std::move(table));
  }

  template <class S>
  Axes<S> axes(const surface::Geometry<S>& g, const Vector<S>&) const {
    return table_->radius > 0.0 ? smooth(g) : nearest(g);
  }

 private:
  template <class S>
  Axes<S> nearest(const surface::Geometry<S>& g) const {
    const std::size_t i = table_->tree.nearest(value(g.jet.position));
    std::array<std::optional<Vec3<S>>, 2> e;
    for (std::size_t a = 0; a < table_->directions.size(); ++a)
      e[a] = unit_tangent<S>(g, constant<S>(table_->directions[a][i]));
    return tabulated_axes(g, e, table_->directions.size());
  }

  template <class S>
  Axes<S> smooth(const surface::Geometry<S>& g) const {
    using std::sqrt;
    const auto& directions = table_->directions;
    const S scale(1.0 / table_->radius);
    const Vec3<S> t1 = (scale / sqrt(g.a_co(0, 0))) * g.jet.d1[0];
    const Vec3<S> t2 = g.normal.cross(t1);
    PlaneFit<S> fit;
    std::size_t closest = 0;
    double least = std::numeric_limits<double>::infinity();
    table_->tree.within(value(g.jet.position), table_->radius * table_->radius, [&](std::size_t i) {
      const Vec3<S> r = constant<S>(table_->tree.point(i)) - g.jet.position;
      const S r2 = scale * scale * r.dot(r);
      fit.add(weight(r2), r.dot(t1), r.dot(t2));
      for (std::size_t a = 0; a < directions.size(); ++a) fit.add(a, line_of(directions[a][i]));
      if (value(r2) < least) {
        least = value(r2);
        closest = i;
      }
    });
    if (!fit.solve()) return no_axes(g);
    std::array<std::optional<Vec3<S>>, 2> e;
    for (std::size_t a = 0; a < directions.size(); ++a)
      e[a] = along_line(g, fit.fitted(a), directions[a][closest]);
    return tabulated_axes(g, e, directions.size());
  }

  /// Function (1 - r)^4 (4 r + 1) of Wendland, of r^2 so that its derivative at r = 0 is finite.
  template <class S>
  static S weight(const S& r2) {
    const double v = value(r2), r = std::sqrt(v), q = std::max(1.0 - r, 0.0), q3 = q * q * q;
    return S(q3 * q * (4.0 * r + 1.0)) + S(-10.0 * q3) * (r2 - S(v));
  }

  /// Twice the largest distance of a point to the second of two neighbours that are not in a line
  /// with it, so that a plane can be fitted everywhere: across scan lines too, on which the points
  /// are denser than the lines are.
  static double usual_radius(const PointTree& tree) {
    constexpr double sine2 = 0.25;  // of 30 degrees, above which three points make a triangle
    double most = 0.0;
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const Vec3<double>& x = tree.point(i);
      const auto first =
          tree.nearest_of(x, [&](std::size_t j) { return (tree.point(j) - x).norm() > 0.0; });
      const Vec3<double> d = tree.point(first.index) - x;
      const auto second = tree.nearest_of(x, [&](std::size_t j) {
        const Vec3<double> r = tree.point(j) - x;
        return r.cross(d).squaredNorm() > sine2 * r.squaredNorm() * d.squaredNorm();
      });
      most = std::max(most, second.distance2);
    }
    if (!std::isfinite(most)) throw std::invalid_argument("points: all in one line");
    return 2.0 * std::sqrt(most);
  }

  std::shared_ptr<const PointTable> table_;
};

static_assert(Field<TabulatedPoints>);

}  // namespace anisocontact::anisotropy
