// SPDX-License-Identifier: Apache-2.0
#include "tests/docs/markdown.hpp"

#include <cctype>
#include <sstream>

namespace servogate::docs {

namespace {

bool begins(const std::string& line, const char* with) { return line.rfind(with, 0) == 0; }

void take_inline(const std::string& line, int number, Markdown& out) {
  const std::string section = out.sections.empty() ? "" : out.sections.back();
  for (std::size_t at = line.find('`'); at != std::string::npos;) {
    const std::size_t end = line.find('`', at + 1);
    if (end == std::string::npos) break;
    out.code.push_back({section, line.substr(at + 1, end - at - 1), number});
    at = line.find('`', end + 1);
  }
  for (std::size_t at = line.find("]("); at != std::string::npos; at = line.find("](", at + 2)) {
    const std::size_t end = line.find(')', at);
    if (end != std::string::npos) out.links.push_back({line.substr(at + 2, end - at - 2), number});
  }
}

}  // namespace

Markdown read_markdown(const std::string& text) {
  Markdown out;
  std::istringstream in(text);
  bool fenced = false;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (begins(line, "```")) {
      fenced = !fenced;
    } else if (fenced) {
      const std::string section = out.sections.empty() ? "" : out.sections.back();
      out.code.push_back({section, begins(line, "$ ") ? line.substr(2) : line, number});
    } else {
      if (begins(line, "## ")) out.sections.push_back(line.substr(3));
      take_inline(line, number, out);
    }
  }
  return out;
}

std::vector<std::string> options_in(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 2)) {
    if (at > 0 && (std::isalnum(static_cast<unsigned char>(text[at - 1])) != 0 || text[at - 1] == '-'))
      continue;
    std::size_t end = at + 2;
    while (end < text.size() &&
           (std::islower(static_cast<unsigned char>(text[end])) != 0 || text[end] == '-'))
      ++end;
    if (end > at + 2) out.push_back(text.substr(at, end - at));
  }
  return out;
}

Help read_help(const std::string& text) {
  Help out;
  std::istringstream in(text);
  std::string part;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == ':' && line[0] != ' ') part = line;
    const bool entry = line.size() > 2 && line[0] == ' ' && line[1] == ' ' && line[2] != ' ';
    if (!entry) continue;
    const std::string first = line.substr(2, line.find(' ', 2) - 2);
    if (part == "Subcommands:") out.commands.push_back(first);
    if (part == "Options:")
      for (const std::string& option : options_in(" " + first))
        if (option != "--help") out.options.push_back(option);
    if (part == "Options:" && first.find(",--") != std::string::npos && first != "-h,--help")
      out.options.push_back(first.substr(first.find("--")));
  }
  return out;
}

}  // namespace servogate::docs
