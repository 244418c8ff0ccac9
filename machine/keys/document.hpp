// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "machine/config.hpp"

namespace servogate::machine {

/// One element of a TOML document with its place; tables keep the order of the file.
struct Element {
  enum class Kind : std::uint8_t { boolean, integer, real, string, date, array, table };
  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0.0;
  std::string string;
  std::string key;  ///< its name in the table around it, empty in an array
  Where at;         ///< of the value
  Where key_at;     ///< of the name, of the value in an array
  std::vector<Element> children;

  const Element* find(std::string_view name) const;
  bool numeric() const { return kind == Kind::integer || kind == Kind::real; }
  double number() const { return kind == Kind::integer ? static_cast<double>(integer) : real; }
};

/// A TOML text read. On a syntax error `error` holds the reader's words and `error_at` the place; `root` is
/// empty.
struct Document {
  Element root;
  std::string error;
  Where error_at;
  bool ok() const { return error.empty(); }
};
/// Never throws.
Document read_document(std::string_view source);

/// `text` as a TOML basic string with its quotes.
std::string quoted(std::string_view text);

}  // namespace servogate::machine
