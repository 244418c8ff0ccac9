// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/alarm_numbers.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::image {

/// When an alarm may go.
enum class ResetCondition : std::uint8_t {
  reset,       ///< the operator's reset is enough
  cause_gone,  ///< reset, after the cause has gone
  by_itself,   ///< a warning that goes with its cause: one of a program with the start of the next one, one
               ///< of a homing with the next one that reaches its end
};

/// What the cycle has to know of an alarm beside its reaction.
enum class AlarmMark : std::uint8_t {
  none,
  of_part,        ///< a part of a device is gone: the cause lasts while AlarmRecord::part, or any part of its
                  ///< device where it names none, is not in the image
  fails_control,  ///< no cycles in time, or no logic that looks after the machine
};

/// One kind of alarm. Texts have the placeholders {0} axis, {1} value, {2} limit, {3} part, device or source,
/// {4} status word in words, {5} error code in words, {6} and {7} detail1 and detail2, {8} object, {9} file
/// and line of the block ("bracket.nc:12"; of the PLC: the number of its line).
struct AlarmRow {
  AlarmNumber number = 0;
  Reaction reaction = Reaction::none;  ///< default; the machine file may ask for a stronger one
  ResetCondition reset = ResetCondition::reset;
  text::Entry text;  ///< what happened; its id is the alarm's name in documents and JSON
  std::string_view remedy_en;
  std::string_view remedy_ru;
  AlarmMark mark = AlarmMark::none;
};

struct AlarmNames;

/// What stands for {0} to {9}.
using AlarmArguments = std::array<std::string, 10>;

/// What a program reads of an alarm beside the fields that all have: "node": 3, "object": "0x1018:2".
struct AlarmFact {
  std::string_view key;
  std::variant<std::int64_t, std::string> value;
};

/// How a room speaks of the alarms that it raises, where the common words (alarm_text.hpp) do not know
/// enough. Not real-time safe.
class AlarmWords {
 public:
  virtual ~AlarmWords() = default;
  /// Replaces arguments that the common words have set.
  virtual void arguments(const AlarmRecord&, const AlarmNames&, text::Language, AlarmArguments&) const {}
  /// Follows the sentence; empty: nothing.
  virtual std::string appendix(const AlarmRecord&, text::Language) const { return {}; }
  virtual std::vector<AlarmFact> facts(const AlarmRecord&) const { return {}; }
};

/// The alarms of one room, as it hands them in. Both outlive the table; `words` may be nullptr.
struct AlarmRoom {
  std::span<const AlarmRow> rows;
  const AlarmWords* words = nullptr;
};

/// The one table of all alarms of a control, by rising number. Made before the cycle; reading is real-time
/// safe.
class AlarmTable {
 public:
  AlarmTable() = default;
  /// Throws std::logic_error where two rooms have the same number. Not real-time safe.
  explicit AlarmTable(std::initializer_list<AlarmRoom> rooms);

  /// nullptr: there is no such alarm.
  const AlarmRow* find(AlarmNumber number) const noexcept;
  /// The words of the room that raises it; nullptr: the common ones only.
  const AlarmWords* words(AlarmNumber number) const noexcept;
  AlarmMark mark(AlarmNumber number) const noexcept;
  std::vector<const AlarmRow*> rows() const;

 private:
  struct Item {
    const AlarmRow* row;
    const AlarmWords* words;
  };
  const Item* item(AlarmNumber number) const noexcept;

  std::vector<Item> items_;
};

}  // namespace servogate::image
