// Surfaces: jets, geometry, closest points.

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/projection/closest_point.hpp"
#include "anisocontact/projection/linearisation.hpp"
#include "anisocontact/projection/velocity.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "geometries.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

surface::Geometry<double> geometry_at(const SurfaceHandle& s, const double* xi, std::size_t i) {
  return surface::geometry(surface::jet(s.any, xi[2 * i], xi[2 * i + 1]));
}

nb::dict jet(const SurfaceHandle& s, const Coordinates& xi) {
  return jets(xi.shape(0), [&](std::size_t i) {
    return surface::jet(s.any, xi.data()[2 * i], xi.data()[2 * i + 1]);
  });
}

nb::dict geometry(const SurfaceHandle& s, const Coordinates& xi) {
  return geometries(xi.shape(0), [&](std::size_t i) {
    return surface::jet(s.any, xi.data()[2 * i], xi.data()[2 * i + 1]);
  });
}

/// Derivatives along the coordinates (last index of a_co, second of normal) by dual numbers.
nb::dict geometry_derivatives(const SurfaceHandle& s, const Coordinates& xi) {
  using S = Dual<3>;
  const std::size_t n = xi.shape(0);
  Array<double> a_co({n, 2, 2, 2}), normal({n, 2, 3}), h_co({n, 2, 2, 2});
  for (std::size_t p = 0; p < n; ++p) {
    const auto g = surface::geometry(surface::jet(s.any, S::variable(xi.data()[2 * p], 0),
                                                  S::variable(xi.data()[2 * p + 1], 1)));
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t ij = 0; ij < 4; ++ij) {
        a_co.data[8 * p + 2 * ij + k] = g.a_co(ij / 2, ij % 2).d[k];
        h_co.data[8 * p + 2 * ij + k] = g.h_co(ij / 2, ij % 2).d[k];
      }
      put3(normal.data, 2 * p + k, {g.normal[0].d[k], g.normal[1].d[k], g.normal[2].d[k]});
    }
  }
  nb::dict r;
  r["a_co"] = a_co.array;
  r["normal"] = normal.array;
  r["h_co"] = h_co.array;
  return r;
}

nb::ndarray<nb::numpy, double> spatial_basis(const SurfaceHandle& s, const Coordinates& xi,
                                             const Scalars& gap) {
  const std::size_t n = xi.shape(0);
  Array<double> basis({n, 3, 3});
  for (std::size_t i = 0; i < n; ++i) {
    const auto r = surface::spatial_basis(geometry_at(s, xi.data(), i), gap.data()[i]);
    for (std::size_t k = 0; k < 3; ++k) put3(basis.data, 3 * i + k, r[k]);
  }
  return basis.array;
}

/// Of a field with contravariant (P = contra) or covariant components.
template <Place P>
nb::ndarray<nb::numpy, double> covariant_derivative(const SurfaceHandle& s, const Coordinates& xi,
                                                    const Coordinates& components,
                                                    const Matrices& derivatives) {
  const std::size_t n = xi.shape(0);
  Array<double> out({n, 2, 2});
  for (std::size_t i = 0; i < n; ++i) {
    const double* d = derivatives.data() + 4 * i;
    const Tangent1<double, P> u{{components.data()[2 * i], components.data()[2 * i + 1]}};
    const Tangent2<double, P, Place::co> du{{{{d[0], d[1]}, {d[2], d[3]}}}};
    put4(out.data, i, surface::covariant_derivative(geometry_at(s, xi.data(), i), u, du));
  }
  return out.array;
}

/// Where the results of a batch of projections go; the derivatives only if asked for.
struct ProjectionOutput {
  double *xi, *gap, *dxi_dx, *dgap_dx;
  std::int8_t* status;
  bool derivatives;

  void put(std::size_t i, const SurfaceHandle& s, const Vec3<double>& x,
           const projection::Projection& p) const noexcept {
    status[i] = static_cast<std::int8_t>(p.status);
    if (p.status == projection::Status::failed) {
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      xi[2 * i] = xi[2 * i + 1] = gap[i] = none;
      if (derivatives) {
        std::fill_n(dxi_dx + 6 * i, 6, none);
        std::fill_n(dgap_dx + 3 * i, 3, none);
      }
      return;
    }
    const auto g = surface::geometry(surface::jet(s.any, p.xi[0], p.xi[1]));
    xi[2 * i] = p.xi[0];
    xi[2 * i + 1] = p.xi[1];
    gap[i] = (x - g.jet.position).dot(g.normal);
    if (!derivatives) return;
    const auto d = projection::coordinate_gradient(g, p, x);
    put3(dxi_dx, 2 * i, d[0]);
    put3(dxi_dx, 2 * i + 1, d[1]);
    put3(dgap_dx, i, projection::gap_gradient(g, p, x, d));
  }
};

nb::dict project(const SurfaceHandle& s, const Points& x, const std::optional<Coordinates>& guess,
                 bool derivatives, std::size_t threads) {
  const std::size_t n = x.shape(0), m = derivatives ? n : 0;
  Array<double> xi({n, 2}), gap({n}), dxi_dx({m, 2, 3}), dgap_dx({m, 3});
  Array<std::int8_t> status({n});
  const ProjectionOutput out{xi.data,      gap.data,    dxi_dx.data,
                             dgap_dx.data, status.data, derivatives};
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const Vec3<double> p = row3(x.data(), i);
      projection::Coordinates start{};
      if (guess) start = {guess->data()[2 * i], guess->data()[2 * i + 1]};
      out.put(i, s, p, projection::closest_point(s.any, p, guess ? &start : nullptr));
    });
  }
  nb::dict r;
  r["xi"] = xi.array;
  r["gap"] = gap.array;
  r["status"] = status.array;
  r["dxi_dx"] = dxi_dx.array;
  r["dgap_dx"] = dgap_dx.array;
  return r;
}

/// At xi^3 = 0 without a gap, exact with one; `derivatives` are those of the master's velocity.
nb::tuple convective_velocity(const SurfaceHandle& s, const Coordinates& xi,
                              const std::optional<Scalars>& gap, const Points& relative,
                              const Points& derivatives) {
  const std::size_t n = xi.shape(0);
  Array<double> rate({n, 2}), gap_rate({n});
  for (std::size_t i = 0; i < n; ++i) {
    const auto g = geometry_at(s, xi.data(), i);
    const Vec3<double> v = row3(relative.data(), i);
    const auto r = gap ? projection::convective_velocity(
                             g, gap->data()[i], v,
                             {row3(derivatives.data(), 2 * i), row3(derivatives.data(), 2 * i + 1)})
                       : projection::convective_velocity(g, v);
    rate.data[2 * i] = r.xi[0];
    rate.data[2 * i + 1] = r.xi[1];
    gap_rate.data[i] = r.gap;
  }
  return nb::make_tuple(rate.array, gap_rate.array);
}

}  // namespace

void bind_surface(nb::module_& m) {
  nb::class_<SurfaceHandle>(m, "Surface")
      .def(
          "__init__",
          [](SurfaceHandle* self, const std::string& name, const ValueMap& values) {
            new (self) SurfaceHandle{surface::Surfaces::make(name, Values(values))};
          },
          nb::arg("name"), nb::arg("values"))
      .def("jet", &jet, nb::arg("xi"))
      .def("geometry", &geometry, nb::arg("xi"))
      .def("geometry_derivatives", &geometry_derivatives, nb::arg("xi"))
      .def("spatial_basis", &spatial_basis, nb::arg("xi"), nb::arg("gap"))
      .def("covariant_derivative_contra", &covariant_derivative<Place::contra>, nb::arg("xi"),
           nb::arg("components"), nb::arg("derivatives"))
      .def("covariant_derivative_co", &covariant_derivative<Place::co>, nb::arg("xi"),
           nb::arg("components"), nb::arg("derivatives"))
      .def("convective_velocity", &convective_velocity, nb::arg("xi"), nb::arg("gap").none(),
           nb::arg("relative"), nb::arg("derivatives"))
      .def("project", &project, nb::arg("x"), nb::arg("guess").none(), nb::arg("derivatives"),
           nb::arg("threads"))
      .def("domain", [](const SurfaceHandle& s) {
        const auto d = surface::domain(s.any);
        return nb::make_tuple(nb::make_tuple(d.lower[0], d.lower[1]),
                              nb::make_tuple(d.upper[0], d.upper[1]),
                              nb::make_tuple(d.periodic[0], d.periodic[1]));
      });
}

}  // namespace anisocontact::bindings
