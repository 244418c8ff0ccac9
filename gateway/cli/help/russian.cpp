// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/help/russian.hpp"

#include <CLI/CLI.hpp>
#include <string>

#include "gateway/cli/help/catalogue.hpp"

namespace servogate::gateway {

namespace {

constexpr std::string_view kExample = "Example: ";

constexpr std::pair<const char*, const char*> kLabels[] = {{"Usage", "Использование"},
                                                           {"OPTIONS", "КЛЮЧИ"},
                                                           {"SUBCOMMAND", "КОМАНДА"},
                                                           {"SUBCOMMANDS", "КОМАНДЫ"},
                                                           {"Positionals", "Аргументы"},
                                                           {"REQUIRED", "ОБЯЗАТЕЛЬНО"},
                                                           {"TEXT", "ТЕКСТ"},
                                                           {"INT", "ЦЕЛОЕ"},
                                                           {"UINT", "ЦЕЛОЕ"},
                                                           {"FLOAT", "ЧИСЛО"},
                                                           {"Needs", "Требует"},
                                                           {"Excludes", "Исключает"}};

std::string footer_of(std::string_view english) {
  const std::size_t example = english.rfind(kExample);
  if (example == std::string_view::npos) return std::string(russian(english));
  std::string text;
  if (example > 0) text = std::string(russian(english.substr(0, example - 1))) + "\n";
  return text + "Пример: " + std::string(english.substr(example + kExample.size()));
}

void translate(CLI::App& app) {
  app.description(std::string(russian(app.get_description())));
  if (!app.get_footer().empty()) app.footer(footer_of(app.get_footer()));
  app.group("Команды");
  for (CLI::Option* option : app.get_options()) {
    option->description(std::string(russian(option->get_description())));
    if (!option->get_positional()) option->group("Ключи");
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) translate(*command);
}

}  // namespace

std::string_view russian(std::string_view english) {
  for (const Translation& t : kCatalogue)
    if (t.english == english) return t.russian;
  return english;
}

void speak_russian(CLI::App& app) {
  for (const auto& [label, text] : kLabels) app.get_formatter()->label(label, text);
  translate(app);
}

}  // namespace servogate::gateway
