// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace servogate::scenario {

/// The form of a key's value.
enum class Form : std::uint8_t {
  text,
  texts,   ///< a text or a list of them
  whole,   ///< a whole number
  wholes,  ///< one, or a list
  boolean,
  time,  ///< "200 ms", "3 s"
  time_or_true,
  value,    ///< a number, true, false, or a text with a unit
  values,   ///< two of them
  words,    ///< a sentence of `do`, or a table with a command of the control socket
  refusal,  ///< true, or the code of a refusal
  condition,
  conditions,
  anchor,  ///< a time or a condition
  fault,
  clear,
  cases,  ///< a list of tables
  steps,
  random,
  actions,
};

/// The tables of a scenario file.
enum class Part : std::uint8_t { file, step, condition, fault, clear, random, action };

/// The one description of every key: the reader, the schema and the reference walk it.
struct KeyRow {
  Part part;
  std::string_view name;
  Form form;
  std::string_view english, russian;
  bool needed = false;
};
std::span<const KeyRow> keys() noexcept;
/// nullptr: this table has no such key.
const KeyRow* find_key(Part part, std::string_view name) noexcept;
/// "equals, differs ..." for a message.
std::string key_names(Part part);

/// A word of `do`: its arguments and what it does.
struct WordRow {
  std::string_view name, arguments, english, russian;
};
std::span<const WordRow> words() noexcept;

/// JSON schema of scenario files, as published in docs/scenario.schema.json.
std::string json_schema();
/// The tables of docs/testing.md: every key, and every word of `do`. `russian`: of docs/ru/testing.md.
std::string key_reference(bool russian);
std::string word_reference(bool russian);

}  // namespace servogate::scenario
