// Surfaces of facets: closest points, neighbours, geometry.

#include "anisocontact/projection/along_normal.hpp"
#include "anisocontact/search/facing.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/search/smoothing.hpp"
#include "bindings.hpp"
#include "geometries.hpp"

namespace anisocontact::bindings {

namespace {

using search::FacetProjection;
using search::FacetSurface;
using surface::FacetKind;

using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Offsets = nb::ndarray<const std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const std::int32_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using Lists = std::vector<std::vector<std::int32_t>>;

std::vector<Vec3<double>> rows(const Points& x) {
  std::vector<Vec3<double>> r(x.shape(0));
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = row3(x.data(), i);
  return r;
}

std::vector<FacetKind> kinds(const std::vector<std::string>& topologies, const Indices& counts,
                             const Flags& flip) {
  std::vector<FacetKind> k;
  k.reserve(flip.shape(0));
  for (std::size_t block = 0; block < topologies.size(); ++block) {
    const auto t = surface::topology_of(topologies[block]);
    if (!t) throw std::invalid_argument("no topology " + topologies[block]);
    for (std::int32_t i = 0; i < counts.data()[block]; ++i)
      k.push_back({*t, flip.data()[k.size()]});
  }
  return k;
}

void check_facets(const FacetSurface& s, const Indices& facet) {
  for (std::size_t i = 0; i < facet.shape(0); ++i)
    if (facet.data()[i] < 0 || static_cast<std::size_t>(facet.data()[i]) >= s.facets())
      throw std::invalid_argument("facet " + std::to_string(facet.data()[i]) + " given, 0 to " +
                                  std::to_string(s.facets()) + " (excluded) allowed");
}

/// Inputs of a batch of projections; empty arrays stand for what is not given.
struct QueryInput {
  Points x;
  Indices hint, named;
  Coordinates start;
  Scalars limit;
  Offsets offsets;
  Indices excluded;

  search::Query query(std::size_t i) const {
    search::Query q;
    if (hint.shape(0) > 0) q.hint = hint.data()[i];
    q.named = named.shape(0) > 0 ? named.data()[i] : q.hint;
    if (start.shape(0) > 0 && std::isfinite(start.data()[2 * i]))
      q.start = {start.data()[2 * i], start.data()[2 * i + 1]};
    q.limit = limit.data()[limit.shape(0) == 1 ? 0 : i];
    if (offsets.shape(0) > 0)
      q.excluded = {excluded.data() + offsets.data()[i], excluded.data() + offsets.data()[i + 1]};
    return q;
  }
};

nb::dict project(const FacetSurface& s, const Points& x, const Indices& hint, const Indices& named,
                 const Coordinates& start, const Scalars& limit, const Offsets& offsets,
                 const Indices& excluded, std::size_t threads) {
  const std::size_t n = x.shape(0);
  const QueryInput in{x, hint, named, start, limit, offsets, excluded};
  Array<std::int32_t> facet({n}, unset);
  Array<std::int8_t> status({n}, unset), feature({n}, unset), entity({n}, unset);
  Array<double> xi({n, 2}, unset), edge({n, 2}, unset), position({n, 3}, unset),
      normal({n, 3}, unset), gap({n}, unset);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const FacetProjection p = s.closest(row3(x.data(), i), in.query(i));
      facet.data[i] = p.facet;
      status.data[i] = static_cast<std::int8_t>(p.status);
      feature.data[i] = static_cast<std::int8_t>(p.feature);
      entity.data[i] = p.entity;
      for (std::size_t k = 0; k < 2; ++k) {
        xi.data[2 * i + k] = p.xi[k];
        edge.data[2 * i + k] = p.edge[k];
      }
      put3(position.data, i, p.position);
      put3(normal.data, i, p.normal);
      gap.data[i] = p.gap;
    });
  }
  nb::dict r;
  r["facet"] = facet.array;
  r["xi"] = xi.array;
  r["position"] = position.array;
  r["gap"] = gap.array;
  r["normal"] = normal.array;
  r["status"] = status.array;
  r["feature"] = feature.array;
  r["entity"] = entity.array;
  r["edge"] = edge.array;
  return r;
}

/// Where lines through points along unit vectors meet facets, and which do.
nb::tuple met_along(const FacetSurface& s, const Indices& facet, const Coordinates& xi,
                    const Points& x, const Points& normal, double opposed, std::size_t threads) {
  check_facets(s, facet);
  const std::size_t n = facet.shape(0);
  Array<double> at({n, 2}, unset);
  Array<bool> met({n}, unset);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const std::int32_t f = facet.data()[i];
      const projection::Meeting m = projection::along_normal(
          [&](const std::array<double, 2>& at_xi) { return s.jet(f, at_xi); },
          {xi.data()[2 * i], xi.data()[2 * i + 1]}, row3(x.data(), i), row3(normal.data(), i),
          opposed);
      std::copy(m.xi.begin(), m.xi.end(), at.data + 2 * i);
      met.data[i] = m.met;
    });
  }
  return nb::make_tuple(at.array, met.array);
}

nb::dict shapes(const FacetSurface& s, const Indices& facet, const Coordinates& xi) {
  check_facets(s, facet);
  const std::size_t n = facet.shape(0), m = surface::max_facet_nodes;
  Array<double> value({n, m}), first({n, m, 2}), second({n, m, 3});
  for (std::size_t i = 0; i < n; ++i) {
    surface::Shape<double> f;
    surface::shape(s.kind(facet.data()[i]), xi.data()[2 * i], xi.data()[2 * i + 1], f);
    for (std::size_t a = 0; a < m; ++a) {
      value.data[m * i + a] = f.N[a];
      for (std::size_t k = 0; k < 2; ++k) first.data[2 * (m * i + a) + k] = f.dN[a][k];
      for (std::size_t k = 0; k < 3; ++k) second.data[3 * (m * i + a) + k] = f.d2N[a][k];
    }
  }
  nb::dict r;
  r["value"] = value.array;
  r["d1"] = first.array;
  r["d2"] = second.array;
  return r;
}

/// Lists as offsets and one array.
nb::tuple flat(const Lists& lists) {
  Array<std::int64_t> offsets({lists.size() + 1});
  offsets.data[0] = 0;
  for (std::size_t i = 0; i < lists.size(); ++i)
    offsets.data[i + 1] = offsets.data[i] + static_cast<std::int64_t>(lists[i].size());
  Array<std::int32_t> items({static_cast<std::size_t>(offsets.data[lists.size()])});
  for (std::size_t i = 0; i < lists.size(); ++i)
    std::copy(lists[i].begin(), lists[i].end(), items.data + offsets.data[i]);
  return nb::make_tuple(offsets.array, items.array);
}

nb::tuple within(const FacetSurface& s, const Points& x, double distance, std::size_t threads) {
  Lists lists(x.shape(0));
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(lists.size(), threads,
                         [&](std::size_t i) { lists[i] = s.within(row3(x.data(), i), distance); });
  }
  return flat(lists);
}

/// Middles of facets and the distance of the farthest node.
nb::tuple balls(const Table& nodes, const Points& x) {
  const std::size_t n = nodes.shape(0), width = nodes.shape(1);
  Array<double> middle({n, 3}, unset), radius({n});
  for (std::size_t f = 0; f < n; ++f) {
    const auto at = [&](std::size_t a) {
      return row3(x.data(), static_cast<std::size_t>(nodes.data()[f * width + a]));
    };
    Vec3<double> sum = Vec3<double>::Zero();
    for (std::size_t a = 0; a < width; ++a) sum += at(a);
    sum /= static_cast<double>(width);
    put3(middle.data, f, sum);
    for (std::size_t a = 0; a < width; ++a)
      radius.data[f] = std::max(radius.data[f], (at(a) - sum).norm());
  }
  return nb::make_tuple(middle.array, radius.array);
}

/// Outward unit normals where shape functions have a gradient, (nodes, 2).
nb::ndarray<nb::numpy, double> normals(const Table& nodes, const Flags& flip,
                                       const Coordinates& gradient, const Points& x) {
  const std::size_t n = nodes.shape(0), width = nodes.shape(1);
  Array<double> out({n, 3}, unset);
  for (std::size_t f = 0; f < n; ++f) {
    Vec3<double> first = Vec3<double>::Zero(), second = first;
    for (std::size_t a = 0; a < width; ++a) {
      const auto at = row3(x.data(), static_cast<std::size_t>(nodes.data()[f * width + a]));
      first += gradient.data()[2 * a] * at;
      second += gradient.data()[2 * a + 1] * at;
    }
    const Vec3<double> cross = first.cross(second);
    put3(out.data, f, (flip.data()[f] ? -1.0 : 1.0) / cross.norm() * cross);
  }
  return out.array;
}

/// Pairs of facets that face each other, in ascending order, and the distances of their middles.
nb::tuple facing(const FacetSurface& s, const Points& middle, const Scalars& radius,
                 const Points& normal, const Points& centre, const Scalars& size,
                 const Points& other, double distance, double farther, const Offsets& offsets,
                 const Indices& unmet, std::size_t threads) {
  const std::size_t n = middle.shape(0);
  const search::FacetBalls own{middle.data(), radius.data(), normal.data()},
      theirs{centre.data(), size.data(), other.data()};
  Lists lists(n);
  {
    nb::gil_scoped_release free;
    kernel::parallel_pieces(n, threads, [&](std::size_t first, std::size_t last) {
      std::vector<std::int32_t> found;
      for (std::size_t f = first; f < last; ++f) {
        std::span<const std::int32_t> left_out;
        if (offsets.shape(0) > 0)
          left_out = {unmet.data() + offsets.data()[f], unmet.data() + offsets.data()[f + 1]};
        search::faced(s, own, f, theirs, {distance, farther}, left_out, found);
        lists[f] = found;
      }
    });
  }
  std::size_t count = 0;
  for (const auto& one : lists) count += one.size();
  Array<std::int64_t> slave({count}, unset), master({count}, unset);
  Array<double> apart({count}, unset);
  std::size_t k = 0;
  for (std::size_t f = 0; f < n; ++f)
    for (const std::int32_t g : lists[f]) {
      slave.data[k] = static_cast<std::int64_t>(f);
      master.data[k] = g;
      apart.data[k++] =
          (row3(centre.data(), static_cast<std::size_t>(g)) - row3(middle.data(), f)).norm();
    }
  return nb::make_tuple(slave.array, master.array, apart.array);
}

nb::tuple rings(const FacetSurface& s, const Indices& facet, std::size_t count) {
  check_facets(s, facet);
  Lists lists(facet.shape(0));
  for (std::size_t i = 0; i < lists.size(); ++i) lists[i] = s.mesh().rings(facet.data()[i], count);
  return flat(lists);
}

/// Facet, first and second point of every side, counter-clockwise about the normal.
nb::ndarray<nb::numpy, std::int32_t> sides(const FacetSurface& s) {
  std::vector<std::int32_t> r;
  for (std::size_t f = 0; f < s.facets(); ++f) {
    const auto& kind = s.mesh().kind(f);
    for (std::size_t k = 0; k < kind.sides(); ++k) {
      auto ends = s.mesh().side(f, k);
      if (kind.flip != surface::side_runs_back(k)) std::swap(ends[0], ends[1]);
      r.insert(r.end(), {static_cast<std::int32_t>(f), ends[0], ends[1]});
    }
  }
  Array<std::int32_t> out({r.size() / 3, 3});
  std::copy(r.begin(), r.end(), out.data);
  return out.array;
}

nb::ndarray<nb::numpy, double> middles(const search::Smoothing& s, const Points& x) {
  const auto m = s.middles(rows(x));
  Array<double> out({m.size(), 3});
  for (std::size_t i = 0; i < m.size(); ++i) put3(out.data, i, m[i]);
  return out.array;
}

/// Row pointers, columns and blocks of a block-sparse matrix (middles x points).
nb::tuple middle_derivatives(const search::Smoothing& s, const Points& x) {
  const auto d = s.derivatives(rows(x));
  Array<std::int64_t> first({d.first.size()});
  Array<std::int32_t> points({d.points.size()});
  Array<double> blocks({d.blocks.size(), 3, 3});
  std::copy(d.first.begin(), d.first.end(), first.data);
  std::copy(d.points.begin(), d.points.end(), points.data);
  for (std::size_t i = 0; i < d.blocks.size(); ++i)
    for (Eigen::Index k = 0; k < 9; ++k)
      blocks.data[9 * i + static_cast<std::size_t>(k)] = d.blocks[i](k / 3, k % 3);
  return nb::make_tuple(first.array, points.array, blocks.array);
}

auto jet_at(const FacetSurface& s, const Indices& facet, const Coordinates& xi) {
  return [&](std::size_t i) {
    return s.jet(facet.data()[i], {xi.data()[2 * i], xi.data()[2 * i + 1]});
  };
}

}  // namespace

void bind_search(nb::module_& m) {
  nb::class_<FacetSurface>(m, "FacetSurface")
      .def(
          "__init__",
          [](FacetSurface* self, const Points& x, const std::vector<std::string>& topologies,
             const Indices& counts, const Indices& nodes, const Flags& flip) {
            new (self) FacetSurface(rows(x), kinds(topologies, counts, flip),
                                    {nodes.data(), nodes.data() + nodes.shape(0)});
          },
          nb::arg("points"), nb::arg("topologies"), nb::arg("counts"), nb::arg("nodes"),
          nb::arg("flip"))
      .def(
          "update", [](FacetSurface& s, const Points& x) { s.update(rows(x)); }, nb::arg("points"))
      .def("project", &project, nb::arg("x"), nb::arg("hint"), nb::arg("named"), nb::arg("start"),
           nb::arg("limit"), nb::arg("offsets"), nb::arg("excluded"), nb::arg("threads"))
      .def("met_along", &met_along, nb::arg("facet"), nb::arg("xi"), nb::arg("x"),
           nb::arg("normal"), nb::arg("opposed"), nb::arg("threads"))
      .def("shapes", &shapes, nb::arg("facet"), nb::arg("xi"))
      .def(
          "jet",
          [](const FacetSurface& s, const Indices& facet, const Coordinates& xi) {
            check_facets(s, facet);
            return jets(facet.shape(0), jet_at(s, facet, xi));
          },
          nb::arg("facet"), nb::arg("xi"))
      .def(
          "geometry",
          [](const FacetSurface& s, const Indices& facet, const Coordinates& xi) {
            check_facets(s, facet);
            return geometries(facet.shape(0), jet_at(s, facet, xi));
          },
          nb::arg("facet"), nb::arg("xi"))
      .def("within", &within, nb::arg("x"), nb::arg("distance"), nb::arg("threads"))
      .def("facing", &facing, nb::arg("middle"), nb::arg("radius"), nb::arg("normal"),
           nb::arg("centre"), nb::arg("size"), nb::arg("other"), nb::arg("distance"),
           nb::arg("farther"), nb::arg("offsets"), nb::arg("unmet"), nb::arg("threads"))
      .def("rings", &rings, nb::arg("facet"), nb::arg("count"))
      .def("sides", &sides);
  m.def("facet_balls", &balls, nb::arg("nodes"), nb::arg("x"));
  m.def("facet_normals", &normals, nb::arg("nodes"), nb::arg("flip"), nb::arg("gradient"),
        nb::arg("x"));
  nb::class_<search::Smoothing>(m, "Smoothing")
      .def(
          "__init__",
          [](search::Smoothing* self, const Points& x, const std::vector<std::string>& topologies,
             const Indices& counts, const Indices& nodes, const Flags& flip, double crease) {
            new (self) search::Smoothing(rows(x), kinds(topologies, counts, flip),
                                         {nodes.data(), nodes.data() + nodes.shape(0)}, crease);
          },
          nb::arg("points"), nb::arg("topologies"), nb::arg("counts"), nb::arg("nodes"),
          nb::arg("flip"), nb::arg("crease"))
      .def("nodes", &search::Smoothing::nodes, nb::arg("points"))
      .def("middles", &middles, nb::arg("points"))
      .def("derivatives", &middle_derivatives, nb::arg("points"));
}

}  // namespace anisocontact::bindings
