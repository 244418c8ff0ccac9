// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::text {

enum class Language { english, russian };

/// Language of the user by LC_ALL, LC_MESSAGES, LANG: Russian when it starts with "ru". Not real-time safe.
Language user_language();

/// A text of the product: an id, and the sentence in both languages with placeholders {0}, {1} ...
/// Every room keeps one table of these; the id is what `[code]` shows and what documents refer to.
struct Entry {
  std::string_view id;
  std::string_view english;
  std::string_view russian;
};

/// The sentence with its placeholders filled. A placeholder without an argument stays visible. Not real-time
/// safe.
std::string render(const Entry& entry, std::span<const std::string> arguments, Language language);

/// An argument that is itself words: render() takes the half of its language. May stand anywhere inside a
/// string that becomes an argument: `path + ": " + both(...)`.
std::string both(std::string_view english, std::string_view russian);

/// Words with every both() in them resolved: for what is printed without render(). Not real-time safe.
std::string in_language(std::string_view words, Language language = user_language());

enum class Severity { error, warning };

/// Words with control characters as \\x1B, so that they neither end a line nor command a terminal; line feeds
/// stay.
std::string visible(std::string_view words);

/// Something wrong in a file that a person wrote. Line and column count from 1; 0 = not known.
struct Finding {
  Severity severity = Severity::error;
  std::string file;
  int line = 0;
  int column = 0;
  const Entry* entry = nullptr;
  std::vector<std::string> arguments;
  std::string source = {};  ///< that line of the file, without its end; empty: not known

  /// `file:line:col: error: text [code]`, the form every command prints (severity stays English for editors).
  std::string str(Language language = user_language()) const;
  /// The line with a caret under the column, as compilers show it: two lines, each ended. Empty when the line
  /// is not known.
  std::string excerpt() const;
};

/// A number as people write it: at most `digits` decimals without zeros at the end; in exponent form only
/// from 1e15 on ("1e+300").
std::string number(double value, int digits = 6);

}  // namespace servogate::text
