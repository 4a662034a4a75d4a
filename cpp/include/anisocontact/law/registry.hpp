#pragma once
// The laws there are. A new one: its header, and its name here.

#include "anisocontact/law/adhesion.hpp"
#include "anisocontact/law/energy.hpp"
#include "anisocontact/law/friction.hpp"
#include "anisocontact/law/normal.hpp"
#include "anisocontact/law/rules/coaxial.hpp"
#include "anisocontact/law/rules/explicit.hpp"
#include "anisocontact/law/rules/linear.hpp"
#include "anisocontact/law/rules/maximum_dissipation.hpp"
#include "anisocontact/law/rules/radial.hpp"
#include "anisocontact/law/rules/slip_ellipse.hpp"
#include "anisocontact/registry/descriptor.hpp"

namespace anisocontact::law {

/// A list of rules, each of which must be one: what one lacks is said here, not where it is used.
template <SlidingRule... Rule>
using RuleRegistry = Registry<Rule...>;

using SlidingRules =
    RuleRegistry<MaximumDissipation, Explicit, Radial, LinearRule, Coaxial, SlipEllipse>;
using AnyRule = SlidingRules::Any;

using AdhesionModels = Registry<Elastic, Maxwell, KelvinVoigt, StandardLinearSolid, GeneralLinear>;
using AnyAdhesion = AdhesionModels::Any;

using NormalLaws =
    Registry<Penalty, NormalKelvinVoigt, NormalMaxwell, NormalStandardLinearSolid, NormalGeneral>;
using AnyNormalLaw = NormalLaws::Any;

using FrictionModels = Registry<Orthotropic, HeCurnier>;
using AnyFriction = FrictionModels::Any;

template <class S>
ContraContra<S> friction_tensor(const AnyFriction& f, const ContraContra<S>& a_contra,
                                const UpperAxes<S>& axes, const UpperAxes<S>& second) {
  return std::visit([&](const auto& m) { return m.tensor(a_contra, axes, second); }, f);
}

inline bool frictionless(const AnyFriction& f) noexcept {
  return std::visit([](const auto& m) noexcept { return m.frictionless(); }, f);
}

inline const LinearModel& linear_model(const AnyAdhesion& a) {
  return std::visit([](const auto& m) -> const LinearModel& { return m.model(); }, a);
}

inline const NormalModel& normal_model(const AnyNormalLaw& n) {
  return std::visit([](const auto& m) -> const NormalModel& { return m.model(); }, n);
}

}  // namespace anisocontact::law
