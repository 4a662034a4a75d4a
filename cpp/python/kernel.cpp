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
#include "own_input.hpp"
#include "rooms.hpp"
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
  const auto add = [&](const char* name, std::size_t offset, std::size_t count, const char* type) {
    l.append(nb::make_tuple(name, offset, count, type));
  };
  add("xi", offsetof(PointState, xi), 2, "f8");
  add("origin", offsetof(PointState, origin), 2, "f8");
  add("traction", offsetof(PointState, traction), 2, "f8");
  add("stored", offsetof(PointState, stored), 2, "f8");
  add("elastic", offsetof(PointState, elastic), 2, "f8");
  add("slip", offsetof(PointState, slip), 2, "f8");
  add("slave", offsetof(PointState, slave), 4, "f8");
  add("axes", offsetof(PointState, axes), 4, "f8");
  add("spin", offsetof(PointState, spin), 1, "f8");
  add("turn", offsetof(PointState, turn), 1, "f8");
  add("gap", offsetof(PointState, gap), 1, "f8");
  add("offset", offsetof(PointState, offset), 1, "f8");
  add("multiplier", offsetof(PointState, multiplier), 1, "f8");
  add("pressure", offsetof(PointState, pressure), 1, "f8");
  add("slip_accumulated", offsetof(PointState, slip_accumulated), 1, "f8");
  add("dissipation", offsetof(PointState, dissipation), 1, "f8");
  add("dissipation_viscous", offsetof(PointState, dissipation_viscous), 1, "f8");
  add("energy_adhesion", offsetof(PointState, energy_adhesion), 1, "f8");
  add("energy_normal", offsetof(PointState, energy_normal), 1, "f8");
  add("status", offsetof(PointState, status), 1, "i8");
  add("facet", offsetof(PointState, facet), 1, "i8");
  return l;
}

nb::dict update(const InterfaceHandle& h, const Bytes& state, const Points& x, double dt,
                bool with_tangent, std::size_t threads, const Points& own_reference,
                const Tangents& own_reference_tangents, const Tangents& own_tangents) {
  const std::size_t n = x.shape(0);
  check_states(state, n);
  const OwnInput own{own_reference, own_reference_tangents, own_tangents};
  const std::size_t m = with_tangent ? n : 0, own_rows = own.given() ? m : 0;
  Array<std::uint8_t> next({n, sizeof(PointState)});
  Array<double> traction({n, 3}), tangent({m, 3, 3}), own_tangent({own_rows, 2, 3, 3}),
      normal({n, 3}), adhesion({n, 2, 3}), friction({n, 2, 3});
  Array<std::int8_t> failure({n});
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const PointState s = load(state.data(), i);
      const Vec3<double> p = row3(x.data(), i);
      const kernel::Carrier carrier = own.at(i);
      const auto* slave = own.given() ? &carrier : nullptr;
      const auto r = with_tangent ? kernel::update<true>(h.itf, s, p, slave, dt)
                                  : kernel::update<false>(h.itf, s, p, slave, dt);
      store(next.data, i, r.state);
      put3(traction.data, i, r.traction);
      put3(normal.data, i, r.normal);
      for (std::size_t k = 0; k < 2; ++k) {
        put3(adhesion.data, 2 * i + k, r.adhesion_axes[k]);
        put3(friction.data, 2 * i + k, r.friction_axes[k]);
        if (own_rows > 0) put9(own_tangent.data, 2 * i + k, r.d_slave_tangents[k]);
      }
      if (with_tangent) put9(tangent.data, i, r.tangent);
      failure.data[i] = static_cast<std::int8_t>(r.failure);
    });
  }
  nb::dict d;
  d["state"] = next.array;
  d["traction"] = traction.array;
  d["tangent"] = tangent.array;
  d["tangent_own"] = own_tangent.array;
  d["normal"] = normal.array;
  d["adhesion_axes"] = adhesion.array;
  d["friction_axes"] = friction.array;
  d["failure"] = failure.array;
  return d;
}

}  // namespace

void bind_kernel(nb::module_& m) {
  m.def("state_layout", &state_layout);
  m.attr("state_size") = sizeof(PointState);
  nb::class_<InterfaceHandle>(m, "Interface")
      .def(
          "__init__",
          [](InterfaceHandle* self, const SurfaceHandle& surface, const Named& normal,
             const Named& adhesion, const FieldHandle* adhesion_directions, const Named& friction,
             const FieldHandle* friction_directions, const FieldHandle* friction_directions_second,
             const Named& rule, const std::string& evolution, const OnSlave& on_slave) {
            new (self) InterfaceHandle{
                {surface.any,
                 make_law(normal, adhesion, adhesion_directions, friction, friction_directions,
                          friction_directions_second, rule, evolution, on_slave)}};
          },
          nb::arg("surface"), nb::arg("normal"), nb::arg("adhesion"),
          nb::arg("adhesion_directions").none(), nb::arg("friction"),
          nb::arg("friction_directions").none(), nb::arg("friction_directions_second").none(),
          nb::arg("rule"), nb::arg("evolution"), nb::arg("on_slave") = OnSlave{})
      .def(
          "initial_state",
          [](const InterfaceHandle& h, const Points& x) {
            return initial_states(h.itf.surface, x);
          },
          nb::arg("x"))
      .def("update", &update, nb::arg("state"), nb::arg("x"), nb::arg("dt"), nb::arg("tangent"),
           nb::arg("threads"), nb::arg("own_reference"), nb::arg("own_reference_tangents"),
           nb::arg("own_tangents"));
}

}  // namespace anisocontact::bindings
