// Kinematics for laws written in Python, and the commit of what they return.

#include "anisocontact/kernel/framed.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "anisocontact/kernel/parallel.hpp"
#include "arrays.hpp"
#include "own_input.hpp"
#include "rooms.hpp"
#include "states.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

using kernel::Framed;

/// Surface, normal law and frame of an interface whose tangential law is elsewhere.
struct FramedHandle {
  surface::AnySurface surface;
  law::AnyNormalLaw normal;
  std::optional<anisotropy::AnyField> directions;

  Framed at(std::size_t i, const kernel::PointState& s, const Points& x, const OwnInput& own,
            double dt) const {
    const kernel::Carrier carrier = own.at(i);
    return kernel::framed(surface, law::normal_model(normal), directions, s, row3(x.data(), i),
                          own.given() ? &carrier : nullptr, dt);
  }
};

/// Value and derivative arrays of dual numbers.
struct DualArray {
  Array<double> value, dx;
  std::size_t columns;

  DualArray(std::size_t n, std::size_t m) : value({n, m}), dx({n, m, 3}), columns(m) {}

  void put(std::size_t i, std::size_t k, const Dual<3>& d) const {
    value.data[i * columns + k] = d.v;
    for (std::size_t j = 0; j < 3; ++j) dx.data[3 * (i * columns + k) + j] = d.d[j];
  }
  void into(nb::dict& r, const char* name) const {
    r[name] = value.array;
    r[(std::string(name) + "_dx").c_str()] = dx.array;
  }
};

nb::dict kinematics(const FramedHandle& h, const Bytes& state, const Points& x, double dt,
                    std::size_t threads, const Points& own_reference,
                    const Tangents& own_reference_tangents, const Tangents& own_tangents) {
  const std::size_t n = x.shape(0);
  check_states(state, n);
  const OwnInput own{own_reference, own_reference_tangents, own_tangents};
  const DualArray frame(n, 9), increment(n, 2), stored(n, 2), elastic(n, 2), gap(n, 1),
      pressure(n, 1);
  Array<double> xi({n, 2}), by_slave({own.given() ? n : 0, 2, 2, 3});
  Array<std::int8_t> failure({n});
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      const Framed f = h.at(i, load(state.data(), i), x, own, dt);
      for (std::size_t k = 0; k < 9; ++k)
        frame.put(i, k, f.frame[k / 3][static_cast<Eigen::Index>(k % 3)]);
      for (std::size_t k = 0; k < 2; ++k) {
        increment.put(i, k, f.increment[k]);
        stored.put(i, k, f.stored[k]);
        elastic.put(i, k, f.elastic[k]);
        xi.data[2 * i + k] = f.xi[k];
        for (std::size_t j = 0; j < 6 && own.given(); ++j)
          by_slave.data[6 * (2 * i + k) + j] = f.by_slave[k].d[j];
      }
      gap.put(i, 0, f.gap);
      pressure.put(i, 0, f.pressure);
      failure.data[i] = static_cast<std::int8_t>(f.failure);
    });
  }
  nb::dict r;
  frame.into(r, "frame");
  increment.into(r, "increment");
  stored.into(r, "stored");
  elastic.into(r, "elastic");
  gap.into(r, "gap");
  pressure.into(r, "pressure");
  r["increment_slave"] = by_slave.array;
  r["xi"] = xi.array;
  r["failure"] = failure.array;
  return r;
}

nb::object commit(const FramedHandle& h, const Bytes& state, const Points& x, double dt,
                  const Coordinates& traction, const Coordinates& stored, const Coordinates& slip,
                  const Scalars& dissipation, const Scalars& energy, const Codes& status,
                  const Points& own_reference, const Tangents& own_reference_tangents,
                  const Tangents& own_tangents) {
  const std::size_t n = x.shape(0);
  check_states(state, n);
  const OwnInput own{own_reference, own_reference_tangents, own_tangents};
  Array<std::uint8_t> next({n, sizeof(kernel::PointState)});
  const auto pair = [](const Coordinates& a, std::size_t i) -> std::array<double, 2> {
    return {a.data()[2 * i], a.data()[2 * i + 1]};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const auto old = load(state.data(), i);
    const Framed f = h.at(i, old, x, own, dt);
    if (f.failure != kernel::Failure::none) {
      store(next.data, i, old);
      continue;
    }
    const auto g = surface::geometry(surface::jet(h.surface, f.xi[0], f.xi[1]));
    const kernel::FramedResult r{pair(traction, i), pair(stored, i),
                                 pair(slip, i),     dissipation.data()[i],
                                 energy.data()[i],  static_cast<kernel::Contact>(status.data()[i])};
    store(next.data, i, kernel::commit(law::normal_model(h.normal), old, f, g, r, dt));
  }
  return nb::cast(next.array);
}

}  // namespace

void bind_framed(nb::module_& m) {
  nb::class_<FramedHandle>(m, "FramedInterface")
      .def(
          "__init__",
          [](FramedHandle* self, const SurfaceHandle& surface, const Named& normal,
             const FieldHandle* directions) {
            new (self) FramedHandle{
                surface.any, law::NormalLaws::make(normal.first, Values(normal.second)),
                directions == nullptr ? std::nullopt : std::optional(directions->any)};
          },
          nb::arg("surface"), nb::arg("normal"), nb::arg("directions").none())
      .def("kinematics", &kinematics, nb::arg("state"), nb::arg("x"), nb::arg("dt"),
           nb::arg("threads"), nb::arg("own_reference"), nb::arg("own_reference_tangents"),
           nb::arg("own_tangents"))
      .def("commit", &commit, nb::arg("state"), nb::arg("x"), nb::arg("dt"), nb::arg("traction"),
           nb::arg("stored"), nb::arg("slip"), nb::arg("dissipation"), nb::arg("energy"),
           nb::arg("status"), nb::arg("own_reference"), nb::arg("own_reference_tangents"),
           nb::arg("own_tangents"))
      .def(
          "initial_state",
          [](const FramedHandle& h, const Points& x) { return initial_states(h.surface, x); },
          nb::arg("x"));
}

}  // namespace anisocontact::bindings
