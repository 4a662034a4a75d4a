// Closest points, search, updates and assembly on random input, for the sanitizers: nothing is
// checked here but that every number is where it should be, so the answers of the tests of Python
// need no repetition.

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "anisocontact/kernel/core_law.hpp"
#include "anisocontact/kernel/facet_assembly.hpp"
#include "anisocontact/kernel/point.hpp"
#include "anisocontact/search/facet_surface.hpp"

namespace anisocontact {
namespace {

using surface::Topology;

class Random {
 public:
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vec3<double> vector(double size) {
    return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)};
  }

 private:
  std::mt19937 engine_{7};
};

/// A bumpy sheet of facets of one kind on a grid of cells.
struct Sheet {
  std::vector<Vec3<double>> points;
  std::vector<surface::FacetKind> kinds;
  std::vector<std::int32_t> nodes;
};

Sheet sheet(Random& r, Topology t, std::int32_t cells) {
  const bool first = t == Topology::tri3 || t == Topology::quad4;
  const std::int32_t step = first ? 1 : 2, m = step * cells + 1;
  Sheet s;
  for (std::int32_t i = 0; i < m * m; ++i)
    s.points.push_back(Vec3<double>(i % m, i / m, 0.0) + r.vector(0.1));
  using Corners = std::vector<std::array<std::int32_t, 2>>;
  const Corners square{{0, 0}, {2, 0}, {0, 2}, {2, 2}, {1, 0}, {0, 1}, {2, 1}, {1, 2}, {1, 1}};
  const Corners lower{{0, 0}, {2, 0}, {0, 2}, {1, 1}, {0, 1}, {1, 0}};
  const Corners upper{{2, 2}, {0, 2}, {2, 0}, {1, 1}, {2, 1}, {1, 2}};
  const auto add = [&](const Corners& corners, std::int32_t i, std::int32_t j) {
    s.kinds.push_back({t, r(0.0, 1.0) < 0.2});
    for (std::size_t k = 0; k < surface::node_count(t); ++k) {
      const std::int32_t u = first ? corners[k][0] / 2 : corners[k][0],
                         v = first ? corners[k][1] / 2 : corners[k][1];
      s.nodes.push_back((step * j + v) * m + step * i + u);
    }
  };
  for (std::int32_t j = 0; j < cells; ++j)
    for (std::int32_t i = 0; i < cells; ++i) {
      if (!surface::triangular(t)) add(square, i, j);
      if (surface::triangular(t)) add(lower, i, j), add(upper, i, j);
    }
  return s;
}

kernel::NodalShape nodal(const surface::FacetKind& kind, const std::array<double, 2>& xi) {
  kernel::NodalShape n;
  n.count = kind.nodes();
  surface::shape(kind, xi[0], xi[1], n);
  return n;
}

kernel::InterfaceLaw law(double angle) {
  const auto field = [&](kernel::Side side) {
    return kernel::Directions{
        anisotropy::Fields::make("constant",
                                 Values({{"vector", {1.0, 0.2, 0.1}}, {"angle", {angle}}})),
        side};
  };
  return {law::NormalLaws::make("penalty", Values({{"penalty", {1e3}}})),
          law::AdhesionModels::make("elastic", Values({{"stiffness", {4e2, 1e2}}})),
          field(kernel::Side::slave),
          law::FrictionModels::make("he-curnier", Values({{"alpha", {0.3, 0.2, -0.1}}})),
          field(kernel::Side::master),
          field(kernel::Side::slave),
          law::MaximumDissipation{}};
}

/// Projects a point, updates it against the facet it hits and sums up its tangent.
std::size_t meet(const search::FacetSurface& s, const Vec3<double>& x,
                 const kernel::InterfaceLaw& l, search::Query& q, kernel::PointState& state) {
  const auto hit = s.closest(x, q);
  q.hint = hit.facet;
  if (hit.facet < 0) return 0;
  q.start = hit.xi;
  kernel::PairPoint p;
  p.slave = x;
  p.facet = hit.facet;
  p.feature = hit.status == search::Status::on
                  ? static_cast<kernel::Feature>(static_cast<std::int8_t>(hit.feature))
                  : kernel::Feature::off;
  p.edge = hit.edge;
  const auto jet = s.jet(hit.facet, hit.xi);
  p.master = {jet, jet, hit.xi};
  p.own = {jet, jet, {}};
  kernel::PairShapes shapes;
  shapes.slave = shapes.master = nodal(s.kind(hit.facet), hit.xi);
  shapes.area = {0.3, true, jet.d1};
  if (state.facet >= 0) {
    const auto f = static_cast<std::int32_t>(state.facet);
    p.before = s.jet(f, state.xi);
    shapes.before = nodal(s.kind(f), state.xi);
  }
  kernel::PairSlopes by;
  const auto r = kernel::update_pair<true>(l, kernel::CoreLaw(l), state, p, 1.0, &by);
  const std::size_t size = 3 * 2 * shapes.slave.count, half = size / 2;
  std::vector<double> own(size * size), earlier(size * half), residual(size);
  const bool apart = state.facet >= 0 && state.facet != hit.facet;
  if (r.state.status != 0 && r.failure == kernel::Failure::none) {
    kernel::add_residual(r, shapes, residual.data());
    kernel::add_tangent(r, by, shapes, {own.data(), true},
                        {apart ? earlier.data() : nullptr, true});
  }
  state = r.state;
  return state.status != 0 ? 1 : 0;
}

std::size_t facets(Random& r, Topology t) {
  Sheet s = sheet(r, t, 6);
  const double side = t == Topology::tri3 || t == Topology::quad4 ? 6.0 : 12.0;
  search::FacetSurface surface(s.points, s.kinds, s.nodes);
  const auto l = law(0.4);
  std::size_t touched = 0;
  for (int point = 0; point < 200; ++point) {
    search::Query q;
    if (point % 3 == 0) q.limit = 0.5;
    kernel::PointState state;
    Vec3<double> x(r(-0.5, side), r(-0.5, side), r(-0.3, 0.1));
    for (int k = 0; k < 5; ++k) {
      touched += meet(surface, x, l, q, state);
      x += r.vector(0.3);
    }
  }
  for (auto& x : s.points) x += r.vector(0.05);
  surface.update(s.points);
  for (int point = 0; point < 50; ++point)
    touched += surface.within(r.vector(side), 1.0).size() > 1000 ? 1 : 0;
  return touched;
}

std::size_t analytic(Random& r, const char* shape, const Values& values) {
  const kernel::Interface itf{surface::Surfaces::make(shape, values), law(0.2)};
  std::size_t touched = 0;
  for (int point = 0; point < 300; ++point) {
    auto failure = kernel::Failure::none;
    Vec3<double> x = r.vector(2.0);
    auto state = kernel::initial_state(itf.surface, x, failure);
    if (failure != kernel::Failure::none) continue;
    kernel::Carrier own;
    own.now.d1 = own.reference.d1 = {Vec3<double>(1.0, 0.1, 0.0), Vec3<double>(0.2, 1.0, 0.3)};
    own.now.position = own.reference.position = x;
    for (int k = 0; k < 5; ++k) {
      x += r.vector(0.05);
      const auto a = kernel::update<true>(itf, kernel::CoreLaw(itf.law), state, x, &own, 1.0);
      const auto b = kernel::update<false>(itf, kernel::CoreLaw(itf.law), state, x, nullptr, 1.0);
      touched += b.state.status != 0 ? 1 : 0;
      state = a.state;
    }
  }
  return touched;
}

}  // namespace
}  // namespace anisocontact

int main() {
  using namespace anisocontact;
  Random r;
  bool good = true;
  const auto say = [&](const std::string& what, std::size_t touched) {
    std::printf("%s: %zu updates in contact\n", what.c_str(), touched);
    good = good && touched > 0;
  };
  for (std::size_t t = 0; t < surface::topology_names.size(); ++t)
    say(std::string(surface::topology_names[t]), facets(r, static_cast<Topology>(t)));
  const std::vector<double> none{0.0, 0.0, 0.0};
  const std::vector<double> up{0.0, 0.0, 1.0};
  say("plane", analytic(r, "plane", Values({{"point", none}, {"normal", up}, {"tangent", none}})));
  say("sphere", analytic(r, "sphere",
                         Values({{"centre", none},
                                 {"radius", {1.5}},
                                 {"axis", up},
                                 {"start", none},
                                 {"inside", {0.0}}})));
  say("ellipsoid", analytic(r, "ellipsoid",
                            Values({{"centre", none},
                                    {"semi_axes", {2.0, 1.5, 1.0}},
                                    {"axis", up},
                                    {"start", none},
                                    {"inside", {0.0}}})));
  return good ? 0 : 1;
}
