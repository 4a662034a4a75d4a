#pragma once
// What each file of this folder adds to the extension module.

#include <nanobind/nanobind.h>

namespace anisocontact::bindings {

void bind_registry(nanobind::module_& m);
void bind_surface(nanobind::module_& m);
void bind_anisotropy(nanobind::module_& m);
void bind_law(nanobind::module_& m);
void bind_interface(nanobind::module_& m);
void bind_search(nanobind::module_& m);
void bind_facet_interface(nanobind::module_& m);
void bind_mortar(nanobind::module_& m);
void bind_contact_planes(nanobind::module_& m);
void bind_blocks(nanobind::module_& m);
void bind_block_rows(nanobind::module_& m);

}  // namespace anisocontact::bindings
