#pragma once
// History of a point that is kept by components in the basis of an analytic surface, as a law sees
// it in the contact frame; with derivatives by the two coordinates of the projection and the gap.

#include "anisocontact/kernel/forms.hpp"

namespace anisocontact::kernel {

class CoordinateHistory {
 public:
  /// `gap`: xi^3 less the offset, at the coordinates `xi` in the contact plane.
  CoordinateHistory(const AnyEvolution& evolution, const surface::AnySurface& surface,
                    const PointState& state, const std::array<double, 2>& xi, double gap,
                    const ContactPlane& plane)
      : total_(counts_all(evolution)) {
    const Vector<S> c{{S::variable(xi[0], 0), S::variable(xi[1], 1)}};
    const Kinematics<S> k{surface::geometry(surface::jet(surface, c[0], c[1])), c,
                          surface::domain(surface), S::variable(gap, 2)};
    const auto t = std::visit(
        [&]<class Form>(const Form& form) -> Transported<S> {
          if constexpr (Form::vectors)
            return {};
          else
            return form.apply(state, k);
        },
        evolution);
    // the frame does not spin: its axes are at rest in the tangent plane
    const auto along = [&](const Vec3<S>& v) -> Numbers {
      return {v.dot(constant<S>(plane.t[0])), v.dot(constant<S>(plane.t[1]))};
    };
    increment_ = along(k.now.spatial(t.increment));
    if (remembers(state)) {
      stored_ = along(k.now.spatial(t.stored));
      elastic_ = along(k.now.spatial(t.elastic));
    }
    if (!t.connection) return;
    connected_ = true;
    const std::array<Numbers, 2> upper{along(k.now.dual_basis(0)), along(k.now.dual_basis(1))},
        lower{along(k.now.jet.d1[0]), along(k.now.jet.d1[1])};
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 0; b < 2; ++b)
        for (std::size_t i = 0; i < 2; ++i)
          for (std::size_t m = 0; m < 2; ++m)
            connection_[2 * a + b] += upper[i][a] * (*t.connection)(i, m) * lower[m][b];
  }

  /// Writes what the law sees.
  void put(ContactFrame& in) const {
    in.increment = {increment_[0].v, increment_[1].v};
    in.stored = {stored_[0].v, stored_[1].v};
    in.elastic = {elastic_[0].v, elastic_[1].v};
    in.total = total_;
    if (connected_)
      in.connection = CoContra<double>{
          {{{connection_[0].v, connection_[1].v}, {connection_[2].v, connection_[3].v}}}};
  }

  /// Adds the change of the force with what the law sees.
  void add(const Reaction& r, const ContactPlane& plane, std::array<Form, 2>& f) const {
    for (std::size_t a = 0; a < 2; ++a) {
      std::array<double, 3> by{};
      const auto chain = [&](Slope s, std::size_t k, const S& number) {
        for (std::size_t j = 0; j < 3; ++j) by[j] += r.slope(s, k)[a] * number.d[j];
      };
      for (std::size_t k = 0; k < 2; ++k) {
        chain(Slope::increment, k, increment_[k]);
        chain(Slope::stored, k, stored_[k]);
        chain(Slope::elastic, k, elastic_[k]);
      }
      for (std::size_t k = 0; k < 4; ++k) chain(Slope::connection, k, connection_[k]);
      for (std::size_t j = 0; j < 2; ++j) f[a].xi[j] += by[j];
      plane.add_gap(by[2], f[a]);
    }
  }

 private:
  using S = Dual<3>;
  using Numbers = std::array<S, 2>;

  Numbers increment_{}, stored_{}, elastic_{};
  std::array<S, 4> connection_{};  ///< row after row
  bool connected_{false}, total_;
};

}  // namespace anisocontact::kernel
