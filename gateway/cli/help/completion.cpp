// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/help/completion.hpp"

#include <CLI/CLI.hpp>

#include "gateway/cli/help/choices.hpp"

namespace servogate::gateway {

namespace {

constexpr const char* kHead =
    R"(# Completion of servogate for bash. zsh: autoload -U bashcompinit && bashcompinit first.
_servogate() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command= words=
  # bash parts words at "=": --realtime=best-effort are three.
  if [ "$current" = "=" ]; then current=; elif [ "$previous" = "=" ]; then previous=${COMP_WORDS[COMP_CWORD-2]}; fi
  [ "$COMP_CWORD" -lt 2 ] || command=${COMP_WORDS[1]}
)";
constexpr const char* kTail = R"(  COMPREPLY=($(compgen -W "$words" -- "$current"))
}
complete -o default -F _servogate servogate
)";

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

void add_values(const CLI::App& app, std::string& cases) {
  for (const CLI::Option* option : options_of(app)) {
    if (!takes_value(*option)) continue;
    // A file name, a number: words stay empty, and what `complete` does by default takes over.
    cases += "    \"" + command_path(app) + " " + option_name(*option) + "\") words=\"" +
             joined(choices_of(*option)) + "\" ;;\n";
  }
}

void add_words(const CLI::App& app, std::string& cases) {
  std::vector<std::string> words;
  for (const CLI::App* command : commands_of(app)) words.push_back(command->get_name());
  const bool group = !words.empty();
  for (const CLI::Option* option : options_of(app)) words.push_back(option_name(*option));
  words.emplace_back("--help");
  // Options where one has been begun, or where nothing else may stand.
  cases +=
      "    \"" + command_path(app) + " \"" + (group ? "*" : "-*") + ") words=\"" + joined(words) + "\" ;;\n";
}

void walk(const CLI::App& app, std::string& groups, std::string& values, std::string& words) {
  add_values(app, values);
  for (const CLI::App* command : commands_of(app)) walk(*command, groups, values, words);
  add_words(app, words);
  if (app.get_parent() != nullptr && !commands_of(app).empty())
    groups +=
        "    " + app.get_name() + ") [ \"$COMP_CWORD\" -lt 3 ] || command=\"$command ${COMP_WORDS[2]}\" ;;\n";
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string groups, values, words;
  walk(app, groups, values, words);
  return kHead + ("  case $command in\n" + groups + "  esac\n") + "  case \"$command $previous\" in\n" +
         values + "    *) case \"$command $current\" in\n" + words + "    esac ;;\n  esac\n" + kTail;
}

}  // namespace servogate::gateway
