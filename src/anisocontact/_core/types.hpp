#pragma once
// The handles that Python holds.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "anisocontact/anisotropy/registry.hpp"
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

}  // namespace anisocontact::bindings
