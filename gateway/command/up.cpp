// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/canopen/bus/sole_master.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/machine_start.hpp"
#include "gateway/command/outputs.hpp"
#include "gateway/command/run_faults.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/command/simulated/input_lines.hpp"
#include "gateway/control/history/event_log.hpp"
#include "gateway/control/history/texts.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/server/desk/desk.hpp"
#include "gateway/control/server/modbus/modbus_server.hpp"
#include "gateway/control/server/pendant/pendant_client.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "gateway/control/server/socket/socket_path.hpp"
#include "gateway/control/server/socket/socket_server.hpp"
#include "report/report.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kListening{"up.listening", "{0} is up; control socket {1}",
                             "{0} работает; сокет управления {1}"};
const text::Entry kNoSocket{"up.no-socket", "cannot listen on {0}: {1}", "не удаётся слушать {0}: {1}"};
const text::Entry kModbusListening{"up.modbus-listening", "Modbus TCP on {0}", "Modbus TCP на {0}"};
const text::Entry kStateLost{"up.state-not-saved", "the state was not saved: {0}",
                             "состояние не сохранено: {0}"};

/// Its state directory: none in virtual time unless told to.
std::string state_folder(const UpOptions& options, const machine::MachineConfig& machine, ClockKind clock) {
  if (!options.state.empty()) return options.state;
  return clock == ClockKind::virtual_time ? std::string() : machine.resolve(machine.run.state);
}

std::string socket_of(const UpOptions& options, const machine::MachineConfig& machine) {
  return !options.socket.empty()       ? options.socket
         : !machine.run.socket.empty() ? machine.resolve(machine.run.socket)
                                       : default_socket(machine.name);
}

/// Composed, or nullptr with the exit code.
std::unique_ptr<RunningMachine> compose(const UpOptions& options, const machine::LoadResult& loaded,
                                        ClockKind clock, std::unique_ptr<HeldState> state, int& code) {
  std::vector<text::Finding> findings;
  auto running = RunningMachine::compose(loaded, std::move(state),
                                         {.clock = clock,
                                          .pace = clock == ClockKind::virtual_time ? options.speed : 0.0,
                                          .record = options.record,
                                          .can_log = options.can_log,
                                          .announce = to_standard_error()},
                                         findings);
  const int errors = print_findings(findings);
  if (running == nullptr) {
    code = errors > 0 && !Control::infrastructure(findings) ? kWrongUse : kInfrastructure;
    return nullptr;
  }
  drivers::Notice why;
  if (options.capture.asked() && !running->capture(options.capture, why)) {
    complain(*why.entry, why.arguments);
    code = kWrongUse;
    return nullptr;
  }
  if (const std::string folder = state_folder(options, loaded.machine, clock); !folder.empty())
    running->keep_black_box(folder + "/blackbox");
  return running;
}

/// Starts the Modbus server of the machine file. False: it cannot, which has been said.
bool open_modbus(const machine::ModbusServerConfig& config, Desk& desk,
                 std::unique_ptr<ModbusServer>& server) {
  if (config.listen.empty()) return true;
  drivers::Notice why;
  server = ModbusServer::open(config, desk, why);
  if (server == nullptr) {
    complain(*why.entry, why.arguments);
    return false;
  }
  tell(text::render(kModbusListening, std::vector<std::string>{config.listen}, text::user_language()));
  return true;
}

using Pendants = std::vector<std::unique_ptr<PendantClient>>;

/// Starts the clients of the pendants of the machine file. False: one cannot, which has been said.
bool open_pendants(Control& control, Desk& desk, Pendants& pendants) {
  for (const machine::PendantConfig& config : control.machine().pendants) {
    drivers::Notice why;
    pendants.push_back(PendantClient::open(control, config, desk, to_standard_error(), why));
    if (pendants.back() != nullptr) continue;
    complain(*why.entry, why.arguments);
    return false;
  }
  return true;
}

/// Until somebody ends it, and everything rests. Lines of standard input are faults of what is simulated.
void serve(Desk& desk, SocketServer& server, std::unique_ptr<ModbusServer>& modbus, Pendants& pendants,
           RunningMachine& running) {
  RunFaults faults(running);
  InputLines input(true);
  const auto seen = std::make_unique<image::ProcessImage>();
  while (signals_seen() == 0 && !desk.down_requested()) {
    running.control().cycle().read(*seen);
    while (const auto line = input.next())
      if (faults.take(*line, seen->now.t_ns)) tell(*line);
    faults.poll(seen->now.t_ns);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  desk.shut_down();
  while (!desk.at_rest()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  modbus.reset();
  pendants.clear();
  desk.stop();  // whoever still waits is answered
  server.stop();
}

/// Keeps what was learned and closes the files. False: something was lost, which has been said.
bool put_away(RunningMachine& running, Resident& resident) {
  const std::string problem = resident.save();
  running.stop();
  const std::string unkept = running.keep_retained();
  const auto lost = running.close_files();
  if (!problem.empty()) complain(kStateLost, {problem});
  if (!unkept.empty()) complain(kStateLost, {unkept});
  for (const RunningMachine::Lost& l : lost) complain(kCannotWrite, {l.path, l.why});
  return problem.empty() && unkept.empty() && lost.empty();
}

}  // namespace

int up(const UpOptions& options) {
  const machine::LoadResult loaded = machine::load(options.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  const machine::MachineConfig& m = loaded.machine;
  ClockKind clock = options.clock;
  if (!settle_clock(m, clock)) return kWrongUse;
  const std::string folder = state_folder(options, m, clock);
  int code =
      check_outputs({{"--record", options.record}, {"--capture", options.capture.file}}, folder, loaded, {});
  if (code == kDone) code = check_can_log(options.can_log, loaded);
  if (code != kDone) return code;
  std::unique_ptr<history::EventLog> history;  // the last to go
  std::unique_ptr<SocketServer> server;        // its connections end last, after the state's lock
  auto state = hold_state(folder, m, code);
  if (state == nullptr) return code;
  SoleMaster sole_master;
  if (code = sole_master.claim(loaded); code != kDone) return code;
  const auto running = compose(options, loaded, clock, std::move(state), code);
  if (running == nullptr) return code;
  if (code = SoleMaster::listen(running->control()); code != kDone) return code;

  history = std::make_unique<history::EventLog>(history::EventLog::Places{folder, true});
  Resident resident(running->control(), running->learned(), folder,
                    clock == ClockKind::virtual_time ? options.speed : 1.0);
  resident.announce_to(to_standard_error());
  resident.keep_history(*history);
  resident.keep_blocks(running->journal());
  if (clock != ClockKind::virtual_time) resident.requests().set_longest_wait(RequestDesk::kLongestWait);
  const std::string socket = socket_of(options, m);
  count_signals();  // from here on there is something to be put away
  if (clock != ClockKind::virtual_time) refuse_suspension();
  Desk desk(resident);
  server = std::make_unique<SocketServer>(desk, socket);
  if (const std::string problem = server->bind(); !problem.empty()) {
    complain(kNoSocket, {socket, problem});
    return kInfrastructure;
  }
  if (!begin(*running)) return kInfrastructure;
  desk.start();
  std::unique_ptr<ModbusServer> modbus;
  if (!open_modbus(m.modbus_server, desk, modbus)) return kInfrastructure;
  Pendants pendants;
  if (!open_pendants(running->control(), desk, pendants)) return kInfrastructure;
  server->start();
  tell(text::render(kListening, std::vector<std::string>{m.name, socket}, text::user_language()));
  if (options.json)
    print_json_line({{"event", "up"},
                     {"machine", m.name},
                     {"socket", socket},
                     {"clock", name_of(clock)},
                     {"version", report::build_identity().version}});
  history->note(
      history::event("up", history::says::kUp, {m.name, std::string(report::build_identity().version)}, 0.0));
  serve(desk, *server, modbus, pendants, *running);
  const double ended_s = static_cast<double>(resident.image().now.t_ns) * 1e-9;
  history->note(history::event("down", history::says::kDown, {m.name}, ended_s));
  const bool saved = put_away(*running, resident);
  int ended = saved ? desk.rests() ? kDone : kAlarm : kInfrastructure;
  ended = unless_frames_lost(ended, running->control());
  if (options.json)
    print_json_line({{"event", "down"},
                     {"machine", m.name},
                     {"t", ended_s},
                     {"at_rest", desk.rests()},
                     {"saved", saved},
                     {"exit", ended}});
  return ended;
}

}  // namespace servogate::gateway::command
