#pragma once
// The handles that Python holds.

#include <map>
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

}  // namespace anisocontact::bindings
