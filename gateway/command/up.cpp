// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "gateway/cli/messages.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/canopen/bus/sole_master.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/outputs.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/machine/state/state.hpp"
#include "gateway/machine/state/state_lock.hpp"
#include "gateway/run/can_log.hpp"
#include "gateway/run/realtime_loop.hpp"
#include "gateway/run/record_file.hpp"
#include "gateway/run/retained_keeper.hpp"
#include "gateway/server/socket/socket_path.hpp"
#include "gateway/server/socket/socket_server.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kListening{"up.listening", "{0} is up; control socket {1}",
                             "{0} работает; сокет управления {1}"};
const text::Entry kNoSocket{"up.no-socket", "cannot listen on {0}: {1}", "не удаётся слушать {0}: {1}"};
const text::Entry kStateLost{"up.state-not-saved", "the state was not saved: {0}",
                             "состояние не сохранено: {0}"};

/// Virtual time paced against the wall clock on a thread of its own.
class VirtualLoop {
 public:
  VirtualLoop(Control& control, double speed, RecordWriter* record, const CanLog* can_log)
      : control_(control), speed_(speed), record_(record), can_log_(can_log), thread_([this] { run(); }) {}
  ~VirtualLoop() {
    stop_ = true;
    thread_.join();
  }

 private:
  void run() {
    using Clock = std::chrono::steady_clock;
    Clock::time_point begin = Clock::now();
    const double period_s = static_cast<double>(control_.cycle().period_ns()) * 1e-9;
    while (!stop_) {
      const double due_s = static_cast<double>(control_.cycle().count()) * period_s / speed_;
      const Clock::time_point due = begin + std::chrono::nanoseconds(static_cast<std::int64_t>(due_s * 1e9));
      const Clock::time_point now = Clock::now();
      // A sleep a millisecond: faster than real time several cycles share one.
      if (due > now) std::this_thread::sleep_until(due);
      // What was lost (a slow computer, a laptop that slept) is not made up for in a burst.
      if (now > due + std::chrono::milliseconds(100)) begin += now - due;
      if (control_.cycle().count() % 64 == 0) std::this_thread::yield();
      if (record_ != nullptr) record_->wait_for_room();
      if (can_log_ != nullptr) can_log_->wait_for_room();
      control_.step();
    }
  }
  Control& control_;
  double speed_;
  RecordWriter* record_;
  const CanLog* can_log_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace

int up(const UpOptions& options) {
  const machine::LoadResult loaded = machine::load(options.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  const machine::MachineConfig& m = loaded.machine;
  const ClockKind clock = options.clock != ClockKind::unset      ? options.clock
                          : m.virtual_time() && m.nothing_real() ? ClockKind::virtual_time
                                                                 : ClockKind::realtime;
  const bool is_virtual = clock == ClockKind::virtual_time;
  for (const machine::BusConfig& bus : m.buses)
    if (is_virtual && !bus.mock() && !bus.lockstep()) {
      complain(kVirtualNeedsMock, {bus.url});
      return kWrongUse;
    }
  // A virtual run leaves no state behind unless told to.
  const std::string state_path = !options.state.empty() ? options.state
                                 : is_virtual           ? std::string()
                                                        : m.resolve(m.run.state);
  if (const int code = check_outputs({{"--record", options.record}}, state_path, loaded, {}); code != kDone)
    return code;
  if (const int code = check_can_log(options.can_log, loaded); code != kDone) return code;
  std::unique_ptr<SocketServer> server;  // its connections end last, after the state's lock
  machine::MachineState state;
  machine::StateLock lock;
  if (!state_path.empty()) {
    if (const std::string why = lock.take(state_path); !why.empty()) {
      complain(machine::kStateTaken, {state_path, why});
      return kInfrastructure;
    }
    machine::StateDirectory::Loaded kept = machine::StateDirectory(state_path).load();
    if (print_findings(kept.findings) > 0) return kWrongUse;
    state = std::move(kept.state);
  }
  SoleMaster sole_master;
  if (const int code = sole_master.claim(loaded); code != kDone) return code;
  std::vector<text::Finding> findings;
  const std::unique_ptr<Control> control = Control::compose(loaded, findings);
  const int errors = print_findings(findings);
  if (control == nullptr)
    return errors > 0 && !Control::infrastructure(findings) ? kWrongUse : kInfrastructure;
  if (const int code = SoleMaster::listen(*control); code != kDone) return code;
  if (is_virtual) control->cycle().set_time_scale(options.speed);
  control->restore_references(state);
  control->restore_tool(state);
  print_findings(control->restore_retained(state));
  const std::unique_ptr<RecordWriter> record =
      options.record.empty() ? nullptr : begin_record(options.record, options.machine, state, *control);
  const auto can_log =
      options.can_log.empty() ? nullptr : std::make_unique<CanLog>(options.can_log, *control);
  control->cycle().publish_every(is_virtual ? 1 : 5);
  control->world().close_operator_points();

  RetainedKeeper keeper(*control, state_path, state.retained_generation);
  Resident resident(*control, std::move(state), state_path, is_virtual ? options.speed : 1.0);
  const std::string socket = !options.socket.empty() ? options.socket
                             : !m.run.socket.empty() ? m.resolve(m.run.socket)
                                                     : default_socket(m.name);
  count_signals();  // from here on there is something to be put away
  if (!is_virtual) refuse_suspension();
  server = std::make_unique<SocketServer>(resident, socket);
  if (const std::string problem = server->bind(); !problem.empty()) {
    complain(kNoSocket, {socket, problem});
    return kInfrastructure;
  }

  std::unique_ptr<VirtualLoop> virtual_loop;
  std::unique_ptr<RealtimeLoop> realtime_loop;
  if (is_virtual) {
    virtual_loop = std::make_unique<VirtualLoop>(*control, options.speed, record.get(), can_log.get());
  } else {
    cycle::RealtimeSettings settings{m.realtime.priority, m.realtime.cpu,
                                     clock == ClockKind::realtime_best_effort};
    realtime_loop =
        std::make_unique<RealtimeLoop>(*control, settings, [](Control&, image::Nanoseconds) noexcept {});
    const bool started = realtime_loop->start();
    realtime_loop->complain_of_refusals(started);
    if (!started) return kInfrastructure;
  }
  server->start();
  std::fprintf(
      stderr, "%s\n",
      text::render(kListening, std::vector<std::string>{m.name, socket}, text::user_language()).c_str());
  while (signals_seen() == 0 && !server->down_requested())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  server->shut_down();
  while (!server->at_rest()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  server->stop();
  const std::string problem = resident.save();
  virtual_loop.reset();
  if (realtime_loop != nullptr) realtime_loop->stop();
  control->take_leave();
  const std::string unkept = keeper.close();
  const std::string unrecorded = record != nullptr ? record->close() : std::string();
  const std::string unlogged = can_log != nullptr ? can_log->close() : std::string();
  if (!problem.empty()) complain(kStateLost, {problem});
  if (!unkept.empty()) complain(kStateLost, {unkept});
  if (!unrecorded.empty()) complain(kCannotWrite, {options.record, unrecorded});
  if (!unlogged.empty()) complain(kCannotWrite, {options.can_log, unlogged});
  const int code = unless_frames_lost(server->rests() ? kDone : kAlarm, *control);
  return problem.empty() && unkept.empty() && unrecorded.empty() && unlogged.empty() ? code : kInfrastructure;
}

}  // namespace servogate::gateway::command
