// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "gateway/control/compose/program/program_file.hpp"
#include "kernel/channel/feeder.hpp"
#include "kernel/program/interpreter/interpreter.hpp"
#include "kernel/program/interpreter/restart.hpp"
#include "plc/logic/logic_change.hpp"

namespace servogate::gateway {

/// A run that begins in the middle of its program.
struct ProgramRestart {
  program::RestartAt at;
  double feed_mm_min = 0.0;  ///< of the way there
  bool confirm = false;      ///< each step of it waits for the operator's start
};

/// Something that was changed outside the cycle about what a process will run. Beside the inputs of the
/// cycles this is all that comes from outside; a record keeps both.
struct ProgramChange {
  enum class Kind : std::uint8_t {
    program,  ///< `file` is the program for the next starts, with `tables`
    tables,   ///< the same program with other tables
    block,    ///< the next start in MDI mode runs `block`
    touch,    ///< the next start in MDI mode measures, by the channel::TouchOrder that `block` has as text
    modes,    ///< MDI has its power-on modes again
    restart,  ///< the next run of the program begins in its middle, by `restart`
  };
  Kind kind = Kind::program;
  int process = 0;                          ///< from 0
  std::shared_ptr<const ProgramFile> file;  ///< of `program`, `tables` and `restart`
  program::Tables tables;
  std::string block;
  std::optional<ProgramRestart> restart = {};
};

/// Sees what Control::change() carries out, the subprograms that were read for it, and what
/// Control::prepare() makes ready for the PLC. Called outside the cycle, by one thread at a time.
class ProgramChangeTap {
 public:
  virtual ~ProgramChangeTap() = default;
  virtual void take(const ProgramChange& change) = 0;
  virtual void take(const plc::LogicChange& change) = 0;
  virtual void take_subprogram(int process, std::string_view name, std::string_view text) = 0;
};

/// Another program by its name, as `file` finds it, shown to `tap` (may be nullptr); nullopt: there is none.
std::optional<program::LoadedProgram> load_for(const ProgramFile& file, std::string_view name,
                                               ProgramChangeTap* tap);
/// Constructs interpreters for a change that loads a program; what they read of subprograms is shown to `tap`
/// (may be nullptr).
channel::InterpreterFactory interpreter_factory(const ProgramChange& change, ProgramChangeTap* tap);
/// The same for a change of the kind restart.
channel::RestartFactory restart_factory(const ProgramChange& change, ProgramChangeTap* tap);

}  // namespace servogate::gateway
