// Direction fields and the tensors built on them.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "rooms.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

nb::dict axes(const FieldHandle& f, const SurfaceHandle& s, const Coordinates& xi) {
  const std::size_t n = xi.shape(0);
  Array<double> e({n, 2, 3});
  Array<bool> valid({n});
  for (std::size_t i = 0; i < n; ++i) {
    const Vector<double> c{{xi.data()[2 * i], xi.data()[2 * i + 1]}};
    const auto a = anisotropy::axes(f.any, surface::geometry(surface::jet(s.any, c[0], c[1])), c);
    for (std::size_t k = 0; k < 2; ++k) put3(e.data, 2 * i + k, a.e[k]);
    valid.data[i] = a.valid;
  }
  nb::dict r;
  r["e"] = e.array;
  r["valid"] = valid.array;
  return r;
}

}  // namespace

void bind_anisotropy(nb::module_& m) {
  nb::class_<FieldHandle>(m, "Field")
      .def("__init__",
           [](FieldHandle* self, const std::string& name, const ValueMap& values) {
             new (self) FieldHandle{anisotropy::Fields::make(name, Values(values))};
           },
           nb::arg("name"), nb::arg("values"))
      .def("axes", &axes, nb::arg("surface"), nb::arg("xi"));
}

}  // namespace anisocontact::bindings
