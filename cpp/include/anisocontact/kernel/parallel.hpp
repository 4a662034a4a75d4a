#pragma once
// Batches of points over threads.

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace anisocontact::kernel {

/// Calls f(first, last) for pieces of [0, n), one a thread. Small ranges stay on the calling thread,
/// where starting another would cost more than it saves.
template <class F>
void parallel_pieces(std::size_t n, std::size_t threads, const F& f) {
  constexpr std::size_t least_per_thread = 256;
  const std::size_t used = std::max<std::size_t>(1, std::min(threads, n / least_per_thread));
  const auto run = [&](std::size_t part) { f(n * part / used, n * (part + 1) / used); };
  std::vector<std::thread> pool;
  pool.reserve(used - 1);
  for (std::size_t part = 1; part < used; ++part) pool.emplace_back(run, part);
  run(0);
  for (auto& t : pool) t.join();
}

/// Calls f(i) for i in [0, n), the range cut into one piece a thread.
template <class F>
void parallel_for(std::size_t n, std::size_t threads, const F& f) {
  parallel_pieces(n, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) f(i);
  });
}

}  // namespace anisocontact::kernel
