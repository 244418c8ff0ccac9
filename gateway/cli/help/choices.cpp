// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/help/choices.hpp"

#include <sstream>

namespace servogate::gateway {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string command_path(const CLI::App& app) {
  if (app.get_parent() == nullptr) return {};
  const std::string above = command_path(*app.get_parent());
  return above.empty() ? app.get_name() : above + " " + app.get_name();
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options(
      [&](const CLI::Option* option) { return !option->get_positional() && option != app.get_help_ptr(); });
}

std::string option_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? "-" + option.get_snames().front() : "--" + option.get_lnames().front();
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::vector<std::string> choices_of(const CLI::Option& option) {
  std::vector<std::string> words;
  for (int i = 0; words.empty(); ++i) {
    try {
      // The option hands a constant validator out from a variable one only.
      std::istringstream name(const_cast<CLI::Option&>(option).get_validator(i)->get_name());
      for (std::string word; name >> word;) words.push_back(word);
    } catch (const CLI::OptionNotFound&) {
      break;
    }
  }
  return words;
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

}  // namespace servogate::gateway
