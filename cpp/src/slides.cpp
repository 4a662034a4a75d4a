// The sliding rules by themselves, in batches.

#include "anisocontact/law/slide_batch.hpp"
#include "anisocontact/tensor/inline.hpp"

namespace anisocontact::law {

namespace {

template <bool with_tangent, class Rule>
void slide_one(const Rule& rule, const SlideInput& in, const SlideOutput& out,
               std::size_t i) noexcept {
  const auto p = in.problem(i);
  SlideResult<double> r{p.trial, p.trial, {}, true};
  SlideTangent t{unit<double, Place::co>(), {}};
  out.slides[i] = friction_norm(p.friction, p.trial) > p.pressure;
  if (out.slides[i]) {
    r = rule.slide(p);
    if constexpr (with_tangent) t = rule.tangent(p, r);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    out.traction[2 * i + k] = r.traction[k];
    out.stored[2 * i + k] = r.stored[k];
    out.slip[2 * i + k] = r.slip[k];
  }
  out.converged[i] = r.converged;
  if constexpr (with_tangent)
    for (std::size_t k = 0; k < 2; ++k) {
      out.d_pressure[2 * i + k] = t.d_pressure[k];
      for (std::size_t j = 0; j < 2; ++j) out.d_trial[4 * i + 2 * k + j] = t.d_trial(k, j);
    }
}

template <bool with_tangent, class Rule>
void slide_all(const Rule& rule, const SlideBatch& batch, std::size_t first,
               std::size_t last) noexcept {
  with_widest([&]() ANISOCONTACT_INLINE_LAMBDA {
    for (std::size_t i = first; i < last; ++i)
      slide_one<with_tangent>(rule, batch.in, batch.out, i);
  });
}

}  // namespace

void slide(const AnyRule& any, const SlideBatch& batch, std::size_t first, std::size_t last,
           bool with_tangent) noexcept {
  std::visit(
      [&](const auto& rule) {
        with_tangent ? slide_all<true>(rule, batch, first, last)
                     : slide_all<false>(rule, batch, first, last);
      },
      any);
}

}  // namespace anisocontact::law
