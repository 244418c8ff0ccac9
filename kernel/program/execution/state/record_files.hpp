// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware_if/image/packets.hpp"

namespace servogate::program {

/// A file of records that programs write and read; its records are numbered from 1.
struct RecordFile {
  struct Field {
    image::Format format = image::Format::lr;  ///< in, re, lr or ch
    std::uint8_t length = 1;                   ///< of ch, bytes
    bool operator==(const Field&) const = default;
  };
  struct Item {
    double number = 0.0;
    std::string text;  ///< of a ch field
    bool operator==(const Item&) const = default;
  };
  using Record = std::vector<Item>;  ///< one for each field
  std::vector<Field> fields;
  int capacity = 0;               ///< records
  std::map<int, Record> records;  ///< those that were written; the others hold zeros and blanks
  bool operator==(const RecordFile&) const = default;
  bool same_layout(const RecordFile& other) const {
    return fields == other.fields && capacity == other.capacity;
  }
};
using RecordFiles = std::map<std::string, RecordFile>;  ///< by name

/// What a program has bound and opened of them; gone with the end of its run.
struct OpenRecords {
  /// A variable that a field is read into and written from.
  struct Variable {
    image::Place place;
    int parameter = -1;  ///< -1: the place
  };
  struct Structure {
    std::vector<Variable> variables;
    std::vector<RecordFile::Field> fields;
  };
  struct Channel {
    std::string file;
    bool writes = false;
    int next = 1;  ///< record behind the last one that was read or written
  };
  std::map<int, Structure> structures;
  std::map<int, Channel> channels;
};

/// Carries over to `into` what differs between two states, record by record where the layout is the same.
inline void carry_over(const RecordFiles& before, const RecordFiles& after, RecordFiles& into) {
  for (const auto& [name, is] : after) {
    const auto was = before.find(name);
    if (was != before.end() && was->second == is) continue;
    const auto old = into.find(name);
    if (was == before.end() || old == into.end() || !was->second.same_layout(is) ||
        !old->second.same_layout(is)) {
      into[name] = is;
      continue;
    }
    for (const auto& [number, record] : is.records)
      if (const auto same = was->second.records.find(number);
          same == was->second.records.end() || same->second != record)
        old->second.records[number] = record;
    for (const auto& [number, record] : was->second.records)
      if (!is.records.contains(number)) old->second.records.erase(number);
  }
  for (const auto& [name, file] : before)
    if (!after.contains(name)) into.erase(name);
}

}  // namespace servogate::program
