// The extension module: one function of each file.

#include <nanobind/nanobind.h>

#include "bindings.hpp"

NB_MODULE(_core, m) {
  // objects that an interrupted run leaves behind are no news for its user
  nanobind::set_leak_warnings(false);
  anisocontact::bindings::bind_registry(m);
  anisocontact::bindings::bind_surface(m);
  anisocontact::bindings::bind_anisotropy(m);
  anisocontact::bindings::bind_law(m);
  anisocontact::bindings::bind_interface(m);
  anisocontact::bindings::bind_search(m);
  anisocontact::bindings::bind_facet_interface(m);
  anisocontact::bindings::bind_mortar(m);
  anisocontact::bindings::bind_contact_planes(m);
  anisocontact::bindings::bind_blocks(m);
  anisocontact::bindings::bind_block_rows(m);
}
