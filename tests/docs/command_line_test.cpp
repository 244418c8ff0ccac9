// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "tests/docs/markdown.hpp"
#include "tests/places/places.hpp"

namespace servogate::docs {
namespace {

std::string output_of(const std::string& command) {
  std::string out;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return out;
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  pclose(pipe);
  return out;
}

/// Commands ("run", "plc check") and their options, as the program itself says.
const std::map<std::string, std::set<std::string>>& known() {
  static const auto commands = [] {
    std::map<std::string, std::set<std::string>> out;
    const auto collect = [&out](const std::string& prefix, auto&& self) -> void {
      for (const std::string& c :
           read_help(output_of(tests::program() + " " + prefix + " --help")).commands) {
        const std::string name = prefix.empty() ? c : prefix + " " + c;
        const Help help = read_help(output_of(tests::program() + " " + name + " --help"));
        if (help.commands.empty()) out[name] = {help.options.begin(), help.options.end()};
        if (!help.commands.empty()) self(name, self);
      }
    };
    collect("", collect);
    return out;
  }();
  return commands;
}

Markdown page() {
  std::ifstream in(tests::source_dir() + "/docs/command-line.md");
  std::stringstream text;
  text << in.rdbuf();
  return read_markdown(text.str());
}

/// The command that a piece of code names behind `servogate`, as far as the page writes it; "" for none.
std::string command_in(const std::string& code) {
  std::istringstream words(code);
  std::string program, first, second;
  words >> program >> first >> second;
  if (program != "servogate" || first.empty() || first[0] == '-' || first.back() == ':') return "";
  if (std::isupper(static_cast<unsigned char>(first[0])) != 0) return "";  // COMMAND, a stand-in
  if (first == "chek") return "";                                          // shown as the mistake that it is
  const std::string both = first + " " + second;
  return known().count(both) != 0 ? both : first;
}

/// True when some piece of code begins with the command: `servogate run ...`, or `power on` of a table.
bool page_names(const Markdown& page, const std::string& command) {
  return std::any_of(page.code.begin(), page.code.end(), [&](const Code& c) {
    const std::string text = c.text + " ";
    return text.rfind(command + " ", 0) == 0 || text.rfind("servogate " + command + " ", 0) == 0;
  });
}

/// A command of its own: "start" is none of "can restart", nor "step" of "plc step".
bool names(const std::string& section, const std::string& command) {
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-'; };
  for (std::size_t at = section.find(command); at != std::string::npos; at = section.find(command, at + 1)) {
    const std::size_t end = at + command.size();
    const std::string before = section.substr(0, at);
    if (before.ends_with("plc ") || before.ends_with("can ") || before.ends_with("bench ")) continue;
    if ((at == 0 || !is_word(section[at - 1])) && (end == section.size() || !is_word(section[end])))
      return true;
  }
  return false;
}

/// True when the option stands in a section whose heading names the command, or in that of all clients.
bool page_explains(const Markdown& page, const std::string& command, const std::string& option) {
  const bool own = std::any_of(page.sections.begin(), page.sections.end(),
                               [&](const std::string& s) { return names(s, command); });
  return std::any_of(page.code.begin(), page.code.end(), [&](const Code& c) {
    const bool here = own ? names(c.section, command) : c.section.find("clients") != std::string::npos;
    const std::vector<std::string> options = options_in(c.text);
    return here && std::find(options.begin(), options.end(), option) != options.end();
  });
}

TEST(CommandLinePage, the_program_tells_its_commands) {
  ASSERT_GE(known().size(), 20u) << "no help, or in another form";
  ASSERT_TRUE(known().count("run"));
  EXPECT_TRUE(known().at("run").count("--trace"));
  EXPECT_TRUE(known().at("run").count("--quiet"));
  EXPECT_TRUE(known().count("plc check"));
}

TEST(CommandLinePage, names_no_command_that_the_program_does_not_know) {
  int named = 0;
  for (const Code& c : page().code) {
    const std::string command = command_in(c.text);
    if (command.empty()) continue;
    ++named;
    EXPECT_TRUE(known().count(command)) << "docs/command-line.md:" << c.line << ": " << c.text;
  }
  EXPECT_GE(named, 20);
}

TEST(CommandLinePage, names_every_command_of_the_program) {
  const Markdown doc = page();
  for (const auto& [command, options] : known())
    EXPECT_TRUE(page_names(doc, command)) << "`" << command << "` is missing in docs/command-line.md";
}

TEST(CommandLinePage, names_no_option_that_the_program_does_not_know) {
  std::set<std::string> all{"--help"};
  for (const auto& [command, options] : known()) all.insert(options.begin(), options.end());
  for (const Code& c : page().code) {
    const std::string command = command_in(c.text);
    const auto own = known().find(command);
    for (const std::string& option : options_in(c.text))
      EXPECT_TRUE(option == "--help" ||
                  (own != known().end() ? own->second.count(option) : all.count(option)))
          << "docs/command-line.md:" << c.line << ": " << option << " in: " << c.text;
  }
}

TEST(CommandLinePage, names_every_option_of_the_program_where_its_command_stands) {
  const Markdown doc = page();
  for (const auto& [command, options] : known())
    for (const std::string& option : options)
      EXPECT_TRUE(page_explains(doc, command, option)) << "`" << command << " " << option << "` is missing";
}

TEST(CommandLinePage, a_missing_or_invented_option_would_be_noticed) {
  const Markdown doc = read_markdown("## run\n`servogate run M --trace F`\n");
  EXPECT_TRUE(page_explains(doc, "run", "--trace"));
  EXPECT_FALSE(page_explains(doc, "run", "--tra"));
  EXPECT_FALSE(page_explains(doc, "run", "--html"));
  EXPECT_FALSE(page_names(doc, "check"));
  EXPECT_EQ(command_in("servogate fly M"), "fly");
  EXPECT_EQ(options_in("a --speed N] [--realtime=best-effort] -- --x-y,"),
            (std::vector<std::string>{"--speed", "--realtime", "--x-y"}));
}

}  // namespace
}  // namespace servogate::docs
