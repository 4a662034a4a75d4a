#pragma once
// NumPy arrays in and out.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "anisocontact/tensor/dual.hpp"

namespace anisocontact::bindings {

namespace nb = nanobind;

using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Coordinates = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Scalars = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Matrices = nb::ndarray<const double, nb::shape<-1, 2, 2>, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;

/// Memory of arrays that are asked for again and again: it comes back here when the last array on it
/// has gone. Fresh memory costs more than what is written to it. Only with Python's lock held.
class Pool {
 public:
  struct Free {
    void operator()(double* p) const { ::operator delete[](p, line); }
  };
  struct Block {
    std::size_t size;
    std::unique_ptr<double[], Free> data;
  };

  /// A block of at least n numbers, not initialised.
  Block take(std::size_t n) {
    const auto fits =
        std::find_if(free_.begin(), free_.end(), [&](const Block& b) { return b.size >= n; });
    if (fits == free_.end()) return fresh(n);
    Block b = std::move(*fits);
    free_.erase(fits);
    return b;
  }
  void give(Block b) {
    constexpr std::size_t most = 4;
    if (free_.size() == most) free_.erase(free_.begin());
    free_.push_back(std::move(b));
  }

 private:
  static constexpr std::align_val_t line{64};  ///< of the cache, for stores past it

  static Block fresh(std::size_t n) {
    Block b{n, {static_cast<double*>(::operator new[](n * sizeof(double), line)), {}}};
#if defined(MADV_HUGEPAGE)
    // large pages where there is room for them: their addresses are found sooner
    constexpr std::uintptr_t page = std::uintptr_t{1} << 21U;
    const auto begin = reinterpret_cast<std::uintptr_t>(b.data.get());
    const std::uintptr_t first = (begin + page - 1) / page * page,
                         last = (begin + n * sizeof(double)) / page * page;
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
    return b;
  }

  std::vector<Block> free_;
};

/// Entries of a new array that are not set: for results of which every entry is written.
struct Unset {};
inline constexpr Unset unset{};

/// A new NumPy array and the block behind it.
template <class T>
struct Array {
  T* data;
  nb::ndarray<nb::numpy, T> array;

  /// Zeros.
  explicit Array(std::initializer_list<std::size_t> shape)
      : Array(shape, std::make_unique<T[]>(count(shape))) {}
  Array(std::initializer_list<std::size_t> shape, Unset)
      : Array(shape, std::make_unique_for_overwrite<T[]>(count(shape))) {}

  /// Not initialised, in memory of a pool.
  Array(std::initializer_list<std::size_t> shape, const std::shared_ptr<Pool>& pool)
    requires std::is_same_v<T, double>
  {
    struct Loan {
      Pool::Block block;
      std::shared_ptr<Pool> pool;
    };
    std::unique_ptr<Loan> loan(new Loan{pool->take(count(shape)), pool});
    data = loan->block.data.get();
    nb::capsule owner(loan.release(), [](void* p) noexcept {
      const std::unique_ptr<Loan> back(static_cast<Loan*>(p));
      back->pool->give(std::move(back->block));
    });
    array = nb::ndarray<nb::numpy, T>(data, shape.size(), shape.begin(), owner);
  }

 private:
  Array(std::initializer_list<std::size_t> shape, std::unique_ptr<T[]> block) : data(block.get()) {
    nb::capsule owner(block.release(), [](void* p) noexcept { delete[] static_cast<T*>(p); });
    array = nb::ndarray<nb::numpy, T>(data, shape.size(), shape.begin(), owner);
  }
  static std::size_t count(std::initializer_list<std::size_t> shape) {
    std::size_t n = 1;
    for (const auto s : shape) n *= s;
    return n;
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
