// The pair kernel against the same update in dual numbers: tractions, couples, all derivatives and
// trial states of random points on every kind of feature, with every rule, adhesion and friction model,
// with directions on either body, in stick, in slip and at the beginning of contact.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "anisocontact/kernel/core_law.hpp"
#include "dual_pair.hpp"

namespace anisocontact {
namespace {

using kernel::Directions;
using kernel::Feature;
using kernel::Side;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  bool coin() { return (*this)(0.0, 1.0) < 0.5; }
  std::array<double, 2> pair(double size) { return {(*this)(-size, size), (*this)(-size, size)}; }
  Vec3<double> vector(double size) {
    return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)};
  }

 private:
  std::mt19937 engine_;
};

Directions field(Random& r) {
  const Side side = r.coin() ? Side::master : Side::slave;
  const double angle = r(-1.0, 1.0);
  if (r(0.0, 1.0) < 0.1) return {};
  const std::vector<double> axis{-0.7, r(-0.6, -0.4), 0.0, 0.0, 0.1, 1.0};
  const std::array<anisotropy::AnyField, 5> fields{
      anisotropy::Fields::make("constant",
                               Values({{"vector", {1.0, 0.3, 0.1}}, {"angle", {angle}}})),
      anisotropy::Fields::make("oblique", Values({{"vector", {1.0, 0.3, 0.1}},
                                                  {"angle_first", {angle}},
                                                  {"angle_second", {angle + 1.1}}})),
      anisotropy::Fields::make("polar", Values({{"axis", axis}, {"angle", {angle}}})),
      anisotropy::Fields::make("spiral", Values({{"axis", axis}, {"pitch", {4.0 + angle}}})),
      anisotropy::Fields::make(
          "from-vectors", Values({{"first", {1.0, angle, 0.1}}, {"second", {-0.4, 1.0, 0.2}}}))};
  return {fields[static_cast<std::size_t>(r(0.0, 4.999))], side};
}

law::AnyAdhesion adhesion(Random& r) {
  const std::vector<double> k{60.0, 25.0}, time{0.7, 0.4};
  switch (static_cast<int>(r(0.0, 5.0))) {
    case 0:
      return law::AdhesionModels::make("elastic", Values({{"stiffness", k}}));
    case 1:
      return law::AdhesionModels::make("maxwell",
                                       Values({{"stiffness", k}, {"relaxation_time", time}}));
    case 2:
      return law::AdhesionModels::make("kelvin-voigt",
                                       Values({{"stiffness", k}, {"viscosity", time}}));
    case 3:
      return law::AdhesionModels::make(
          "standard-linear-solid",
          Values({{"stiffness", k}, {"stiffness_maxwell", time}, {"relaxation_time", time}}));
    default:
      return law::AdhesionModels::make("general-linear",
                                       Values({{"relaxation", {0.5, 0.1, -0.2, 0.4}},
                                               {"stiffness_instant", {60.0, 5.0, -3.0, 25.0}},
                                               {"stiffness_rate", {1.0, 0.2, 0.1, 2.0}},
                                               {"energy", {1.0}}}));
  }
}

kernel::InterfaceLaw law_of(Random& r, const law::AnyRule& rule, bool sticks) {
  const double mu = sticks ? 50.0 : 0.3;
  const bool two = r.coin();
  return {
      law::NormalLaws::make("kelvin-voigt",
                            Values({{"stiffness", {100.0}}, {"viscosity", {r(0.0, 1.0)}}})),
      adhesion(r),
      field(r),
      two ? law::FrictionModels::make("he-curnier",
                                      Values({{"alpha", {0.7 * mu, 0.4 * mu, 0.2 * mu}}}))
          : law::FrictionModels::make("orthotropic", Values({{"coefficients", {mu, 0.4 * mu}}})),
      field(r),
      two ? field(r) : Directions{},
      rule,
      kernel::EvolutionForms::make(r(0.0, 1.0) < 0.8 ? "transport" : "backward-euler", Values())};
}

/// A bent patch near z = 0, the same in another place when asked again.
surface::Jet<double> patch(Random& r, const Vec3<double>& at) {
  surface::Jet<double> j;
  j.position = at + r.vector(0.01);
  j.d1 = {Vec3<double>(1.0, 0.0, 0.0) + r.vector(0.2), Vec3<double>(0.0, 1.0, 0.0) + r.vector(0.2)};
  j.d2 = {r.vector(0.3), r.vector(0.3), r.vector(0.3)};
  return j;
}

/// A point 0.03 below the patch, in front of what the feature says.
kernel::PairPoint point(Random& r, Feature feature) {
  kernel::PairPoint p;
  p.master.now = patch(r, {0.3, 0.4, 0.0});
  p.master.reference = patch(r, {0.3, 0.4, 0.0});
  p.before = patch(r, {0.31, 0.39, 0.0});
  p.own.now = patch(r, {0.3, 0.4, 0.0});
  p.own.reference = patch(r, {0.3, 0.4, 0.0});
  if (r.coin()) std::swap(p.own.now.d1[0], p.own.now.d1[1]);
  p.master.xi = {r(0.2, 0.8), r(0.2, 0.8)};
  p.facet = 3;
  p.feature = feature;
  const auto n = surface::tangent_plane(p.master.now).normal;
  Vec3<double> away = n;
  if (feature == Feature::edge) {
    p.edge = {1.0, -1.0};
    const Vec3<double> along = p.master.now.d1[0] - p.master.now.d1[1];
    away = (n + 0.3 * n.cross(along)).normalized();
  }
  if (feature == Feature::vertex) away = (n + r.vector(0.2)).normalized();
  p.slave = p.master.now.position - r(0.01, 0.04) * away;
  return p;
}

kernel::PointState history(Random& r) {
  kernel::PointState s;
  s.facet = r(0.0, 1.0) < 0.1 ? -1 : 1;
  s.status = s.facet < 0 || r(0.0, 1.0) < 0.2 ? 0 : 1;
  s.xi = {r(0.2, 0.8), r(0.2, 0.8)};
  s.gap = s.status == 0 ? r(0.0, 0.02) : -0.02;
  if (r(0.0, 1.0) < 0.3) {  // a multiplier holds it where its gap closes
    s.gap = r(0.0, 0.03);
    s.multiplier = r(0.0, 3.0);
  }
  if (s.status == 0) return s;
  s.stored = s.traction = r.pair(0.3);
  s.elastic = r.pair(0.01);
  s.pressure = 2.0;
  s.slip_accumulated = 1.0;
  return s;
}

/// Inclines the slave, up to where it is seen from its side and beyond; directions on it have no image in
/// the contact plane there.
void incline(Random& r, kernel::InterfaceLaw& law, kernel::PairPoint& p) {
  const Eigen::AngleAxisd tilt(r(-1.8, 1.8), (Vec3<double>::UnitX() + r.vector(1.0)).normalized());
  for (auto& d : p.own.now.d1) d = tilt * d;
  for (auto* directions :
       {&law.adhesion_directions, &law.friction_directions, &law.friction_directions_second})
    directions->side = Side::master;
}

/// A committed slave that has turned and stretched since, in any inclination.
void put_slave(Random& r, const kernel::PairPoint& p, kernel::PointState& state) {
  const auto before = surface::tangent_plane(p.before);
  const Eigen::AngleAxisd turn(r(-1.2, 1.2), r.vector(1.0).normalized());
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3<double> old = turn * p.own.now.d1[i] + r.vector(0.1);
    const auto c = before.project_contra(old);
    state.slave[2 * i] = c[0];
    state.slave[2 * i + 1] = c[1];
    state.slave_rise[i] = before.normal.dot(old);
  }
}

/// Committed axes of adhesion that have turned since: those of now by up to 0.6, so that none halfway
/// comes near the other one.
void put_axes(Random& r, const kernel::InterfaceLaw& law, const kernel::PairPoint& p,
              kernel::PointState& state) {
  const auto now = kernel::update_pair<false>(law, kernel::CoreLaw(law), state, p, 0.5);
  const auto before = surface::tangent_plane(p.before);
  const double angle = r(-0.6, 0.6);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3<double>& e = now.adhesion_axes[k];
    const Vec3<double> old = std::cos(angle) * e + std::sin(angle) * now.normal.cross(e);
    const auto c = before.project_contra(old);
    state.axes[2 * k] = c[0];
    state.axes[2 * k + 1] = c[1];
  }
}

/// Largest difference of two lists, and the size of what was compared.
struct Compared {
  double most{0.0}, size{0.0};
  void add(double a, double b) {
    most = std::isnan(a - b) ? INFINITY : std::max(most, std::abs(a - b));
    size = std::max({size, std::abs(a), std::abs(b)});
  }
  double relative() const { return size > 0.0 ? most / size : most; }
};

/// Derivative of what acts by an input.
Eigen::Matrix3d matrix(const kernel::PairSlopes& d, std::size_t acts, std::size_t input) {
  using kernel::PairSlopes;
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < 2; ++a)
    m += d.along_friction[acts][a] * d.friction[a].by[input].vector().transpose();
  if (input >= kernel::Near::inputs) return m;
  for (const std::size_t f : PairSlopes::terms(acts))
    if (f < (d.interior ? PairSlopes::first_beside : PairSlopes::near_forms))
      m += d.along[acts][f] * d.near[f].by[input].vector().transpose();
  return m;
}

double difference(const kernel::PairResult& a, const kernel::PairSlopes& d,
                  const oracle::Result& b) {
  Compared traction, shift, couple;
  std::array<Compared, 3> slopes;
  for (std::size_t q = 0; q < 3; ++q)
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (q == 0) traction.add(a.traction[i], b.traction[i].v);
      if (q > 0) couple.add(a.couple[q - 1][i], b.couple[q - 1][i].v);
      const oracle::S& exact = q == 0 ? b.traction[i] : b.couple[q - 1][i];
      for (std::size_t j = 0; j < oracle::variables; ++j)
        slopes[q].add(matrix(d, q, j / 3)(i, static_cast<Eigen::Index>(j % 3)), exact.d[j]);
    }
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < oracle::variables; ++j) {
      const double mine = j < 12 ? d.near[i].by[j / 3][j % 3] : 0.0;
      shift.add(mine, b.xi[i].d[j]);
    }
  Compared sizes;
  sizes.add(d.size(), matrix(d, 0, kernel::index(kernel::Input::slave)).norm());
  return std::max({traction.relative(), shift.relative(), couple.relative(), slopes[0].relative(),
                   slopes[1].relative(), slopes[2].relative(), sizes.relative()});
}

double difference(const kernel::PointState& a, const kernel::PointState& b) {
  Compared pairs, numbers;
  for (std::size_t i = 0; i < 2; ++i) {
    for (auto field :
         {&kernel::PointState::xi, &kernel::PointState::origin, &kernel::PointState::traction,
          &kernel::PointState::stored, &kernel::PointState::elastic, &kernel::PointState::slip})
      pairs.add((a.*field)[i], (b.*field)[i]);
  }
  for (auto field : {&kernel::PointState::gap, &kernel::PointState::pressure,
                     &kernel::PointState::slip_accumulated, &kernel::PointState::dissipation,
                     &kernel::PointState::dissipation_viscous, &kernel::PointState::energy_adhesion,
                     &kernel::PointState::energy_normal, &kernel::PointState::spin})
    if (!std::isnan(a.*field) || !std::isnan(b.*field))  // neither has an energy
      numbers.add(a.*field, b.*field);
  const bool same = a.status == b.status && a.facet == b.facet;
  return same ? std::max(pairs.relative(), numbers.relative()) : INFINITY;
}

struct Tally {
  double most{0.0};
  std::array<std::size_t, 3> status{};
};

void compare(Random& r, const law::AnyRule& rule, Feature feature, Tally& tally) {
  auto law = law_of(r, rule, r(0.0, 1.0) < 0.3);
  auto state = history(r);
  auto p = point(r, feature);
  if (r.coin()) incline(r, law, p);
  if (state.status != 0 && r(0.0, 1.0) < 0.7) put_slave(r, p, state);
  if (state.status != 0 && r.coin()) put_axes(r, law, p, state);
  kernel::PairSlopes by;
  const auto fast = kernel::update_pair<true>(law, kernel::CoreLaw(law), state, p, 0.5, &by);
  const auto slow = oracle::update(law, state, p, 0.5);
  const auto plain = kernel::update_pair<false>(law, kernel::CoreLaw(law), state, p, 0.5);
  if (fast.failure != slow.failure) {
    tally.most = INFINITY;
    return;
  }
  if (slow.failure != kernel::Failure::none) return;
  ++tally.status[static_cast<std::size_t>(fast.state.status)];
  tally.most = std::max(tally.most, difference(fast.state, slow.state));
  tally.most = std::max(tally.most, difference(plain.state, slow.state));
  if (fast.state.status != 0) tally.most = std::max(tally.most, difference(fast, by, slow));
}

std::vector<law::AnyRule> rules() {
  std::vector<law::AnyRule> all{law::MaximumDissipation{}, law::Radial{}, law::LinearRule{},
                                law::Coaxial{}};
  using History = law::Explicit::History;
  for (const auto h : {History::centre, History::incremental, History::kuhn_tucker})
    all.emplace_back(law::Explicit(h));
  all.push_back(law::SlidingRules::make(
      "slip-ellipse", Values({{"slip_axes", {2.0, 1.0}}, {"slip_angle", {0.3}}})));
  return all;
}

}  // namespace
}  // namespace anisocontact

int main() {
  using namespace anisocontact;
  constexpr double allowed = 1e-12;
  Random r(1);
  bool good = true;
  for (const auto feature : {Feature::interior, Feature::edge, Feature::vertex})
    for (const auto& rule : rules()) {
      Tally tally;
      for (int i = 0; i < 400; ++i) compare(r, rule, feature, tally);
      const bool fine = tally.most < allowed && tally.status[1] > 20 && tally.status[2] > 20;
      good = good && fine;
      std::printf("feature %d, rule %zu: %.1e relative, %zu open, %zu stick, %zu slip\n",
                  static_cast<int>(feature), rule.index(), tally.most, tally.status[0],
                  tally.status[1], tally.status[2]);
    }
  return good ? 0 : 1;
}
