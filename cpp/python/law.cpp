// The tangential law by itself: trial force to force, without a surface.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "anisocontact/kernel/parallel.hpp"
#include "anisocontact/law/slide_batch.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

struct RuleHandle {
  law::AnyRule any;
};

/// The data of an optional array, whose length is checked.
template <class A>
const double* data_of(const std::optional<A>& a, std::size_t n) {
  if (a && a->shape(0) != n)
    throw std::invalid_argument("metric, axes or increment differs in length");
  return a ? a->data() : nullptr;
}

nb::dict slide(const RuleHandle& rule, const Matrices& stiffness, const Matrices& friction,
               const Coordinates& trial, const Scalars& pressure,
               const std::optional<Matrices>& metric, const std::optional<Matrices>& axes,
               const std::optional<Coordinates>& increment, bool with_tangent,
               std::size_t threads) {
  const std::size_t n = pressure.shape(0), n_tangent = with_tangent ? n : 0;
  if (stiffness.shape(0) != n || friction.shape(0) != n || trial.shape(0) != n)
    throw std::invalid_argument("stiffness, friction, trial and pressure differ in length");
  Array<double> traction({n, 2}), stored({n, 2}), slip({n, 2}), d_trial({n_tangent, 2, 2}),
      d_pressure({n_tangent, 2});
  Array<bool> slides({n}), converged({n});
  const law::SlideBatch batch{{stiffness.data(), friction.data(), trial.data(), pressure.data(),
                               data_of(metric, n), data_of(axes, n), data_of(increment, n)},
                              {traction.data, stored.data, slip.data, d_trial.data, d_pressure.data,
                               slides.data, converged.data}};
  {
    nb::gil_scoped_release free;
    kernel::parallel_pieces(n, threads, [&](std::size_t first, std::size_t last) {
      law::slide(rule.any, batch, first, last, with_tangent);
    });
  }
  nb::dict d;
  d["traction"] = traction.array;
  d["stored"] = stored.array;
  d["slip"] = slip.array;
  d["d_trial"] = d_trial.array;
  d["d_pressure"] = d_pressure.array;
  d["slides"] = slides.array;
  d["converged"] = converged.array;
  return d;
}

/// w, A, B, C of an adhesion model along its axes, row by row.
std::tuple<double, law::AxesMatrix, law::AxesMatrix, law::AxesMatrix> linear_model(
    const std::string& name, const ValueMap& values) {
  const law::AnyAdhesion any = law::AdhesionModels::make(name, Values(values));
  const law::LinearModel& model = law::linear_model(any);
  return {model.w, model.a, model.b, model.c};
}

}  // namespace

void bind_law(nb::module_& m) {
  m.def("linear_model", &linear_model, nb::arg("name"), nb::arg("values"));
  nb::class_<RuleHandle>(m, "SlidingRule")
      .def(
          "__init__",
          [](RuleHandle* self, const std::string& name, const ValueMap& values) {
            new (self) RuleHandle{law::SlidingRules::make(name, Values(values))};
          },
          nb::arg("name"), nb::arg("values"))
      .def("slide", &slide, nb::arg("stiffness"), nb::arg("friction"), nb::arg("trial"),
           nb::arg("pressure"), nb::arg("metric").none(), nb::arg("axes").none(),
           nb::arg("increment").none(), nb::arg("tangent"), nb::arg("threads"));
}

}  // namespace anisocontact::bindings
