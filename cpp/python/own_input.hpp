#pragma once
// The surface of the slave at the points of a batch.

#include <nanobind/ndarray.h>

#include "anisocontact/kernel/carried.hpp"
#include "arrays.hpp"
#include "bindings.hpp"

namespace anisocontact::bindings {

using Tangents = nb::ndarray<const double, nb::shape<-1, 2, 3>, nb::c_contig, nb::device::cpu>;

/// The surface of the slave: positions in the reference configuration, tangents there and
/// now. Without rows there are points alone.
struct OwnInput {
  Points reference;
  Tangents reference_tangents, tangents;

  bool given() const { return reference.shape(0) > 0; }
  kernel::Carrier at(std::size_t i) const {
    kernel::Carrier c;
    if (!given()) return c;
    c.reference.position = row3(reference.data(), i);
    for (std::size_t k = 0; k < 2; ++k) {
      c.reference.d1[k] = row3(reference_tangents.data(), 2 * i + k);
      c.now.d1[k] = row3(tangents.data(), 2 * i + k);
    }
    return c;
  }
};

}  // namespace anisocontact::bindings
