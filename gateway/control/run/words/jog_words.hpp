// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

/// Word for how a jog ended, as JSON has it: "arrived", "asked", "keep_alive", "feed_enable", "travel",
/// "alarm", "power"; empty: no jog has ended.
std::string_view jog_end_name(image::JogEnd end) noexcept;
/// Code of the sentence: "jog.keep-alive" ...
std::string_view jog_end_code(image::JogEnd end) noexcept;
/// Why the jog of `axis` has ended, as a sentence.
std::string jog_end_words(image::JogEnd end, const std::string& axis, text::Language language);

}  // namespace servogate::gateway
