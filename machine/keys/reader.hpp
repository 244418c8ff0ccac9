// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "machine/config.hpp"
#include "machine/keys/document.hpp"
#include "machine/keys/key.hpp"

namespace servogate::machine {

using Places = std::map<std::string, Where, std::less<>>;

/// What is written down while a file is read.
struct Reading {
  std::string file;
  std::vector<text::Finding> findings;
  Places places;
  std::set<std::string, std::less<>> unread;  ///< keys that are there but whose value was wrong
  std::map<std::string, AxisUnits, std::less<>> axes;  ///< of the file, by letter

  void error(Where at, const text::Entry& entry, std::vector<std::string> arguments);
  void warning(Where at, const text::Entry& entry, std::vector<std::string> arguments);
};

/// Fills `object` (of the section's struct) from a table; every deviation is a finding and the member keeps
/// its default.
void read_section(const Element& table, const Section& section, void* object, Reading& reading);

/// Reads a whole file. False: not even TOML.
bool read_file_text(std::string_view text, const Section& section, void* object, Reading& reading);

/// Calls `visit(key, member, path)` for every key of an object, in the order of the key table, nested tables
/// included.
using Visitor = std::function<void(const Key& key, void* member, const std::string& path)>;
void visit_keys(const Section& section, void* object, const Visitor& visit, const std::string& path = {});

/// Place of a path, or of the nearest table around it.
Where find_place(const Places& places, std::string_view path);
/// Sorts by place, keeping the order of equal ones, and drops doubles.
void sort_findings(std::vector<text::Finding>& findings);
/// "0 to 10 mm", "above 0 mm/s", "at least 1", in both languages (text::both).
std::string range_text(const Rule& rule, AxisUnits axis);
/// The same in the unit in which a value was written: "0.25 to 20 ms".
std::string range_text(const Rule& rule, const Quantity& written);

}  // namespace servogate::machine
