// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/socket/line.hpp"

#include <nlohmann/json.hpp>

#include "gateway/cli/options.hpp"

namespace servogate::gateway {

using nlohmann::json;

std::string text_of(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

Reply accept(const text::Entry& entry, const std::vector<std::string>& arguments, text::Language language,
             json more) {
  more["ok"] = true;
  more["exit"] = kDone;
  more["text"] = text::render(entry, arguments, language);
  return {text_of(more)};
}

Reply refuse(const text::Entry& entry, const std::vector<std::string>& arguments, int exit,
             text::Language language) {
  return {text_of({{"ok", false},
                   {"code", entry.id},
                   {"text", text::render(entry, arguments, language)},
                   {"exit", exit}})};
}

}  // namespace servogate::gateway
