// The tangential law by itself: trial force to force, without a surface.

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "anisocontact/kernel/parallel.hpp"
#include "arrays.hpp"
#include "rooms.hpp"
#include "types.hpp"

namespace anisocontact::bindings {

namespace {

struct RuleHandle {
  law::AnyRule any;
};

/// Inputs of a batch of slides; what is left out is null.
struct SlideInput {
  const double *stiffness, *friction, *trial, *pressure;
  const double *metric, *axes, *increment;

  law::SlideProblem<double> problem(std::size_t i) const {
    law::SlideProblem<double> p;
    for (std::size_t k = 0; k < 4; ++k) {
      p.stiffness(k / 2, k % 2) = stiffness[4 * i + k];
      p.friction(k / 2, k % 2) = friction[4 * i + k];
      p.a_co(k / 2, k % 2) = metric ? metric[4 * i + k] : unit_[k];
      p.axes[k / 2][k % 2] = axes ? axes[4 * i + k] : unit_[k];
    }
    p.trial = {{trial[2 * i], trial[2 * i + 1]}};
    p.pressure = pressure[i];
    p.increment = increment ? Vector<double>{{increment[2 * i], increment[2 * i + 1]}}
                            : -slip_from_force(p, p.trial);
    p.elastic = p.increment;
    return p;
  }

 private:
  static constexpr std::array<double, 4> unit_{1.0, 0.0, 0.0, 1.0};
};

struct SlideOutput {
  double *traction, *stored, *slip, *d_trial, *d_pressure;
  bool *slides, *converged;
};

template <bool with_tangent>
void slide_one(const law::AnyRule& rule, const SlideInput& in, const SlideOutput& out,
               std::size_t i) noexcept {
  const auto p = in.problem(i);
  law::SlideResult<double> r{p.trial, p.trial, {}, true};
  law::SlideTangent t{unit<double, Place::co>(), {}};
  out.slides[i] = law::friction_norm(p.friction, p.trial) > p.pressure;
  if (out.slides[i]) {
    r = law::slide(rule, p);
    if constexpr (with_tangent) t = law::slide_tangent(rule, p, r);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    out.traction[2 * i + k] = r.traction[k];
    out.stored[2 * i + k] = r.stored[k];
    out.slip[2 * i + k] = r.slip[k];
  }
  out.converged[i] = r.converged;
  if constexpr (with_tangent)
    for (std::size_t k = 0; k < 2; ++k) {
      out.d_pressure[2 * i + k] = t.d_pressure[k];
      for (std::size_t j = 0; j < 2; ++j) out.d_trial[4 * i + 2 * k + j] = t.d_trial(k, j);
    }
}

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
  const SlideInput in{stiffness.data(),   friction.data(),  trial.data(),         pressure.data(),
                      data_of(metric, n), data_of(axes, n), data_of(increment, n)};
  const SlideOutput out{traction.data,   stored.data, slip.data,     d_trial.data,
                        d_pressure.data, slides.data, converged.data};
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, threads, [&](std::size_t i) {
      with_tangent ? slide_one<true>(rule.any, in, out, i) : slide_one<false>(rule.any, in, out, i);
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
