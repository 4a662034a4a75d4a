// Batches of slave points against facets with tangential laws that are written in Python.

#include "anisocontact/kernel/framed_pair.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "facet_question.hpp"
#include "rooms.hpp"

namespace anisocontact::bindings {

namespace {

using Answers = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using kernel::Answered, kernel::Told;

constexpr std::size_t answer_columns = sizeof(Answered) / sizeof(double);

/// Normal law and axes of a tangential law that is elsewhere.
struct FramedPairs : PairHandle {};

/// The same with what the law has answered at each point.
struct AnsweredPairs : PairHandle {
  Answers answers;

  template <bool tangent>
  kernel::PairResult at(std::size_t i, const kernel::PointState& state, const kernel::PairPoint& p,
                        double dt, kernel::PairSlopes* d) const noexcept {
    Answered answer;
    std::memcpy(&answer, answers.data() + i * answer_columns, sizeof(answer));
    return kernel::update_pair<tangent>(law, state, p, dt, d,
                                        kernel::AnsweredReaction{answer, mirrored});
  }
};

/// The adhesion and the friction of the core stay unused: they are there for their directions.
kernel::InterfaceLaw with_axes(const Named& normal, const FieldHandle* field, bool on_slave) {
  const Named adhesion{"elastic", {{"stiffness", {1.0, 1.0}}}},
      friction{"orthotropic", {{"coefficients", {1.0, 1.0}}}}, rule{"maximum-dissipation", {}};
  return make_law(normal, adhesion, field, friction, field, nullptr, rule, "transport",
                  {on_slave, on_slave, false});
}

/// What the law sees at all points; their axis and the normal of the contact plane.
nb::dict tell(const FramedPairs& h, const Question& q) {
  const std::size_t n = q.points;
  Array<double> gap({n}), pressure({n}), increment({n, 2}), stored({n, 2}), elastic({n, 2}),
      axis({n, 3}), normal({n, 3});
  {
    nb::gil_scoped_release free;
    kernel::parallel_for(n, q.threads, [&](std::size_t i) {
      const kernel::PointState old = load(q.state, i);
      Seen s;
      q.batch.see(old, i, s);
      Told told;
      const auto r = kernel::update_pair<false>(h.law, old, s.point, q.dt, nullptr,
                                                kernel::TellingReaction{&told, h.mirrored});
      gap.data[i] = told.gap;
      pressure.data[i] = told.pressure;
      for (std::size_t k = 0; k < 2; ++k) {
        increment.data[2 * i + k] = told.increment[k];
        stored.data[2 * i + k] = told.stored[k];
        elastic.data[2 * i + k] = told.elastic[k];
      }
      put3(axis.data, i, r.friction_axes[0]);
      put3(normal.data, i, r.normal);
    });
  }
  nb::dict d;
  d["gap"] = gap.array;
  d["pressure"] = pressure.array;
  d["increment"] = increment.array;
  d["stored"] = stored.array;
  d["elastic"] = elastic.array;
  d["axis"] = axis.array;
  d["normal"] = normal.array;
  return d;
}

}  // namespace

void bind_facet_framed(nb::module_& m) {
  nb::class_<AnsweredPairs> answered(m, "AnsweredPairs");
  def_questions(answered);
  nb::class_<FramedPairs> framed(m, "FramedPairs");
  framed
      .def(
          "__init__",
          [](FramedPairs* self, const Named& normal, const FieldHandle* directions, bool mirrored,
             bool on_slave) {
            new (self) FramedPairs{{with_axes(normal, directions, on_slave), mirrored}};
          },
          nb::arg("normal"), nb::arg("directions").none(), nb::arg("mirrored"), nb::arg("on_slave"))
      .def(
          "answered",
          [](const FramedPairs& h, const Answers& answers) {
            if (answers.shape(1) != answer_columns)
              throw std::invalid_argument("answers have another number of columns");
            return AnsweredPairs{h, answers};
          },
          nb::arg("answers"));
  def_question(framed, "tell",
               []<bool tangent>(const FramedPairs& h, const Question& q) { return tell(h, q); });
}

}  // namespace anisocontact::bindings
