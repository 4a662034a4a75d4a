// Lanes of a compiler without vectors: the numbers are those of memory, in registers that follow each
// other and in registers that are apart, and nothing beyond them is read or written.

#define ANISOCONTACT_NO_VECTORS

#include <cmath>
#include <cstdio>
#include <vector>

#include "anisocontact/mortar/lanes.hpp"
#include "anisocontact/tensor/padded.hpp"

namespace anisocontact {
namespace {

/// Numbers 1, 2, ..., which doubles have exactly, as all results below: they are compared as such.
std::vector<double> counted(std::size_t n) {
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = static_cast<double>(i + 1);
  return x;
}

template <std::size_t L>
bool reads_and_writes(std::size_t stride) {
  const std::size_t size = (L / 4 - 1) * stride + 4;
  const std::vector<double> x = counted(size);
  const auto lanes = Lanes<L>::from(x.data(), stride);
  std::vector<double> back(size, 0.0);
  lanes.to(back.data(), stride);
  bool right = true;
  for (std::size_t i = 0; i < size; ++i)
    right = right && std::abs(back[i] - (i % stride < 4 ? x[i] : 0.0)) == 0.0;
  for (std::size_t l = 0; l < L; ++l)
    right = right && std::abs(lanes[l] - x[l / 4 * stride + l % 4]) == 0.0;
  return right;
}

bool takes_four() {
  const auto x = Lanes<4>::of(1.0, 4.0, 9.0, 16.0), roots = sqrt(x);
  bool right = true;
  for (std::size_t l = 0; l < 4; ++l) {
    const double root = static_cast<double>(l + 1);
    right = right && std::abs(x[l] - root * root) == 0.0 && std::abs(roots[l] - root) == 0.0;
  }
  return right;
}

/// Vectors one after the other: each one's zero is where the next begins, the last one's is behind it.
bool padded_ends_with_zero() {
  const Padded u = Vec3<double>(1.0, 2.0, 3.0), v = Vec3<double>(8.0, 4.0, 2.0);
  Padded sum = 2.0 * u - v;
  sum.add(3.0, u);
  sum += -u;
  std::array<double, 7> x;
  x.fill(-1.0);
  u.to(x.data());
  sum.to(x.data() + 3);
  const std::array<double, 7> right{1.0, 2.0, 3.0, -4.0, 4.0, 10.0, 0.0};
  return x == right && sum.vector() == Vec3<double>(sum[0], sum[1], sum[2]);
}

bool twins_have_parts() {
  mortar::Twins<8> both;
  const std::vector<double> x = counted(8);
  both.add_part(1, Lanes<8>::from(x.data()));
  bool right = true;
  for (std::size_t l = 0; l < 8; ++l)
    right = right && std::abs(both.part(1)[l] - x[l]) == 0.0 && std::abs(both.part(0)[l]) == 0.0;
  return right;
}

}  // namespace
}  // namespace anisocontact

int main() {
  using namespace anisocontact;
  const bool right = reads_and_writes<4>(4) && reads_and_writes<8>(4) && reads_and_writes<12>(8) &&
                     takes_four() && padded_ends_with_zero() && twins_have_parts();
  std::puts(right ? "lanes without vectors: passed" : "lanes without vectors: FAILED");
  return right ? 0 : 1;
}
