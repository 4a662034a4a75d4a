#pragma once
// The handles that Python holds.

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anisocontact/anisotropy/registry.hpp"
#include "anisocontact/kernel/interface.hpp"
#include "anisocontact/law/registry.hpp"
#include "anisocontact/surface/registry.hpp"

namespace anisocontact::bindings {

using ValueMap = std::map<std::string, std::vector<double>>;

struct SurfaceHandle {
  surface::AnySurface any;
};

struct FieldHandle {
  anisotropy::AnyField any;
};

inline std::optional<anisotropy::AnyField> unwrap(const FieldHandle* f) {
  return f == nullptr ? std::nullopt : std::optional(f->any);
}

/// A registered entry by name, with its values.
using Named = std::pair<std::string, ValueMap>;

inline kernel::InterfaceLaw make_law(const Named& normal, const Named& adhesion,
                                     const FieldHandle* adhesion_directions, const Named& friction,
                                     const FieldHandle* friction_directions,
                                     const FieldHandle* friction_directions_second,
                                     const Named& rule, const std::string& evolution) {
  return {law::NormalLaws::make(normal.first, Values(normal.second)),
          law::AdhesionModels::make(adhesion.first, Values(adhesion.second)),
          unwrap(adhesion_directions),
          law::FrictionModels::make(friction.first, Values(friction.second)),
          unwrap(friction_directions),
          unwrap(friction_directions_second),
          law::SlidingRules::make(rule.first, Values(rule.second)),
          kernel::EvolutionForms::make(evolution, Values())};
}

}  // namespace anisocontact::bindings
