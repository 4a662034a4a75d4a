#pragma once

#include <nanobind/nanobind.h>

namespace anisocontact::bindings {

void bind_registry(nanobind::module_& m);
void bind_surface(nanobind::module_& m);
void bind_anisotropy(nanobind::module_& m);
void bind_law(nanobind::module_& m);
void bind_kernel(nanobind::module_& m);
void bind_framed(nanobind::module_& m);
void bind_search(nanobind::module_& m);
void bind_facet_pair(nanobind::module_& m);
void bind_facet_framed(nanobind::module_& m);

}  // namespace anisocontact::bindings
