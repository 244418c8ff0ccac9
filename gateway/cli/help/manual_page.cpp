// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/help/manual_page.hpp"

#include <CLI/CLI.hpp>

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/help/choices.hpp"
#include "gateway/cli/help/russian.hpp"

namespace servogate::gateway {

namespace {

using text::Entry;
const Entry kName{"man.name", "NAME", "ИМЯ"};
const Entry kSynopsis{"man.synopsis", "SYNOPSIS", "ВЫЗОВ"};
const Entry kCommands{"man.commands", "COMMANDS", "КОМАНДЫ"};
const Entry kExit{"man.exit", "EXIT STATUS", "КОД ВОЗВРАТА"};
const Entry kCommand{"man.command", "COMMAND", "КОМАНДА"};
const Entry kOptions{"man.options", "OPTIONS", "КЛЮЧИ"};
const Entry kTitle{"man.title", "the control of a machine on a Linux computer",
                   "управление станком на компьютере с Linux"};

std::string heading(const Entry& entry) { return text::render(entry, {}, text::user_language()); }

/// Characters as they are: no requests, no escapes, hyphens that can be copied.
std::string literal(std::string_view words) {
  std::string out;
  bool begin = true;
  for (const char c : text::in_language(words)) {
    if (begin && (c == '.' || c == '\'')) out += "\\&";
    begin = c == '\n';
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string usage(const CLI::App& app) {
  std::string line = "servogate " + command_path(app);
  if (!options_of(app).empty()) line += " [" + heading(kOptions) + "]";
  for (const CLI::Option* argument : arguments_of(app)) {
    const std::string name = argument->get_name(true);
    line += argument->get_required() ? " " + name : " [" + name + "]";
    if (argument->get_items_expected_max() > 1) line += "...";
  }
  return line;
}

void add_option(const CLI::Option& option, std::string& page) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  const std::string value = option.get_type_name();
  page += ".TP\n.B " + literal(names);
  if (takes_value(option) && !value.empty())
    page += value.starts_with("[=") ? literal(value) : " " + literal(value);
  page += "\n" + literal(option.get_description()) + "\n";
}

void add_command(const CLI::App& app, std::string& page) {
  if (const auto below = commands_of(app); !below.empty()) {
    for (const CLI::App* command : below) add_command(*command, page);
    return;
  }
  page += ".SS " + literal("servogate " + command_path(app)) + "\n";
  page += literal(app.get_description()) + "\n.PP\n.B " + literal(usage(app)) + "\n";
  for (const CLI::Option* argument : arguments_of(app))
    if (!argument->get_description().empty())
      page +=
          ".TP\n.B " + literal(argument->get_name(true)) + "\n" + literal(argument->get_description()) + "\n";
  for (const CLI::Option* option : options_of(app)) add_option(*option, page);
  if (!app.get_footer().empty()) page += ".PP\n.nf\n" + literal(app.get_footer()) + "\n.fi\n";
}

}  // namespace

std::string manual_page(CLI::App& app) {
  if (text::user_language() == text::Language::russian) speak_russian(app);
  std::string page = ".TH SERVOGATE 1 \"\" servogate\n";
  page += ".SH " + heading(kName) + "\nservogate \\- " + literal(heading(kTitle)) + "\n";
  page += ".SH " + heading(kSynopsis) + "\n.B servogate\n.I " + heading(kCommand) + "\n[...]\n";
  page += ".SH " + heading(kCommands) + "\n";
  for (const CLI::App* command : commands_of(app)) add_command(*command, page);
  return page + ".SH " + heading(kExit) + "\n.nf\n" + literal(app.get_footer()) + "\n.fi\n";
}

}  // namespace servogate::gateway
