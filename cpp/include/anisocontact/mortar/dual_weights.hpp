#pragma once
// Mortar weights of one slave facet: dual functions psi_i of its covered part,
//   integral of psi_i N_j = delta_ij integral of N_j   [Wohlmuth 2000],
// biorthogonal on what the master covers [Cichosz Bischoff 2011], and with them
//   D_i = integral of N_i,   W_ik = integral of psi_i M_k = D_i (m^-1 c)_ik .
// Where hardly anything of a node is covered, psi_i is added to those of the others, see `hand_over`.

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

#include "anisocontact/mortar/facet_weights.hpp"
#include "anisocontact/mortar/hand_over.hpp"
#include "anisocontact/mortar/integrator.hpp"
#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::mortar {

namespace detail {

using Eigen::Index;

/// The inverse of m, column by column; whether there is one. Rows and columns are scaled to a diagonal
/// of one, so that the size of what is covered does not matter, and no row has to change places.
template <std::size_t L>
ANISOCONTACT_ONCE bool invert(const Integrals<L>& in, std::size_t n, std::array<Lanes<L>, L>& out) {
  constexpr double least = 1e-13;
  std::array<double, L> unit{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!(in.value[i][i] > 0.0)) return false;
    unit[i] = 1.0 / std::sqrt(in.value[i][i]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out[i].set(j, unit[i] * unit[j] * in.value[j][i]);
  for (std::size_t k = 0; k < n; ++k) {
    const double pivot = out[k][k];
    if (!(pivot > least)) return false;
    out[k].set(k, 1.0);
    out[k] = (1.0 / pivot) * out[k];
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double share = out[i][k];
      out[i].set(k, 0.0);
      out[i].add(-share, out[k]);
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out[i].set(j, unit[i] * unit[j] * out[i][j]);
  return true;
}

/// A matrix of columns side by side, times x.
template <std::size_t L>
ANISOCONTACT_INLINE Lanes<L> times(const std::array<Lanes<L>, L>& m, const Lanes<L>& x) {
  Lanes<L> product;
  each<L>([&](std::size_t j) ANISOCONTACT_INLINE_LAMBDA { product.add(x[j], m[j]); });
  return product;
}

/// Derivatives of W = D z, z = m^-1 c, where P = D m^-1: dW = P (dc - dm z) + z dD. `memory` is for P dm and
/// dD.
template <std::size_t L>
ANISOCONTACT_INLINE void put_slopes(const Integrals<L>& in, std::size_t n,
                                    const std::array<Lanes<L>, L>& p,
                                    const std::vector<Lanes<L>>& z, std::vector<Lanes<L>>& memory,
                                    DualWeights& out) {
  const std::size_t count = in.rows - n, columns = in.columns;
  out.d_area.resize(static_cast<Index>(n), static_cast<Index>(columns));
  out.d_weight.resize(static_cast<Index>(n * count), static_cast<Index>(columns));
  memory.resize((L + 1) * columns);  // functions that are not there give zero
  for (std::size_t c = 0; c < columns; ++c) {
    Lanes<L> grown;
    for (std::size_t j = 0; j < L; ++j) {
      const Lanes<L> slope = j < n ? in.slope[j * columns + c] : Lanes<L>();
      grown.add(1.0, slope);
      memory[(L + 1) * c + j] = times(p, slope);
    }
    memory[(L + 1) * c + L] = grown;
    for (std::size_t i = 0; i < n; ++i) out.d_area.data()[i * columns + c] = grown[i];
  }
  for (std::size_t k = 0; k < count; ++k) {
    double* const to = out.d_weight.data() + k * columns;
    const Lanes<L> own = z[k], minus = -own;
    for (std::size_t c = 0; c < columns; ++c) {
      const Lanes<L>* const moved = memory.data() + (L + 1) * c;
      Lanes<L> slope = times(p, in.slope[(n + k) * columns + c]) + own * moved[L];
      each<L>([&](std::size_t j) ANISOCONTACT_INLINE_LAMBDA { slope.add(minus[j], moved[j]); });
      for (std::size_t i = 0; i < n; ++i) to[i * count * columns + c] = slope[i];
    }
  }
}

/// W = D m^-1 c with its derivatives; whether m can be inverted.
template <std::size_t L>
ANISOCONTACT_INLINE bool put_weights(const Integrals<L>& in, std::size_t n,
                                     std::vector<Lanes<L>>& z, std::vector<Lanes<L>>& memory,
                                     DualWeights& out) {
  const std::size_t count = in.rows - n;
  std::array<Lanes<L>, L> inverse;  // zero from n on
  if (!invert(in, n, inverse)) return false;
  Lanes<L> area;
  for (std::size_t j = 0; j < n; ++j) area.add(1.0, in.value[j]);
  z.resize(count);
  out.area.resize(static_cast<Index>(n));
  out.weight.resize(static_cast<Index>(n), static_cast<Index>(count));
  // On a part near a corner functions are close to dependent: a second step takes what the inverse has lost.
  for (std::size_t k = 0; k < count; ++k) {
    z[k] = times(inverse, in.value[n + k]);
    Lanes<L> left = in.value[n + k];
    for (std::size_t j = 0; j < n; ++j) left.add(-z[k][j], in.value[j]);
    z[k].add(1.0, times(inverse, left));
  }
  for (std::size_t i = 0; i < n; ++i) {
    out.area[static_cast<Index>(i)] = area[i];
    for (std::size_t k = 0; k < count; ++k) out.weight.data()[i * count + k] = area[i] * z[k][i];
  }
  if (in.slope.empty()) return true;
  for (Lanes<L>& one : inverse) one = area * one;
  put_slopes(in, n, inverse, z, memory, out);
  return true;
}

}  // namespace detail

/// What the weights of facets are found from.
struct MortarInput {
  Facets slave, master;
  const double *now,
      *reference;  ///< positions of the nodes; no reference where areas are those of now
  Rules rules;
  std::span<const double>
      whole;  ///< weights of a facet all of which is covered; none: see `hand_over`
  bool slopes;
};

/// What weights are found in; it keeps its memory from one facet to the next.
class WeightMemory {
 public:
  template <std::size_t L>
  struct Of {
    Integrals<L> total;
    IntegratorMemory<L> integrator;
    std::vector<Lanes<L>> solved, moved;
  };
  template <std::size_t L>
  Of<L>& of() {
    return std::get<Of<L>>(of_);
  }
  std::vector<SlavePart> parts;
  std::vector<Overlap> found;

 private:
  std::tuple<Of<4>, Of<8>, Of<12>> of_;
};

namespace detail {

/// Overlaps of a slave facet with facets of the master; none where it has no plane.
inline void find_overlaps(const MortarInput& in, const Facet& slave, std::size_t f,
                          std::span<const std::int32_t> candidates, WeightMemory& memory) {
  memory.parts.clear();
  memory.found.clear();
  const auto sub = sub_facets(slave.topology);
  memory.parts.reserve(sub.size());
  for (const SubFacet& part : sub) {
    SlavePart& own = memory.parts.emplace_back(slave, part);
    if (!own.valid()) return memory.found.clear();
    if (in.reference != nullptr) own.scale_to(in.slave.at(f, in.reference));
    for (const std::int32_t c : candidates) {
      const auto g = static_cast<std::size_t>(c);
      own.find(in.master.at(g, in.now), g, memory.found);
    }
  }
}

}  // namespace detail

/// Weights of a slave facet against facets of the master; none where nothing is covered.
inline void dual_weights(const MortarInput& in, std::size_t f,
                         std::span<const std::int32_t> candidates, WeightMemory& memory,
                         DualWeights& out) {
  const Facet slave = in.slave.at(f, in.now);
  detail::find_overlaps(in, slave, f, candidates, memory);
  out.masters.clear();
  out.own.resize(0, 0);
  out.masters.reserve(memory.found.size() * in.master.width());
  for (const Overlap& o : memory.found)
    for (std::size_t a = 0; a < in.master.width(); ++a)
      out.masters.push_back(in.master.node(o.facet, a));
  std::sort(out.masters.begin(), out.masters.end());
  out.masters.erase(std::unique(out.masters.begin(), out.masters.end()), out.masters.end());
  if (memory.found.empty()) return;
  const SubFacet* const first = sub_facets(slave.topology).data();
  const bool any = with_lanes(slave.nodes(), [&](auto lanes) {
    auto& own = memory.of<lanes>();
    own.total.begin(slave.nodes(), out.masters.size(), in.slopes);
    Integrator<lanes> integrator(slave, in.rules, own.integrator, own.total);
    bool good = false;
    with_longest([&]() ANISOCONTACT_INLINE_LAMBDA {
      for (const Overlap& o : memory.found) {
        std::array<std::size_t, most> column{};
        for (std::size_t a = 0; a < in.master.width(); ++a)
          column[a] =
              3 * (slave.nodes() +
                   static_cast<std::size_t>(std::lower_bound(out.masters.begin(), out.masters.end(),
                                                             in.master.node(o.facet, a)) -
                                            out.masters.begin()));
        integrator.add(memory.parts[static_cast<std::size_t>(o.slave - first)], o,
                       in.master.at(o.facet, in.now), column);
      }
      good = detail::put_weights(own.total, slave.nodes(), own.solved, own.moved, out);
    });
    return good;
  });
  if (!any) return out.masters.clear();
  if (!in.whole.empty()) detail::hand_over(in.whole, in.slave.topology, in.slave.of(f), out);
}

}  // namespace anisocontact::mortar
