#pragma once
// NumPy arrays in and out.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::bindings {

namespace nb = nanobind;

using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Coordinates = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Scalars = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Matrices = nb::ndarray<const double, nb::shape<-1, 2, 2>, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;

/// A new NumPy array and the block behind it.
template <class T>
struct Array {
  T* data;
  nb::ndarray<nb::numpy, T> array;

  explicit Array(std::initializer_list<std::size_t> shape) {
    std::size_t n = 1;
    for (const auto s : shape) n *= s;
    auto block = std::make_unique<T[]>(n);
    data = block.get();
    nb::capsule owner(block.release(), [](void* p) noexcept { delete[] static_cast<T*>(p); });
    array = nb::ndarray<nb::numpy, T>(data, shape.size(), shape.begin(), owner);
  }
};

inline Vec3<double> row3(const double* p, std::size_t i) {
  return {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
}

inline void put3(double* p, std::size_t i, const Vec3<double>& v) {
  for (std::size_t k = 0; k < 3; ++k) p[3 * i + k] = v[static_cast<Eigen::Index>(k)];
}

inline void put9(double* p, std::size_t i, const Eigen::Matrix3d& m) {
  for (Eigen::Index k = 0; k < 9; ++k) p[9 * i + static_cast<std::size_t>(k)] = m(k / 3, k % 3);
}

}  // namespace anisocontact::bindings
