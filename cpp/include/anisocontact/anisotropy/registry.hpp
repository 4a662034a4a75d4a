#pragma once
// The direction fields there are. A new one: its header, and its name here.

#include "anisocontact/anisotropy/constant.hpp"
#include "anisocontact/registry/descriptor.hpp"

namespace anisocontact::anisotropy {

using Fields = Registry<Constant>;
using AnyField = Fields::Any;

template <class S>
Axes<S> axes(const AnyField& f, const surface::Geometry<S>& g, const Vector<S>& xi) {
  return std::visit([&](const auto& t) { return t.axes(g, xi); }, f);
}

}  // namespace anisocontact::anisotropy
