#pragma once
// How thin an ellipse may be whose tensor has both axes in each of its components.

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>

namespace anisocontact::law {

/// Refuses an ellipse of semi-axes whose squares have next to no digits in common: with a tensor of
/// doubles what slip dissipates was negative at points from 1e-8 on, and forces were no numbers.
inline void refuse_thin(const std::string& name, double first, double second,
                        const std::string& advice) {
  constexpr double thinnest = 1e-6;
  if (std::min(first, second) >= thinnest * std::max(first, second)) return;
  std::ostringstream s;
  s << name << ": " << first << " and " << second << " given, one must be at least " << thinnest
    << " of the other, as rounding leaves nothing of a thinner ellipse" << advice;
  throw std::invalid_argument(s.str());
}

}  // namespace anisocontact::law
