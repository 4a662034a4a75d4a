// Direction fields and the tensors built on them.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "anisocontact/law/registry.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

struct FrictionHandle {
  law::AnyFriction any;
};

Vector<double> coordinates(const Coordinates& xi, std::size_t i) {
  return {{xi.data()[2 * i], xi.data()[2 * i + 1]}};
}

surface::Geometry<double> geometry_at(const SurfaceHandle& s, const Vector<double>& xi) {
  return surface::geometry(surface::jet(s.any, xi[0], xi[1]));
}

nb::dict axes(const FieldHandle& f, const SurfaceHandle& s, const Coordinates& xi) {
  const std::size_t n = xi.shape(0);
  Array<double> e({n, 2, 3});
  Array<bool> valid({n});
  for (std::size_t i = 0; i < n; ++i) {
    const auto c = coordinates(xi, i);
    const auto a = anisotropy::axes(f.any, geometry_at(s, c), c);
    for (std::size_t k = 0; k < 2; ++k) put3(e.data, 2 * i + k, a.e[k]);
    valid.data[i] = a.valid;
  }
  nb::dict r;
  r["e"] = e.array;
  r["valid"] = valid.array;
  return r;
}

/// Values and derivatives with respect to xi^1, xi^2 of a tensor in dual numbers.
template <class M>
void put_tensor(double* values, double* derivatives, std::size_t n, const M& m) {
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& c = m(k / 2, k % 2);
    values[4 * n + k] = c.v;
    for (std::size_t d = 0; d < 2; ++d) derivatives[8 * n + 2 * k + d] = c.d[d];
  }
}

/// sum_a lambda_a e_a (x) e_a in co- and contravariant components, with derivatives.
nb::dict tensor(const FieldHandle& f, const SurfaceHandle& s, const Coordinates& xi,
                const std::array<double, 2>& lambda) {
  using S = Dual<3>;
  const std::size_t n = xi.shape(0);
  Array<double> co({n, 2, 2}), contra({n, 2, 2}), d_co({n, 2, 2, 2}), d_contra({n, 2, 2, 2});
  Array<bool> valid({n});
  for (std::size_t i = 0; i < n; ++i) {
    const auto c = coordinates(xi, i);
    const Vector<S> eta{{S::variable(c[0], 0), S::variable(c[1], 1)}};
    const auto g = surface::geometry(surface::jet(s.any, eta[0], eta[1]));
    const auto a = anisotropy::axes(f.any, g, eta);
    put_tensor(co.data, d_co.data, i, anisotropy::pull_back_co(g, a, lambda));
    put_tensor(contra.data, d_contra.data, i, anisotropy::pull_back_contra(g, a, lambda));
    valid.data[i] = a.valid;
  }
  nb::dict r;
  r["co"] = co.array;
  r["contra"] = contra.array;
  r["d_co"] = d_co.array;
  r["d_contra"] = d_contra.array;
  r["valid"] = valid.array;
  return r;
}

anisotropy::Axes<double> axes_or_any(const FieldHandle* f, const surface::Geometry<double>& g,
                                     const Vector<double>& xi) {
  if (f != nullptr) return anisotropy::axes(f->any, g, xi);
  return anisotropy::axes_from(g, g.jet.d1[0], anisotropy::Turn{});
}

/// f^ij of a friction model; without directions it is isotropic, and any axes do.
nb::dict friction_tensor(const FrictionHandle& f, const SurfaceHandle& s, const Coordinates& xi,
                         const FieldHandle* first, const FieldHandle* second) {
  const std::size_t n = xi.shape(0);
  Array<double> contra({n, 2, 2});
  Array<bool> valid({n});
  for (std::size_t i = 0; i < n; ++i) {
    const auto c = coordinates(xi, i);
    const auto g = geometry_at(s, c);
    const auto a = axes_or_any(first, g, c), b = axes_or_any(second, g, c);
    const auto m =
        law::friction_tensor(f.any, g.a_contra, g.project_contra(a.e), g.project_contra(b.e));
    for (std::size_t k = 0; k < 4; ++k) contra.data[4 * i + k] = m(k / 2, k % 2);
    valid.data[i] = a.valid && b.valid;
  }
  nb::dict r;
  r["contra"] = contra.array;
  r["valid"] = valid.array;
  return r;
}

}  // namespace

void bind_anisotropy(nb::module_& m) {
  nb::class_<FieldHandle>(m, "Field")
      .def(
          "__init__",
          [](FieldHandle* self, const std::string& name, const ValueMap& values) {
            new (self) FieldHandle{anisotropy::Fields::make(name, Values(values))};
          },
          nb::arg("name"), nb::arg("values"))
      .def("axes", &axes, nb::arg("surface"), nb::arg("xi"))
      .def("tensor", &tensor, nb::arg("surface"), nb::arg("xi"), nb::arg("values"));
  nb::class_<FrictionHandle>(m, "FrictionModel")
      .def(
          "__init__",
          [](FrictionHandle* self, const std::string& name, const ValueMap& values) {
            new (self) FrictionHandle{law::FrictionModels::make(name, Values(values))};
          },
          nb::arg("name"), nb::arg("values"))
      .def_prop_ro("frictionless", [](const FrictionHandle& f) { return law::frictionless(f.any); })
      .def("tensor", &friction_tensor, nb::arg("surface"), nb::arg("xi"),
           nb::arg("directions").none(), nb::arg("directions_second").none());
}

}  // namespace anisocontact::bindings
