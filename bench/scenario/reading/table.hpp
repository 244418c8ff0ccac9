// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "bench/scenario/reading/keys.hpp"
#include "bench/scenario/scenario.hpp"
#include "machine/keys/reader.hpp"

namespace servogate::scenario {

/// A table of the file, read by its keys. What has another form than its key wants is a finding, and counts
/// as missing.
class Table {
 public:
  /// Findings for keys that the part does not have, unless they are `more` (parameters of a fault).
  Table(const machine::Element& element, Part part, machine::Reading& reading, bool more = false);

  bool is_table() const { return element_.kind == machine::Element::Kind::table; }
  Where at() const { return element_.at; }
  const machine::Element* find(std::string_view key) const { return element_.find(key); }
  bool has(std::string_view key) const { return find(key) != nullptr; }
  /// How many of these keys are there.
  int count(std::initializer_list<std::string_view> keys) const;

  std::string text(std::string_view key);
  std::vector<std::string> texts(std::string_view key);
  std::optional<std::int64_t> whole(std::string_view key);
  std::vector<int> wholes(std::string_view key);
  bool flag(std::string_view key, bool otherwise = false);
  std::optional<Nanoseconds> time(std::string_view key);
  std::optional<Nanoseconds> time_of(const machine::Element& value, std::string_view key);
  std::optional<Value> value(std::string_view key);
  /// The tables of a list, or the only one.
  std::vector<const machine::Element*> list(std::string_view key);
  void wrong(const machine::Element& value, std::string_view key, std::string_view english,
             std::string_view russian);

 private:
  const machine::Element& element_;
  machine::Reading& reading_;
};

}  // namespace servogate::scenario
