// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "firmware_if/fault/fault.hpp"
#include "firmware_if/image/time.hpp"
#include "machine/keys/document.hpp"

/// What a scenario file says, as plain data. Times are machine time; nothing here is real-time safe.
namespace servogate::scenario {

using image::Nanoseconds;
using machine::Where;

/// A value as the file has it. A text may be a number with a unit ("20 mm/s") or a word ("held"); what it
/// means is known with its signal only.
struct Value {
  std::variant<bool, double, std::string> is = 0.0;
  Where at;
};

/// Something that is true or false of a machine in each cycle.
struct Condition {
  enum class Kind : std::uint8_t {
    signal,          ///< `signal` by `test` with `value`
    alarm,           ///< each of `numbers` is active, or was raised since the watch began
    no_alarm,        ///< no alarm is active but `numbers`
    standstill,      ///< the axes of `names` stand, after at most `value` of way since the watch began
    path_deviation,  ///< the actual place is within `value` of the path of the set-points since the watch began
    reference,       ///< the signals `names` are within `value` of the file `file` at equal times
    order,           ///< the `parts` have become true one after the other
    all,             ///< of `parts`
    any,             ///< of `parts`
  };
  enum class Test : std::uint8_t {
    equals,
    differs,
    above,
    below,
    at_least,
    at_most,
    between,  ///< `value` to `upper`
    rising,   ///< it has become true, or larger, since the watch began
    falling,
    changes,  ///< it differs from what it was when the watch began
  };
  Kind kind = Kind::signal;
  Test test = Test::equals;
  Where at;
  std::string signal;
  Value value, upper;
  std::optional<Value> tolerance;  ///< of equals, differs
  bool limited = false;            ///< of standstill: `value` limits the way
  std::vector<int> numbers;
  std::vector<std::string> names;
  std::string file;
  Nanoseconds begins = 0;  ///< of reference: its time that the beginning of the watch is compared with
  std::vector<Condition> parts;
};

/// What an operator or client does: a sentence ("jog X +5 mm"), or a command of the control socket.
struct Do {
  std::string words;
  std::optional<machine::Element> command;
  std::string folder;  ///< that its paths start from
  bool wait = false;  ///< until what it begins has ended
  /// The gate is to refuse it: empty text: for whatever reason, else the code of the refusal.
  std::optional<std::string> refused;
  bool either = false;  ///< accepted or refused, both will do
};
struct Inject {
  std::string device;
  fault::Fault fault;
};
struct Clear {
  std::string device;
  std::optional<fault::Kind> kind;  ///< none: all of the device
};
struct Expect {
  Condition condition;
  bool never = false;  ///< the condition must not be true
  enum class Manner : std::uint8_t {
    now,     ///< in the cycle of its anchor
    within,  ///< in one cycle of `time` at least
    always,  ///< in every cycle of `time`; 0: to the end
    until,   ///< in every cycle until `until` is true
  };
  Manner manner = Manner::now;
  Nanoseconds time = 0;
  std::optional<Condition> until;
};

struct Step {
  Where at;
  std::string title;
  enum class Anchor : std::uint8_t {
    step_before,  ///< as soon as that is done
    at,           ///< `time` after the beginning
    after_time,   ///< `time` after the step before
    after,        ///< `time` after the condition `after` has become true
  };
  Anchor anchor = Anchor::step_before;
  Nanoseconds time = 0;
  std::optional<Condition> after;
  std::variant<Do, Inject, Clear, Expect> what;
  bool drawn = false;  ///< by chance, from [random]
};

struct Scenario {
  std::string file;
  Where at;                 ///< of its title, or of its case
  std::string title, name;  ///< `name`: with the parameters of its case and its seed; unique in its file
  std::vector<std::string> verifies, tags;
  std::string machine;  ///< path
  Nanoseconds timeout = 60 * image::kSecond;
  std::string expected_failure, skip;  ///< reasons; empty: none
  std::vector<std::pair<std::string, std::string>> parameters;
  std::optional<std::uint64_t> seed;  ///< of what was drawn by chance
  std::vector<Step> given, steps;
  std::string folder() const;  ///< that its paths start from
};

}  // namespace servogate::scenario
