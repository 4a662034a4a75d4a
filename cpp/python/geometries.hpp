#pragma once
// Jets and geometries of a batch of points, of whatever kind of surface.

#include "anisocontact/surface/geometry.hpp"
#include "arrays.hpp"

namespace anisocontact::bindings {

template <class M>
void put4(double* p, std::size_t i, const M& m) {
  for (std::size_t k = 0; k < 4; ++k) p[4 * i + k] = m(k / 2, k % 2);
}

/// `jet_at(i)` is the jet at point i.
template <class JetAt>
nb::dict jets(std::size_t n, const JetAt& jet_at) {
  Array<double> position({n, 3}), d1({n, 2, 3}), d2({n, 3, 3});
  for (std::size_t i = 0; i < n; ++i) {
    const auto j = jet_at(i);
    put3(position.data, i, j.position);
    for (std::size_t k = 0; k < 2; ++k) put3(d1.data, 2 * i + k, j.d1[k]);
    for (std::size_t k = 0; k < 3; ++k) put3(d2.data, 3 * i + k, j.d2[k]);
  }
  nb::dict r;
  r["position"] = position.array;
  r["d1"] = d1.array;
  r["d2"] = d2.array;
  return r;
}

template <class JetAt>
nb::dict geometries(std::size_t n, const JetAt& jet_at) {
  Array<double> a_co({n, 2, 2}), a_contra({n, 2, 2}), area({n}), normal({n, 3}), h_co({n, 2, 2}),
      h_mixed({n, 2, 2}), christoffel({n, 2, 2, 2});
  for (std::size_t i = 0; i < n; ++i) {
    const auto g = surface::geometry(jet_at(i));
    put4(a_co.data, i, g.a_co);
    put4(a_contra.data, i, g.a_contra);
    area.data[i] = g.area;
    put3(normal.data, i, g.normal);
    put4(h_co.data, i, g.h_co);
    put4(h_mixed.data, i, g.h_mixed);
    for (std::size_t k = 0; k < 2; ++k) put4(christoffel.data, 2 * i + k, g.christoffel[k]);
  }
  nb::dict r;
  r["a_co"] = a_co.array;
  r["a_contra"] = a_contra.array;
  r["area"] = area.array;
  r["normal"] = normal.array;
  r["h_co"] = h_co.array;
  r["h_mixed"] = h_mixed.array;
  r["christoffel"] = christoffel.array;
  return r;
}

}  // namespace anisocontact::bindings
