#pragma once
// Adhesion and friction of the core as a law in a contact frame.

#include "anisocontact/kernel/contact_frame.hpp"
#include "anisocontact/kernel/interface.hpp"

namespace anisocontact::kernel {

/// Adhesion and friction of an interface; compiled in cpp/src/laws.cpp.
class CoreLaw final : public Law {
 public:
  explicit CoreLaw(const InterfaceLaw& law) noexcept : law_(law) {}

  Reaction evaluate(const PointState& committed, const ContactFrame& frame,
                    bool tangent) const noexcept override;

 private:
  const InterfaceLaw& law_;
};

}  // namespace anisocontact::kernel
