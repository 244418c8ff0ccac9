// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/scenario/plc_variables.hpp"

#include <cmath>

#include "plc/types/type.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/variables/values.hpp"

namespace servogate::gateway {

PlcVariables::~PlcVariables() {
  // The cycle must not fill what is gone.
  if (asked_ && control_.logic() != nullptr) control_.logic()->take_back();
}

std::optional<int> PlcVariables::watch(std::string_view name) {
  if (control_.logic() == nullptr) return std::nullopt;
  const std::string text(name);
  const auto handle = control_.logic()->program()->engine.find(text);
  if (!handle || !plc::is_elementary(handle->type->kind)) return std::nullopt;
  for (std::size_t n = 0; n < names_.size(); ++n)
    if (names_[n] == text) return static_cast<int>(n);
  names_.push_back(text);
  values_.push_back(0.0);
  return static_cast<int>(names_.size()) - 1;
}

void PlcVariables::ask() {
  sample_ = std::make_unique<plc::LogicSample>();
  handles_.clear();
  for (const std::string& name : names_) {
    handles_.push_back(control_.logic()->program()->engine.find(name));
    if (handles_.back()) sample_->ranges.push_back({handles_.back()->address, handles_.back()->type->size});
  }
  control_.logic()->ask(*sample_);
  asked_ = true;
  waited_ = 0;
}

void PlcVariables::poll() {
  if (names_.empty()) return;
  // Another question to the same scan takes the place of this one.
  if (asked_ && !control_.logic()->filled(*sample_) && ++waited_ < 3) return;
  if (asked_ && !control_.logic()->filled(*sample_)) {
    control_.logic()->take_back();
    return ask();
  }
  if (asked_) {
    std::size_t at = 0;
    for (std::size_t n = 0; n < handles_.size(); ++n) {
      if (!handles_[n]) {
        values_[n] = std::nan("");
        continue;
      }
      const plc::Type& type = *handles_[n]->type;
      const std::uint8_t* const bytes = sample_->bytes.data() + at;
      values_[n] = handles_[n]->bit >= 0 ? (*bytes >> handles_[n]->bit & 1) : plc::to_number(type, bytes);
      at += type.size;
    }
  }
  ask();
}

}  // namespace servogate::gateway
