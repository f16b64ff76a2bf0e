#include "drivers/leds/led_group.h"

namespace zenith {

Status LedGroup::open() {
  close();
  open_ = true;
  for (const auto& led : leds_) {
    if (led == nullptr) continue;
    const Status opened = led->open();
    if (opened.ok()) continue;
    close();
    return opened;
  }
  return {};
}

void LedGroup::close() {
  if (!open_) return;
  for (const auto& led : leds_) {
    if (led != nullptr) led->close();
  }
  lit_ = 0;
  open_ = false;
}

Status LedGroup::set(LedMask lit) {
  if (!open_) return {};
  for (std::size_t i = 0; i < leds_.size(); ++i) {
    const auto bit = static_cast<LedMask>(1U << i);
    if (leds_[i] == nullptr || ((lit ^ lit_) & bit) == 0) continue;
    const Status done = leds_[i]->set((lit & bit) != 0);
    if (done.ok()) continue;
    close();
    return done;
  }
  lit_ = lit;
  return {};
}

std::string LedGroup::description() const {
  static constexpr const char* kRoles[] = {"status", "peer", "fault"};
  std::string text;
  for (std::size_t i = 0; i < leds_.size(); ++i) {
    if (leds_[i] == nullptr) continue;
    text += (text.empty() ? "" : ", ") + std::string(kRoles[i]) + " " + leds_[i]->description();
  }
  return text.empty() ? "no LEDs" : text;
}

}  // namespace zenith
