// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/sdo_access.hpp"

#include <cstdio>

namespace servogate::canopen {

namespace {

const text::Entry kNoAnswer{"sdo.no-answer", "no answer", "нет ответа"};
const text::Entry kBadProtocol{"sdo.bad-protocol", "the answer is against CiA 301: {0}",
                               "ответ противоречит CiA 301: {0}"};

std::string abort_words(AbortCode code, text::Language language) {
  char number[16];
  const auto value = static_cast<std::uint32_t>(code);
  std::snprintf(number, sizeof number, "%04X %04Xh", value >> 16, value & 0xFFFF);
  return std::string(number) + ": " +
         text::render(abort_text(code), std::vector<std::string>{number}, language);
}

}  // namespace

std::string SdoOutcome::why(text::Language language) const {
  if (status == SdoStatus::aborted) return abort_words(abort, language);
  if (status == SdoStatus::bad_protocol)
    return text::render(kBadProtocol, std::vector<std::string>{abort_words(abort, language)}, language);
  return text::render(kNoAnswer, {}, language);
}

}  // namespace servogate::canopen
