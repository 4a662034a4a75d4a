#pragma once
// The handles that Python holds.

#include <array>
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

struct LawHandle {
  kernel::InterfaceLaw law;
};

/// A field, and whether it lies on the slave.
inline kernel::Directions directions(const FieldHandle* f, bool on_slave) {
  return {f == nullptr ? std::nullopt : std::optional(f->any),
          on_slave ? kernel::Side::slave : kernel::Side::master};
}

/// Whether the directions of adhesion, of friction and of the second surface lie on the slave.
using OnSlave = std::array<bool, 3>;

/// A registered entry by name, with its values.
using Named = std::pair<std::string, ValueMap>;

inline kernel::InterfaceLaw make_law(const Named& normal, const Named& adhesion,
                                     const FieldHandle* adhesion_directions, const Named& friction,
                                     const FieldHandle* friction_directions,
                                     const FieldHandle* friction_directions_second,
                                     const Named& rule, const std::string& evolution,
                                     const OnSlave& on_slave) {
  return {law::NormalLaws::make(normal.first, Values(normal.second)),
          law::AdhesionModels::make(adhesion.first, Values(adhesion.second)),
          directions(adhesion_directions, on_slave[0]),
          law::FrictionModels::make(friction.first, Values(friction.second)),
          directions(friction_directions, on_slave[1]),
          directions(friction_directions_second, on_slave[2]),
          law::SlidingRules::make(rule.first, Values(rule.second)),
          kernel::EvolutionForms::make(evolution, Values())};
}

/// The normal law and the axes of a tangential law that is not in the core; adhesion and friction are
/// there for their directions.
inline LawHandle given_law(const Named& normal, const FieldHandle* field, bool on_slave) {
  const kernel::Directions along = directions(field, on_slave);
  return {{law::NormalLaws::make(normal.first, Values(normal.second)),
           law::AnyAdhesion{},
           along,
           law::AnyFriction{},
           along,
           {},
           law::AnyRule{}}};
}

}  // namespace anisocontact::bindings
