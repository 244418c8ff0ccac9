// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gateway/control/server/desk/dispatch/bus_reading.hpp"
#include "gateway/control/server/desk/dispatch/dispatch.hpp"
#include "gateway/control/server/desk/dispatch/status.hpp"
#include "gateway/control/server/desk/dispatch/table_rows.hpp"
#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::gateway {

using image::RequestKind;

/// mm/min, of the way to a block and of the way back to a held program.
inline constexpr double kSlowestWay = 1.0, kFastestWay = 5000.0;

/// Proves loaded programs with other tables, and goes on with `then`.
Work prove_and(Resident& resident, Resident::Proof proof, Finish then);

/// One request under way: dispatch.cpp has what concerns the machine, programs.cpp what loads and runs
/// programs, beside.cpp what is done beside a held one, tables.cpp what changes origins and tools.
class Dispatch {
 public:
  Dispatch(Resident& resident, PlcDesk& plc, const Question& question)
      : resident_(resident), plc_(plc), question_(question), language_(question.caller.language) {}

  Outcome run();
  Outcome loaded(Resident::Load& load, const ask::Load& wanted);
  Outcome found(const Resident::RestartSearch& search, const ask::Restart& wanted);

 private:
  /// An accepted request.
  template <typename Content = std::monostate>
  Reply good(const text::Entry& entry, const std::vector<std::string>& arguments = {},
             Content content = {}) const {
    return accept(entry, arguments, language_, std::move(content));
  }
  Reply fail(const text::Entry& entry, const std::vector<std::string>& arguments, int exit) const {
    return refuse(entry, arguments, exit, language_);
  }

  /// Puts a request to the gate. True: accepted; otherwise `refusal_` holds the answer.
  /// `mode`: the mode that belongs to it; a refused request leaves the process in the one it was in.
  /// `process`: -1: that of the axis, the first where there is none.
  bool ask(RequestKind kind, int axis = -1, double value = 0.0, std::optional<image::Mode> mode = {},
           int process = -1);
  bool ask(image::Request request);
  /// Index of an axis; -1: `refusal_` holds the answer.
  int axis(const std::string& letter);
  /// The machine has it; false: `refusal_` holds the answer.
  bool process_known(int process);
  int process_of(int axis) { return resident_.image().axes[static_cast<std::size_t>(axis)].process; }
  bool unit_is_own(int axis, const std::string& said);
  /// The same request once more, behind the proof of the loaded program with the tables as they are now.
  Outcome behind(Resident::Proof proof);

  // One for each kind of question.
  Outcome take(const ask::Status&) { return looked(status_report(resident_, plc_, language_)); }
  Outcome take(const ask::Buses&) { return looked(held_buses(machine(), resident_.image(), false)); }
  Outcome take(const ask::Alarms&) { return looked(alarm_report(resident_, language_)); }
  Outcome take(const ask::History& wanted) {
    const double most = history::EventLog::kRemembered;
    const auto count = static_cast<std::size_t>(std::clamp(wanted.count, 0.0, most));
    return looked(history_report(resident_.history(), count, language_));
  }
  Outcome take(const ask::SdoRead& wanted) {
    const RequestDesk& requests = resident_.requests();
    return sdo_read(resident_.control(), wanted, language_,
                    requests.stepped() ? std::function<bool()>([&] { return requests.pause(); })
                                       : std::function<bool()>());
  }
  Outcome take(const ask::Power&);
  Outcome take(const ask::Home&);
  Outcome take(const ask::Jog&);
  Outcome take(const ask::JogContinuous&);
  Outcome take(const ask::Zero&);
  Outcome take(const ask::Override&);
  Outcome take(const ask::PathWheel&);
  Outcome take(const ask::Load&);
  Outcome take(const ask::Start& wanted) { return begin(false, wanted.process); }
  Outcome take(const ask::Step& wanted) { return begin(true, wanted.process); }
  Outcome take(const ask::Mdi&);
  Outcome take(const ask::Touch&);
  Outcome take(const ask::Restart&);
  Outcome take(const ask::Return&);
  Outcome take(const ask::Retrace&);
  Outcome take(const ask::Resume&);
  Outcome take(const ask::Assign&);
  Outcome take(const ask::Tables&) { return looked(tables_report(resident_)); }
  Outcome take(const ask::TableSet&);
  Outcome take(const ask::TableClear&);
  Outcome take(const ask::TableUndo&);
  Outcome take(const ask::TableImport&);
  Outcome take(const ask::TableExport&);
  Outcome take(const ask::Reset&) { return reset(true); }
  Outcome take(const ask::Acknowledge&) { return reset(false); }
  Outcome take(const ask::Input&);
  Outcome take(const ask::SetPlace&);

  template <typename Content>
  static Reply looked(Content content) {
    Reply reply;
    reply.content = std::move(content);
    return reply;
  }
  std::string with_findings(const text::Entry& entry, const std::string& program,
                            const std::vector<text::Finding>& findings) const;
  /// What the gate would say: a program is under way.
  Reply busy(int process) const {
    const auto why =
        resident_.stopping(process) ? cycle::Refusal::program_stopping : cycle::Refusal::program_runs;
    return fail(cycle::refusal_texts()[static_cast<std::size_t>(why)], {}, kAlarm);
  }
  /// The gate agrees to a change of the tables; `touched`: axes whose place is taken over, as bits.
  bool ask_for_tables(std::uint32_t touched);
  /// Answers with `done` when the loaded programs go by the changed tables, and they lie on the disk.
  Outcome with_new_tables(const Reply& done);
  /// What keeps the loaded program from a start; nullopt: nothing.
  std::optional<Outcome> not_ready(int process);
  RestartReport report_of(const Resident::RestartSearch& search, const ask::Restart& wanted);
  Outcome begin(bool step, int process);
  /// A typed block beside a held program.
  Outcome functions(const ask::Mdi& wanted);
  /// The request that a command of such a block is, none where it does nothing; else why it may not be.
  const text::Entry* function_of(const program::Command& command, int process,
                                 std::optional<image::Request>& request);
  std::optional<Reply> wrong_touch(const ask::Touch& wanted, const machine::AxisConfig& axis) const;
  Outcome reset(bool whole);
  /// To the answer "not powered": each condition that is missing.
  void add_missing(Reply& answer);
  const machine::MachineConfig& machine() const { return resident_.control().machine(); }
  const machine::AxisConfig& axis_config(int index) const {
    return machine().axes[static_cast<std::size_t>(index)];
  }

  Resident& resident_;
  PlcDesk& plc_;
  const Question& question_;
  text::Language language_;
  Reply refusal_;
};

}  // namespace servogate::gateway
