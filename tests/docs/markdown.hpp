// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

namespace servogate::docs {

/// A piece of code in a document: an inline span, or one line of a fenced block.
struct Code {
  std::string section;  ///< text of the second-level heading above it, empty before the first
  std::string text;     ///< without backticks and without a prompt `$ `
  int line = 0;         ///< from 1
};

/// A link of a document that is no fenced code.
struct Link {
  std::string target;  ///< as written between the parentheses
  int line = 0;        ///< from 1
};

struct Markdown {
  std::vector<std::string> sections;  ///< second-level headings in order
  std::vector<Code> code;
  std::vector<Link> links;
};

/// Reads what the tests need of a document.
Markdown read_markdown(const std::string& text);

/// All words that begin with `--` in a text, without values and punctuation.
std::vector<std::string> options_in(const std::string& text);

/// What `--help` of a program says.
struct Help {
  std::vector<std::string> commands;  ///< under "Subcommands:"
  std::vector<std::string> options;   ///< long ones under "Options:", without `--help`
};
Help read_help(const std::string& text);

}  // namespace servogate::docs
