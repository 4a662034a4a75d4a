// Surfaces: jets, geometry, closest points.

#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/projection/closest_point.hpp"
#include "arrays.hpp"
#include "rooms.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

nb::dict jet(const SurfaceHandle& s, const Coordinates& xi) {
  const std::size_t n = xi.shape(0);
  Array<double> position({n, 3}), d1({n, 2, 3}), d2({n, 3, 3});
  for (std::size_t i = 0; i < n; ++i) {
    const auto j = surface::jet(s.any, xi.data()[2 * i], xi.data()[2 * i + 1]);
    put3(position.data, i, j.position);
    for (std::size_t k = 0; k < 2; ++k) put3(d1.data, 2 * i + k, j.d1[k]);
    for (std::size_t k = 0; k < 3; ++k) put3(d2.data, 3 * i + k, j.d2[k]);
  }
  nb::dict r;
  r["position"] = position.array;
  r["d1"] = d1.array;
  r["d2"] = d2.array;
  return r;
}

template <class M>
void put4(double* p, std::size_t i, const M& m) {
  for (std::size_t k = 0; k < 4; ++k) p[4 * i + k] = m(k / 2, k % 2);
}

nb::dict geometry(const SurfaceHandle& s, const Coordinates& xi) {
  const std::size_t n = xi.shape(0);
  Array<double> a_co({n, 2, 2}), a_contra({n, 2, 2}), area({n}), normal({n, 3}), h_co({n, 2, 2}),
      h_mixed({n, 2, 2}), christoffel({n, 2, 2, 2});
  for (std::size_t i = 0; i < n; ++i) {
    const auto g = surface::geometry(surface::jet(s.any, xi.data()[2 * i], xi.data()[2 * i + 1]));
    put4(a_co.data, i, g.a_co);
    put4(a_contra.data, i, g.a_contra);
    area.data[i] = g.area;
    put3(normal.data, i, g.normal);
    put4(h_co.data, i, g.h_co);
    put4(h_mixed.data, i, g.h_mixed);
    for (std::size_t k = 0; k < 2; ++k) put4(christoffel.data, 2 * i + k, g.christoffel[k]);
  }
  nb::dict r;
  r["a_co"] = a_co.array;
  r["a_contra"] = a_contra.array;
  r["area"] = area.array;
  r["normal"] = normal.array;
  r["h_co"] = h_co.array;
  r["h_mixed"] = h_mixed.array;
  r["christoffel"] = christoffel.array;
  return r;
}

nb::dict project(const SurfaceHandle& s, const Points& x, std::size_t threads) {
  const std::size_t n = x.shape(0);
  Array<double> xi({n, 2}), gap({n});
  Array<std::int8_t> status({n});
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const Vec3<double> p = row3(x.data(), i);
      const auto r = projection::closest_point(s.any, p);
      const auto g = surface::geometry(surface::jet(s.any, r.xi[0], r.xi[1]));
      xi.data[2 * i] = r.xi[0];
      xi.data[2 * i + 1] = r.xi[1];
      gap.data[i] = (p - g.jet.position).dot(g.normal);
      status.data[i] = static_cast<std::int8_t>(r.status);
    });
  }
  nb::dict r;
  r["xi"] = xi.array;
  r["gap"] = gap.array;
  r["status"] = status.array;
  return r;
}

}  // namespace

void bind_surface(nb::module_& m) {
  nb::class_<SurfaceHandle>(m, "Surface")
      .def("__init__",
           [](SurfaceHandle* self, const std::string& name, const ValueMap& values) {
             new (self) SurfaceHandle{surface::Surfaces::make(name, Values(values))};
           },
           nb::arg("name"), nb::arg("values"))
      .def("jet", &jet, nb::arg("xi"))
      .def("geometry", &geometry, nb::arg("xi"))
      .def("project", &project, nb::arg("x"), nb::arg("threads"))
      .def("domain", [](const SurfaceHandle& s) {
        const auto d = surface::domain(s.any);
        return nb::make_tuple(nb::make_tuple(d.lower[0], d.lower[1]),
                              nb::make_tuple(d.upper[0], d.upper[1]),
                              nb::make_tuple(d.periodic[0], d.periodic[1]));
      });
}

}  // namespace anisocontact::bindings
