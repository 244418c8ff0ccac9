// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/confirm.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/control/run/exit_code.hpp"

namespace servogate::gateway::command {
namespace {

const text::Entry kNeedsYes{"client.needs-yes", "nothing moves: say --yes where nobody can be asked",
                            "движения нет: добавьте --yes, если спросить некого"};

}  // namespace

void print_refusal(const nlohmann::json& reply) {
  const std::string words = reply.value("text", "");
  const std::size_t end = std::min(words.find('\n'), words.size());
  tell("servogate: " + words.substr(0, end) + " [" + reply.value("code", "") + "]" + words.substr(end));
}

std::optional<int> confirmed(const text::Entry& question) {
  if (::isatty(STDIN_FILENO) == 0) {
    complain(kNeedsYes, {});
    return kWrongUse;
  }
  tell(text::render(question, {}, text::user_language()));
  std::string answer;
  for (int c = std::getchar(); c != EOF && c != '\n'; c = std::getchar()) answer += static_cast<char>(c);
  const bool yes = answer == "y" || answer == "yes" || answer == "д" || answer == "да";
  return yes ? std::nullopt : std::optional<int>(kStopped);
}

}  // namespace servogate::gateway::command
