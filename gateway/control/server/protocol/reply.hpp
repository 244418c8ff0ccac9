// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "gateway/control/run/exit_code.hpp"
#include "gateway/control/run/words/ready_words.hpp"
#include "gateway/control/server/protocol/plc_reply.hpp"
#include "gateway/control/server/protocol/status_report.hpp"
#include "kernel/program/commands/canonical.hpp"
#include "kernel/program/execution/state/machine.hpp"

namespace servogate::gateway {

/// A continuous jog has begun; it lives while its client says so at least this often.
struct JogBegun {
  int axis = 0;
  image::Hand hand;  ///< that holds it
  double keep_alive_ms = 0.0;
};
/// What a keep-alive is answered with.
struct JogState {
  bool moving = false;      ///< something that this client jogs goes on
  std::string axis;         ///< whose jog has ended; empty: none has
  std::string_view reason;  ///< why, by name
};
struct Zeroed {
  int origin = 0;      ///< number of the origin in force
  double place = 0.0;  ///< machine coordinate of its zero now, mm or degrees (radius)
};
/// What was found in a program, loaded or not, or in a typed block.
struct FoundIn {
  std::vector<text::Finding> findings;
};
/// A program has been started.
struct Begun {
  double asked_s = 0.0;  ///< machine time at which that was asked for
};
/// Typed functions are executed beside a held program.
struct FunctionsBegun {};
/// An object of a node: what came of the SDO transfer.
struct ObjectRead {
  std::string_view status;  ///< "done", "aborted", "no_answer"
  std::uint32_t abort = 0;
  std::vector<std::uint8_t> data;
};

/// Origins and tools; lengths are as people see them, a diameter on diameter axes.
struct TablesReport {
  struct Axis {
    std::string letter, unit;
    bool diameter = false;
  };
  program::Tables tables;
  std::vector<Axis> axes;
};
/// A table as a file of another program.
struct ExportedTable {
  std::string content;
};

/// What a start in the middle of a program does, in machine coordinates as people see them.
struct RestartReport {
  struct Axis {
    std::string letter, unit;
    double stands = 0.0, begins = 0.0;  ///< where it is, and where the block begins
  };
  int line = 0;
  std::int64_t executed = 0;  ///< blocks before it
  std::string file, text;     ///< of the block
  std::int32_t tool = 0, corrector = 0;
  std::optional<program::Spindle> spindle;
  std::optional<int> coolant;  ///< M code
  std::vector<int> passed;     ///< M codes that are not repeated
  int writes = 0;              ///< into the packets, which are not repeated
  bool signals = false;        ///< the program reads packets before: their present values were taken
  std::vector<Axis> axes;
  std::vector<std::string> steps;  ///< in words, in their order
  bool from_disk = false;
  std::optional<double> overlap_mm;  ///< from where the block begins to where it was interrupted
  double asked_s = 0.0;              ///< machine time before the start
};

/// What a client of the desk is answered.
struct Reply {
  bool ok = true;
  int exit = kDone;  ///< ExitCode
  std::string code;  ///< of a refusal, and of the end of a jog: the id of its sentence
  std::string text;  ///< in the client's language; empty: the content says it all
  std::variant<std::monostate, JogBegun, JogState, Zeroed, FoundIn, Begun, FunctionsBegun, ObjectRead,
               StatusReport, AlarmReport, HistoryReport, HeldBuses, TablesReport, ExportedTable,
               RestartReport, PlcLoaded, PlcValues, PlcBody, PlcSymbols>
      content = {};
  /// Of a refusal for want of power: what is missing.
  std::optional<std::vector<MissingCondition>> missing = {};
};

/// An accepted request.
template <typename Content = std::monostate>
Reply accept(const text::Entry& entry, const std::vector<std::string>& arguments, text::Language language,
             Content content = {}) {
  Reply reply;
  reply.text = text::render(entry, arguments, language);
  reply.content = std::move(content);
  return reply;
}
/// A refused one.
inline Reply refuse(const text::Entry& entry, const std::vector<std::string>& arguments, int exit,
                    text::Language language) {
  Reply reply;
  reply.ok = false;
  reply.exit = exit;
  reply.code = entry.id;
  reply.text = text::render(entry, arguments, language);
  return reply;
}

}  // namespace servogate::gateway
