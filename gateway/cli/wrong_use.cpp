// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/wrong_use.hpp"

#include <algorithm>

#include "firmware_if/text/nearest.hpp"
#include "gateway/cli/messages.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kNoCommand{"cli.no-command", "a command is missing; `servogate {0}--help` lists them",
                             "не указана команда; их перечисляет `servogate {0}--help`"};
const text::Entry kUnknownCommand{"cli.unknown-command", "unknown command '{0}'{1}",
                                  "неизвестная команда «{0}»{1}"};
const text::Entry kUnknownOption{"cli.unknown-option", "`{0}` has no option '{1}'{2}",
                                 "у «{0}» нет ключа «{1}»{2}"};
const text::Entry kEmpty{"cli.empty", "`{0}`: {1} is empty; a variable of the shell that is not set?",
                         "«{0}»: {1} пуст; не задана переменная оболочки?"};
const text::Entry kUnexpected{"cli.unexpected", "`{0}` does not take '{1}'; see `{0} --help`",
                              "«{0}» не принимает «{1}»; см. `{0} --help`"};
const text::Entry kMissing{"cli.missing", "`{0}` needs {1}; see `{0} --help`",
                           "для «{0}» нужен аргумент {1}; см. `{0} --help`"};
const text::Entry kNeedsValue{"cli.needs-value", "{0} needs a value", "ключу {0} нужно значение"};
const text::Entry kOnce{"cli.once", "{0} may be given once only", "{0} можно указать только один раз"};
const text::Entry kNoValue{"cli.no-value", "{0} takes no value", "ключ {0} не принимает значения"};
const text::Entry kExclude{"cli.exclude", "{0} and {1} exclude one another",
                           "{0} и {1} исключают друг друга"};
const text::Entry kBadValue{"cli.bad-value", "{0}: {1}", "{0}: {1}"};
const text::Entry kOther{"cli.wrong-use", "wrong use: {0}", "неверный вызов: {0}"};

std::string did_you_mean(const std::string& word) {
  return word.empty() ? "" : text::both("; did you mean '" + word + "'?", "; имелось в виду «" + word + "»?");
}

/// The command that was reached, `plc run` inside `plc`, and what it is called from the shell.
const CLI::App& reached(const CLI::App& app, std::string& called) {
  const CLI::App* at = &app;
  called = app.get_name();
  while (!at->get_subcommands().empty()) {
    at = at->get_subcommands().front();
    called += " " + at->get_name();
  }
  return *at;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option*) { return true; });
}

/// Longest name first, so that `--a-b` is not taken for `--a`.
const CLI::Option* option_in(const CLI::App& app, const std::string& message) {
  const CLI::Option* best = nullptr;
  for (const CLI::Option* option : options_of(app)) {
    const std::string name = option->get_name();
    if (message.find(name) != std::string::npos && (best == nullptr || name.size() > best->get_name().size()))
      best = option;
  }
  return best;
}

bool complain_of_unread(const CLI::App& app, const std::string& called,
                        const std::vector<std::string>& unread) {
  const auto option = std::find_if(unread.begin(), unread.end(), [](const std::string& word) {
    const bool number = word.size() > 1 && (word[1] == '.' || (word[1] >= '0' && word[1] <= '9'));
    return word.size() > 1 && word[0] == '-' && !number;
  });
  if (option == unread.end()) return false;
  std::vector<std::string> names{"--help"};
  for (const CLI::Option* o : options_of(app))
    for (const std::string& name : o->get_lnames()) names.push_back("--" + name);
  const std::string word = option->substr(0, option->find('='));
  complain(kUnknownOption, {called, word, did_you_mean(text::nearest(word, names))});
  return true;
}

/// By the code: what CLI11 calls an error may be the name of a command.
bool is(const CLI::ParseError& error, CLI::ExitCodes code) {
  return error.get_exit_code() == static_cast<int>(code);
}

void complain_of_option(const CLI::ParseError& error, const CLI::Option& option) {
  const std::string name = option.get_name(), message = error.what();
  const std::size_t begin = message.find(": ");
  if (is(error, CLI::ExitCodes::ValidationError) && begin != std::string::npos)
    return complain(kBadValue, {name, message.substr(begin + 2)});
  if (is(error, CLI::ExitCodes::ArgumentMismatch) && option.get_expected_max() > 0)
    return complain(option.results().size() > 1 ? kOnce : kNeedsValue, {name});
  complain(kNoValue, {name});
}

/// CLI11 names the flag without its dashes: "virtual was given a disallowed flag override".
bool complain_of_flag_value(const CLI::ParseError& error, const CLI::App& app) {
  const std::string message = error.what();
  const std::size_t rest = message.find(" was given a disallowed flag override");
  if (rest == std::string::npos) return false;
  for (const CLI::Option* option : options_of(app))
    if (option->check_name("--" + message.substr(0, rest))) {
      complain(kNoValue, {option->get_name()});
      return true;
    }
  return false;
}

bool complain_of_exclusion(const CLI::App& app) {
  for (const CLI::Option* option : options_of(app))
    for (const CLI::Option* other : option->get_excludes())
      if (option->count() > 0 && other->count() > 0) {
        complain(kExclude, {option->get_name(), other->get_name()});
        return true;
      }
  return false;
}

bool complain_of_missing(const CLI::App& app, const std::string& called) {
  for (const CLI::Option* option : options_of(app))
    if (option->get_required() && option->count() == 0) {
      complain(kMissing, {called, option->get_name()});
      return true;
    }
  return false;
}

}  // namespace

bool complain_of_empty(const CLI::App& app) {
  std::string called;
  const CLI::App& at = reached(app, called);
  for (const CLI::Option* option : options_of(at))
    for (const std::string& given : option->results())
      if (given.empty()) {
        complain(kEmpty, {called, option->get_name()});
        return true;
      }
  return false;
}

void complain_of_command(const std::string& prefix, const std::string& word, const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  std::string near = text::nearest(word.substr(std::min(word.find_first_not_of('-'), word.size())), names);
  if (near.empty())
    complain(kUnknownCommand,
             {prefix + word, text::both("; `servogate " + prefix + "--help` lists them",
                                        "; их перечисляет `servogate " + prefix + "--help`")});
  else
    complain(kUnknownCommand, {prefix + word, did_you_mean(prefix + near)});
}

void complain_of_use(const CLI::ParseError& error, const CLI::App& app,
                     const std::vector<std::string>& unread) {
  std::string called;
  const CLI::App& at = reached(app, called);
  if (complain_of_unread(at, called, unread)) return;
  if (!at.get_subcommands([](const CLI::App*) { return true; }).empty())
    return complain(kNoCommand, {&at == &app ? "" : at.get_name() + " "});
  if (is(error, CLI::ExitCodes::RequiredError) && complain_of_missing(at, called)) return;
  if (is(error, CLI::ExitCodes::ExcludesError) && complain_of_exclusion(at)) return;
  if (complain_of_flag_value(error, at)) return;
  if (is(error, CLI::ExitCodes::ExtrasError) && !unread.empty())
    return complain(kUnexpected, {called, unread.front()});
  if (const CLI::Option* option = option_in(at, error.what()); option != nullptr)
    return complain_of_option(error, *option);
  complain(kOther, {error.what()});
}

}  // namespace servogate::gateway
