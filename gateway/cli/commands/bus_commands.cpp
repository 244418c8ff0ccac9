// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/commands/bus_commands.hpp"

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/commands/canopen_commands.hpp"
#include "gateway/cli/quantities.hpp"

namespace servogate::gateway {

namespace {

constexpr const char* kJson = "What happens as JSON, one object a line";

void add_bit_rate(CLI::App& app, double& rate) {
  app.add_option("--bit-rate", rate, "Bit rate of the bus in bit/s, 10000 to 1000000")
      ->type_name("BIT/S")
      ->check(number_within({10'000.0, 1e6, text::both("bit/s", "бит/с"), true}));
}

void add_can_bus(CLI::App& can, CanBusOptions& o) {
  CLI::App& bus = *can.add_subcommand(
      "bus", "Serves CAN buses to processes of this computer, in the words of socketcand.");
  bus.add_option("NAME", o.names, "Names of the buses: can0")->required();
  bus.add_option("--listen", o.listen, "HOST:PORT on loopback, or unix:PATH")->type_name("ADDRESS");
  add_bit_rate(bus, o.bit_rate);
  bus.add_option("--lockstep", o.lockstep,
                 "Time waits for so many participants, 1 to 60, and is granted to them")
      ->type_name("N")
      ->check(number_within({1.0, 60.0, text::both("participants", "участников"), true}));
  bus.add_option("--until", o.until, "Lockstep: time ends here, in s")
      ->type_name("S")
      ->check(number_within({0.0, 1e9, text::both("s", "с")}));
  bus.add_option("--log", o.log, "Writes every frame of the first bus to this file, as candump -l does");
  bus.add_flag("--json", o.json, kJson);
  bus.footer("Example: servogate can bus can0 --listen 127.0.0.1:29536");
}

/// 127 is the node-ID of a control's own heartbeat.
constexpr const char* kNodes = "Node-ID, 1 to 126; several with commas";
constexpr const char* kBus = "Url of the bus, or MACHINE.toml#bus";

void add_can_restart(CLI::App& can, CanRestartOptions& o) {
  CLI::App& c =
      *can.add_subcommand("restart", "Lets an interface that went bus-off take part in its bus again.");
  c.add_option("BUS", o.bus, kBus)->required();
  c.add_flag("--json", o.json, "As JSON");
  c.footer("Example: sudo servogate can restart socketcan:can0");
}

void add_faults(CLI::App& app, FaultOptions& o) {
  app.add_option(
         "--fault", o.faults,
         "What goes wrong: \"over_current at=2\", \"pdo_dropped every=3 for=0.5 node=1\"; may be repeated")
      ->type_name("FAULT")
      ->allow_extra_args(false);
  app.add_option("--script", o.script, "File of lines SECONDS FAULT");
}

void add_drive(CLI::App& app, DriveOptions& o) {
  CLI::App& d = *app.add_subcommand("drive", "Simulated CiA 402 drives on a bus, as a process of their own.");
  d.add_option("BUS", o.bus, kBus)->required();
  d.add_option("--node", o.nodes, kNodes)
      ->type_name("N,...")
      ->required()
      ->delimiter(',')
      ->check(number_within({1.0, 126.0, text::both("(node-ID)", "(номер узла)"), true}));
  d.add_option("--device", o.device, "Device file whose motor and name plate the drives have, without .toml")
      ->type_name("NAME");
  d.add_option("--profile", o.profile, "servo (the default), stepper, spindle, or a data sheet: FILE.eds")
      ->type_name("NAME|FILE")
      ->excludes(d.get_option("--device"));
  d.add_option("--plant", o.plant, "Motor and load: inertia=0.002 friction=0.3 gravity=1.5 ...")
      ->type_name("KEY=VALUE")
      ->delimiter(',');
  d.add_option("--switch", o.switches,
               "Switch on an input that follows the shaft, in revolutions: home=1.5..2 positive_limit=3..")
      ->type_name("INPUT=FROM..TO")
      ->delimiter(',');
  d.add_option("--pdo-map", o.pdo_map,
               "What a master may change of the PDO maps: variable, whole (on and off), fixed (nothing)")
      ->type_name("ACCESS")
      ->check(one_of({"variable", "whole", "fixed"}));
  d.add_option("--write-eds", o.write_eds,
               "Writes the EDS of the simulated drive to this file, then goes on");
  add_faults(d, o.faults);
  add_bit_rate(d, o.bit_rate);
  d.add_flag("--json", o.json, kJson);
  d.footer(
      "On standard input it takes faults as --fault, and clear [FAULT], input NAME on|off, load NM, status.\n"
      "Example: servogate drive socketcand:127.0.0.1:29536/can0 --node 1,2,3");
}

void add_terminals(CLI::App& app, const std::string& name, int& count, int most, const std::string& what) {
  app.add_option(name, count, what)
      ->type_name("N")
      ->check(number_within({0.0, static_cast<double>(most), text::both("terminals", "клемм"), true}));
}

void add_io(CLI::App& app, IoOptions& o) {
  CLI::App& c = *app.add_subcommand(
      "io", "Simulated I/O modules (CiA 401) or encoders (CiA 406) on a bus, in their own process.");
  c.add_option("BUS", o.bus, kBus)->required();
  c.add_option("--node", o.nodes, kNodes)
      ->type_name("N,...")
      ->required()
      ->delimiter(',')
      ->check(number_within({1.0, 126.0, text::both("(node-ID)", "(номер узла)"), true}));
  c.add_option("--kind", o.kind, "module (the default) or encoder")
      ->type_name("KIND")
      ->check(one_of({"module", "encoder"}));
  add_terminals(c, "--di", o.digital_inputs, 64, "Digital inputs, 0 to 64");
  add_terminals(c, "--dq", o.digital_outputs, 64, "Digital outputs, 0 to 64");
  add_terminals(c, "--ai", o.analogue_inputs, 12, "Analogue inputs, 0 to 12");
  add_terminals(c, "--aq", o.analogue_outputs, 12, "Analogue outputs, 0 to 12");
  const auto counted =
      number_within({1.0, 65535.0, text::both("(counts, turns)", "(дискрет, оборотов)"), true});
  c.add_option("--counts", o.counts_per_rev, "Encoder: counts per turn, 1 to 65535")
      ->type_name("N")
      ->check(counted);
  c.add_option("--turns", o.revolutions, "Encoder: turns it can tell apart, 1 to 65535")
      ->type_name("N")
      ->check(counted);
  add_bit_rate(c, o.bit_rate);
  c.add_flag("--json", o.json, kJson);
  c.footer(
      "On standard input it takes di3 on, di3 off, ai0 1200, status; an encoder position 1200, speed 500,\n"
      "blind on, blind off, status. It prints its outputs as they change.\n"
      "Example: servogate io socketcand:127.0.0.1:29536/can0 --node 9");
}

void add_sim(CLI::App& app, SimOptions& o) {
  CLI::App& s = *app.add_subcommand(
      "sim", "All simulated devices of a machine, for somebody else's controller, in the computer's time.");
  s.add_option("MACHINE", o.machine, "Machine file (TOML)")->required();
  s.add_option("--bus", o.buses, "Serves a bus of the machine elsewhere: can=socketcand:127.0.0.1:29536/can0")
      ->type_name("NAME=URL")
      ->allow_extra_args(false);
  add_faults(s, o.faults);
  s.add_flag("--json", o.json, kJson);
  s.footer("Example: servogate sim examples/mill/machine.toml --bus can=socketcan:vcan0");
}

void add_dump(CLI::App& app, DumpOptions& o) {
  CLI::App& d = *app.add_subcommand("dump", "Prints what passes on a bus, as `candump -L` does.");
  d.add_option("BUS", o.bus, kBus)->required();
  d.add_option("--count", o.count, "Ends after so many frames")
      ->type_name("N")
      ->check(number_within({1.0, 1e12, text::both("frames", "кадров"), true}));
  d.add_option("--seconds", o.seconds, "Ends after so many seconds")
      ->type_name("S")
      ->check(number_within({0.001, 1e9, text::both("s", "с")}));
  add_bit_rate(d, o.bit_rate);
  d.add_flag("--json", o.json, "Frames as JSON, one object a line");
  d.footer("Example: servogate dump socketcan:can0 > run.log");
}

void add_play(CLI::App& app, PlayOptions& o) {
  CLI::App& p = *app.add_subcommand("play", "Sends the frames of a candump log again, in their rhythm.");
  p.add_option("BUS", o.bus, kBus)->required();
  p.add_option("FILE", o.file, "Log of `servogate dump` or `candump -l`")->required();
  p.add_option("--speed", o.speed, "Times the log's own speed, 0.001 to 100000")
      ->type_name("TIMES")
      ->check(number_within({0.001, 1e5, text::both("times", "раз")}));
  p.add_option("--node", o.nodes,
               "Only frames to and from these nodes, and SYNC and TIME; several with commas")
      ->type_name("N,...")
      ->delimiter(',')
      ->check(number_within({1.0, 127.0, text::both("(node-ID)", "(номер узла)"), true}));
  p.add_option("--from", o.sender, "Only what a master sent, or only what devices sent")
      ->type_name("SENDER")
      ->check(one_of({"master", "devices"}));
  p.add_option("--id", o.ids, "Only these identifiers, hexadecimal: 181, 180-1FF; several with commas")
      ->type_name("ID,...")
      ->delimiter(',');
  p.add_flag("--i-may-move", o.may_move, "Real drives on the bus may move");
  add_bit_rate(p, o.bit_rate);
  p.add_flag("--json", o.json, "As JSON");
  p.footer("Example: servogate play socketcan:vcan0 run.log --from master");
}

}  // namespace

void add_bus_commands(CLI::App& app, BusCommands& options) {
  CLI::App& can = *app.add_subcommand("can", "CAN buses without a machine.");
  can.require_subcommand(1);
  add_can_bus(can, options.can_bus);
  add_can_check(can, options.can_check);
  add_can_restart(can, options.can_restart);
  add_drive(app, options.drive);
  add_io(app, options.io);
  add_sim(app, options.sim);
  add_dump(app, options.dump);
  add_play(app, options.play);
}

}  // namespace servogate::gateway
