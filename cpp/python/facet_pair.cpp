// Batches of slave points against the facets of a mesh, with the laws of the core.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "facet_question.hpp"
#include "rooms.hpp"

namespace anisocontact::bindings {

void bind_facet_pair(nb::module_& m) {
  nb::class_<PairHandle> pairs(m, "FacetPairs");
  pairs.def(
      "__init__",
      [](PairHandle* self, const Named& normal, const Named& adhesion,
         const FieldHandle* adhesion_directions, const Named& friction,
         const FieldHandle* friction_directions, const FieldHandle* friction_second,
         const Named& rule, const std::string& evolution, bool mirrored, const OnSlave& on_slave) {
        new (self)
            PairHandle{make_law(normal, adhesion, adhesion_directions, friction,
                                friction_directions, friction_second, rule, evolution, on_slave),
                       mirrored};
      },
      nb::arg("normal"), nb::arg("adhesion"), nb::arg("adhesion_directions").none(),
      nb::arg("friction"), nb::arg("friction_directions").none(),
      nb::arg("friction_directions_second").none(), nb::arg("rule"), nb::arg("evolution"),
      nb::arg("mirrored") = false, nb::arg("on_slave") = OnSlave{});
  def_questions(pairs);
}

}  // namespace anisocontact::bindings
