// The hot path takes no memory: malloc is counted while points are updated through every sliding
// rule on plane and curved surfaces, with and without tangent.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "anisocontact/kernel/core_law.hpp"
#include "anisocontact/kernel/point.hpp"

namespace {
std::size_t taken = 0;
}

// glibc's own allocator under our counter; operator new and Eigen end up here, too.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void* malloc(std::size_t n) { return ++taken, __libc_malloc(n); }
void* calloc(std::size_t n, std::size_t m) { return ++taken, __libc_calloc(n, m); }
void* realloc(void* p, std::size_t n) { return ++taken, __libc_realloc(p, n); }
void* aligned_alloc(std::size_t a, std::size_t n) { return ++taken, __libc_memalign(a, n); }
}

namespace anisocontact {
namespace {

using kernel::Contact;

kernel::Interface interface(const char* shape, const Values& values, const law::AnyRule& rule) {
  const auto directions = [](double angle) {
    return kernel::Directions{anisotropy::Fields::make(
        "constant", Values({{"vector", {1.0, 0.2, 0.1}}, {"angle", {angle}}}))};
  };
  return {surface::Surfaces::make(shape, values),
          {law::NormalLaws::make("penalty", Values({{"penalty", {1e3}}})),
           law::AdhesionModels::make("elastic", Values({{"stiffness", {4e2, 1e2}}})),
           directions(0.3),
           law::FrictionModels::make("orthotropic", Values({{"coefficients", {0.4, 0.2}}})),
           directions(-0.2),
           {},
           rule}};
}

/// A walk over the surface z ~ 0 that is open, sticks and slips; `seen` counts each.
template <bool tangent>
void walk(const kernel::Interface& itf, std::size_t seen[3]) {
  auto failure = kernel::Failure::none;
  kernel::PointState state = kernel::initial_state(itf.surface, {0.0, 0.0, -1e-3}, failure);
  for (int k = 0; k < 400; ++k) {
    const double s = 1e-4 * k, gap = k % 50 < 5 ? 1e-3 : -2e-3 * (1.0 + 0.5 * std::sin(0.1 * k));
    const double u = s * std::cos(0.01 * k), v = s * std::sin(0.01 * k);
    const Vec3<double> foot(u, v, 0.0);
    const auto p = projection::closest_point(itf.surface, foot);
    const auto g = surface::geometry(surface::jet(itf.surface, p.xi[0], p.xi[1]));
    const auto r = kernel::update<tangent>(itf, kernel::CoreLaw(itf.law), state,
                                           g.jet.position + gap * g.normal, nullptr, 1.0);
    if (r.failure != kernel::Failure::none) std::abort();
    state = r.state;
    ++seen[state.status];
  }
}

/// Number of allocations, or a complaint that the walk did not see every status.
std::size_t count(const kernel::Interface& itf) {
  std::size_t seen[3] = {0, 0, 0};
  const std::size_t before = taken;
  walk<false>(itf, seen);
  walk<true>(itf, seen);
  const std::size_t after = taken;
  if (seen[0] == 0 || seen[1] == 0 || seen[2] == 0) {
    std::printf("the walk was open %zu, stuck %zu and slid %zu times\n", seen[0], seen[1], seen[2]);
    std::exit(2);
  }
  return after - before;
}

template <std::size_t... I>
std::size_t every_rule(const char* shape, const Values& values, std::index_sequence<I...>) {
  return (count(interface(shape, values, std::variant_alternative_t<I, law::AnyRule>{})) + ...);
}

std::size_t every_surface() {
  constexpr auto rules = std::make_index_sequence<std::variant_size_v<law::AnyRule>>{};
  const std::vector<double> none{0.0, 0.0, 0.0};
  const std::pair<const char*, Values> shapes[] = {
      {"plane", Values({{"point", none}, {"normal", {0.0, 0.0, 1.0}}, {"tangent", none}})},
      {"cylinder", Values({{"point", {0.0, 0.0, -2.0}},
                           {"axis", {0.0, 1.0, 0.0}},
                           {"radius", {2.0}},
                           {"start", none},
                           {"inside", {0.0}}})},
      {"sphere", Values({{"centre", {0.0, 0.0, -1.5}},
                         {"radius", {1.5}},
                         {"axis", {1.0, 0.0, 0.0}},
                         {"start", none},
                         {"inside", {0.0}}})},
      {"ellipsoid", Values({{"centre", {0.0, 0.0, -1.0}},
                            {"semi_axes", {2.0, 1.5, 1.0}},
                            {"axis", {1.0, 0.0, 0.0}},
                            {"start", none},
                            {"inside", {0.0}}})},
  };
  std::size_t n = 0;
  for (const auto& [shape, values] : shapes) n += every_rule(shape, values, rules);
  return n;
}

}  // namespace
}  // namespace anisocontact

int main() {
  const std::size_t before = taken;
  std::vector<double>* probe = new std::vector<double>(1000);
  delete probe;
  if (taken < before + 2) {
    std::printf("the counter does not count\n");
    return 2;
  }
  const std::size_t n = anisocontact::every_surface();
  std::printf("%zu allocations in the hot path\n", n);
  return n == 0 ? 0 : 1;
}
