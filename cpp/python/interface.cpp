// Batches of points through a whole interface.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/kernel/point.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "given_law.hpp"
#include "own_input.hpp"
#include "states.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

using kernel::PointState;

struct InterfaceHandle {
  kernel::Interface itf;
};

/// Name, offset, count and NumPy type of each field of a point's state.
nb::list state_layout() {
  nb::list l;
  for (const auto& f : kernel::state_fields)
    l.append(nb::make_tuple(f.name, f.offset, f.count, f.whole ? "i8" : "f8"));
  return l;
}

/// States before the first step, and which points have no projection.
nb::dict initial_state(const InterfaceHandle& h, const Points& x) {
  const std::size_t n = x.shape(0);
  Array<std::uint8_t> state({n, sizeof(PointState)});
  Array<std::int8_t> failure({n});
  for (std::size_t i = 0; i < n; ++i) {
    auto f = kernel::Failure::none;
    store(state.data, i, kernel::initial_state(h.itf.surface, row3(x.data(), i), f));
    failure.data[i] = static_cast<std::int8_t>(f);
  }
  nb::dict r;
  r["state"] = state.array;
  r["failure"] = failure.array;
  return r;
}

/// What a law that is not in the core sees at the points.
nb::dict law_input(const InterfaceHandle& h, const Bytes& state, const Points& x, double dt,
                   std::size_t threads, const Points& own_reference,
                   const Tangents& own_reference_tangents, const Tangents& own_tangents) {
  const std::size_t n = x.shape(0);
  const States states(state, n);
  const OwnInput own{own_reference, own_reference_tangents, own_tangents};
  const LawInputs inputs(n);
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const kernel::Carrier carrier = own.at(i);
      kernel::LawInput input;
      const auto r = kernel::update<false>(h.itf, kernel::Recorder(input), states[i],
                                           row3(x.data(), i), own.given() ? &carrier : nullptr, dt);
      inputs.put(i, input, r.state);
    });
  }
  return inputs.result();
}

nb::dict update(const InterfaceHandle& h, const Bytes& state, const Points& x, double dt,
                bool with_tangent, std::size_t threads, const Points& own_reference,
                const Tangents& own_reference_tangents, const Tangents& own_tangents,
                const std::optional<Table>& outputs) {
  const std::size_t n = x.shape(0);
  const States states(state, n);
  const BatchLaw law(h.itf.law, outputs, n);
  const OwnInput own{own_reference, own_reference_tangents, own_tangents};
  const std::size_t m = with_tangent ? n : 0, own_rows = own.given() ? m : 0;
  Array<std::uint8_t> next({n, sizeof(PointState)});
  Array<double> traction({n, 3}), tangent({m, 3, 3}), by_slip({m, 3, 3}),
      own_tangent({own_rows, 2, 3, 3}), normal({n, 3}), adhesion({n, 2, 3}), friction({n, 2, 3});
  Array<std::int8_t> failure({n});
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const PointState s = states[i];
      const Vec3<double> p = row3(x.data(), i);
      const kernel::Carrier carrier = own.at(i);
      const auto* slave = own.given() ? &carrier : nullptr;
      const auto r = law.at(i, [&](const kernel::Law& reacts) {
        return with_tangent ? kernel::update<true>(h.itf, reacts, s, p, slave, dt)
                            : kernel::update<false>(h.itf, reacts, s, p, slave, dt);
      });
      store(next.data, i, r.state);
      put3(traction.data, i, r.traction);
      put3(normal.data, i, r.normal);
      for (std::size_t k = 0; k < 2; ++k) {
        put3(adhesion.data, 2 * i + k, r.adhesion_axes[k]);
        put3(friction.data, 2 * i + k, r.friction_axes[k]);
        if (own_rows > 0) put9(own_tangent.data, 2 * i + k, r.d_slave_tangents[k]);
      }
      if (with_tangent) {
        put9(tangent.data, i, r.tangent);
        put9(by_slip.data, i, r.by_slip);
      }
      failure.data[i] = static_cast<std::int8_t>(r.failure);
    });
  }
  nb::dict d;
  d["state"] = next.array;
  d["traction"] = traction.array;
  d["tangent"] = tangent.array;
  d["by_slip"] = by_slip.array;
  d["tangent_own"] = own_tangent.array;
  d["normal"] = normal.array;
  d["adhesion_axes"] = adhesion.array;
  d["friction_axes"] = friction.array;
  d["failure"] = failure.array;
  return d;
}

}  // namespace

void bind_interface(nb::module_& m) {
  m.def("state_layout", &state_layout);
  m.attr("state_size") = sizeof(PointState);
  nb::class_<LawHandle>(m, "Law")
      .def(
          "__init__",
          [](LawHandle* self, const Named& normal, const Named& adhesion,
             const FieldHandle* adhesion_directions, const Named& friction,
             const FieldHandle* friction_directions, const FieldHandle* friction_directions_second,
             const Named& rule, const std::string& evolution, const OnSlave& on_slave) {
            new (self) LawHandle{make_law(normal, adhesion, adhesion_directions, friction,
                                          friction_directions, friction_directions_second, rule,
                                          evolution, on_slave)};
          },
          nb::arg("normal"), nb::arg("adhesion"), nb::arg("adhesion_directions").none(),
          nb::arg("friction"), nb::arg("friction_directions").none(),
          nb::arg("friction_directions_second").none(), nb::arg("rule"), nb::arg("evolution"),
          nb::arg("on_slave"))
      .def_static("given", &given_law, nb::arg("normal"), nb::arg("directions").none(),
                  nb::arg("on_slave"));
  nb::class_<InterfaceHandle>(m, "Interface")
      .def(
          "__init__",
          [](InterfaceHandle* self, const SurfaceHandle& surface, const LawHandle& law) {
            new (self) InterfaceHandle{{surface.any, law.law}};
          },
          nb::arg("surface"), nb::arg("law"))
      .def("initial_state", &initial_state, nb::arg("x"))
      .def("law_input", &law_input, nb::arg("state"), nb::arg("x"), nb::arg("dt"),
           nb::arg("threads"), nb::arg("own_reference"), nb::arg("own_reference_tangents"),
           nb::arg("own_tangents"))
      .def("update", &update, nb::arg("state"), nb::arg("x"), nb::arg("dt"), nb::arg("tangent"),
           nb::arg("threads"), nb::arg("own_reference"), nb::arg("own_reference_tangents"),
           nb::arg("own_tangents"), nb::arg("outputs").none() = nb::none());
}

}  // namespace anisocontact::bindings
