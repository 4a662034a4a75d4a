// Descriptions of everything registered.

#include "anisocontact/registry/descriptor.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "anisocontact/kernel/evolution.hpp"
#include "bindings.hpp"
#include "types.hpp"

namespace nb = nanobind;

namespace anisocontact::bindings {

namespace {

const char* word(Kind k) {
  switch (k) {
    case Kind::scalar:
      return "scalar";
    case Kind::pair:
      return "pair";
    case Kind::vector:
      return "vector";
    case Kind::axis:
      return "axis";
    case Kind::array:
      return "array";
    case Kind::integer:
      return "integer";
    case Kind::integers:
      return "integers";
    case Kind::flag:
      return "flag";
    case Kind::choice:
      return "choice";
  }
  return "";
}

const char* word(Bound b) {
  switch (b) {
    case Bound::any:
      return "any";
    case Bound::nonzero:
      return "nonzero";
    case Bound::positive:
      return "positive";
    case Bound::non_negative:
      return "non-negative";
  }
  return "";
}

}  // namespace

void bind_registry(nb::module_& m) {
  nb::class_<Parameter>(m, "Parameter")
      .def_ro("name", &Parameter::name)
      .def_prop_ro("kind", [](const Parameter& p) { return word(p.kind); })
      .def_ro("unit", &Parameter::unit)
      .def_ro("doc", &Parameter::doc)
      .def_prop_ro("bound", [](const Parameter& p) { return word(p.bound); })
      .def_ro("required", &Parameter::required)
      .def_ro("fallback", &Parameter::fallback)
      .def_ro("choices", &Parameter::choices)
      .def_ro("isotropic", &Parameter::isotropic);
  nb::class_<Descriptor>(m, "Descriptor")
      .def_ro("name", &Descriptor::name)
      .def_ro("doc", &Descriptor::doc)
      .def_ro("parameters", &Descriptor::parameters)
      .def_ro("directions", &Descriptor::directions);
  m.def("surfaces", &surface::Surfaces::describe);
  m.def("direction_fields", &anisotropy::Fields::describe);
  m.def("normal_laws", &law::NormalLaws::describe);
  m.def("adhesion_models", &law::AdhesionModels::describe);
  m.def("friction_models", &law::FrictionModels::describe);
  m.def("sliding_rules", &law::SlidingRules::describe);
  m.def("evolution_forms", &kernel::EvolutionForms::describe);
}

}  // namespace anisocontact::bindings
