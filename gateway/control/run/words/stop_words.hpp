// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "gateway/control/compose/control.hpp"

namespace servogate::gateway {

/// What stopped a program before its end where it was no alarm, in words.
struct StopWords {
  std::string_view cause;  ///< "drives_off", "enable_withdrawn"
  std::string text;        ///< "the program was stopped in line 12: the command line switched the drives off"
  std::string remedy;
};

/// Of a process whose state is `stopped`; nullopt otherwise.
std::optional<StopWords> stop_words(Control& control, const image::ProcessImage& image, int process,
                                    text::Language language);

}  // namespace servogate::gateway
