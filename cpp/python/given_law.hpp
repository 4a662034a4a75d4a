#pragma once
// Laws of a batch: those of the core, or the outputs of one that is not in it.

#include <nanobind/stl/optional.h>

#include <cstring>
#include <optional>
#include <stdexcept>

#include "anisocontact/kernel/core_law.hpp"
#include "anisocontact/kernel/given_law.hpp"
#include "arrays.hpp"

namespace anisocontact::bindings {

using Table = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;

/// Adhesion and friction of the core, or the law whose output has a row for each point.
class BatchLaw {
 public:
  BatchLaw(const kernel::InterfaceLaw& law, const std::optional<Table>& outputs, std::size_t n)
      : core_(law), outputs_(outputs ? outputs->data() : nullptr) {
    if (outputs && (outputs->shape(0) != n || outputs->shape(1) != columns))
      throw std::invalid_argument("outputs of a law do not belong to these points");
  }

  /// Calls `update` with the law of point i.
  template <class Update>
  auto at(std::size_t i, const Update& update) const {
    if (outputs_ == nullptr) return update(core_);
    kernel::LawOutput output;
    std::memcpy(&output, outputs_ + i * columns, sizeof(output));
    auto r = update(kernel::GivenLaw(output));
    if (r.state.status == 0 || r.failure != kernel::Failure::none) return r;
    r.friction_axes[1] = r.normal.cross(r.friction_axes[0]);
    r.adhesion_axes = r.friction_axes;
    return r;
  }

 private:
  static constexpr std::size_t columns = sizeof(kernel::LawOutput) / sizeof(double);

  kernel::CoreLaw core_;
  const double* outputs_;
};

/// The law inputs of a batch.
struct LawInputs {
  Array<double> gap, pressure, xi, increment, stored, elastic;

  explicit LawInputs(std::size_t n)
      : gap({n}), pressure({n}), xi({n, 2}), increment({n, 2}), stored({n, 2}), elastic({n, 2}) {}

  void put(std::size_t i, const kernel::LawInput& input, const kernel::PointState& at) const {
    gap.data[i] = input.gap;
    pressure.data[i] = input.pressure;
    for (std::size_t k = 0; k < 2; ++k) {
      xi.data[2 * i + k] = at.xi[k];
      increment.data[2 * i + k] = input.increment[k];
      stored.data[2 * i + k] = input.stored[k];
      elastic.data[2 * i + k] = input.elastic[k];
    }
  }
  nb::dict result() const {
    nb::dict d;
    d["gap"] = gap.array;
    d["pressure"] = pressure.array;
    d["xi"] = xi.array;
    d["increment"] = increment.array;
    d["stored"] = stored.array;
    d["elastic"] = elastic.array;
    return d;
  }
};

}  // namespace anisocontact::bindings
