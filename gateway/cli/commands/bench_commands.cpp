// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/commands/bench_commands.hpp"

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/quantities.hpp"

namespace servogate::gateway {
namespace {

const std::string kRevS = text::both("rev/s", "об/с");

void add_bus_and_node(CLI::App& c, BenchOptions& o) {
  c.add_option("BUS", o.bus, "Url of the bus, or MACHINE.toml#bus")->required();
  c.add_option("NODE", o.node, "Node-ID, 1 to 127")
      ->required()
      ->check(number_within({1.0, 127.0, text::both("(node-ID)", "(номер узла)"), true}));
  c.add_option("--out", o.out, "Directory of the run, made anew")->required()->type_name("DIR");
  c.add_option("--read", o.read, "Objects read by SDO before and after the run, as INDEX[:SUB] or names")
      ->type_name("OBJECT,...")
      ->delimiter(',');
  c.add_option("--eds", o.eds, "Data sheet (EDS or DCF) that knows names and types");
  c.add_option("--limits", o.limits, "File of limits: the run passes or fails by its figures");
  c.add_option("--bit-rate", o.bit_rate, "Bit rate of the bus in bit/s, 10000 to 1000000")
      ->type_name("BIT/S")
      ->check(number_within({10'000.0, 1e6, text::both("bit/s", "бит/с"), true}));
  c.add_option("--listen", o.listen_s, "How long the bus must show no master before, in s, 0.1 to 60")
      ->type_name("S")
      ->check(number_within({0.1, 60.0, text::both("s", "с")}));
  c.add_flag("--json", o.json, "As JSON");
}

void add_drive(CLI::App& c, BenchOptions& o) {
  add_bus_and_node(c, o);
  c.add_option("--travel", o.travel, "Envelope: FROM..TO in revolutions from where the motor stands")
      ->required()
      ->type_name("FROM..TO");
  c.add_option("--speed", o.speed_rev_s, "Envelope: greatest speed in rev/s")
      ->required()
      ->type_name("REV/S")
      ->check(number_within({0.01, 10'000.0, kRevS}));
  c.add_option("--torque", o.torque_nm, "Envelope: greatest torque in N m")
      ->required()
      ->type_name("NM")
      ->check(number_within({1e-6, 1e5, text::both("N m", "Н·м")}));
  c.add_option("--time", o.time_s, "Envelope: longest time with power in s")
      ->type_name("S")
      ->check(number_within({0.1, 3600.0, text::both("s", "с")}));
  c.add_option("--following", o.following_rev, "Envelope: greatest following error in revolutions")
      ->type_name("REV")
      ->check(number_within({1e-6, 1e4, text::both("rev", "об.")}));
  c.add_option("--cycle", o.cycle_us, "Period of SYNC in us, 250 to 20000")
      ->type_name("US")
      ->check(number_within({250.0, 20'000.0, text::both("us", "мкс"), true}));
  c.add_option("--counts", o.counts_per_rev, "Counts of 6064h in a revolution, where 608Fh does not say it")
      ->type_name("N")
      ->check(number_within({4.0, 1e9, ""}));
  c.add_option("--rated-torque", o.rated_torque_nm, "Rated torque in N m, where 6076h does not say it")
      ->type_name("NM")
      ->check(number_within({1e-6, 1e5, text::both("N m", "Н·м")}));
  c.add_option("--velocity-unit", o.velocity_unit,
               "Unit of 60FFh and 6081h: counts (in a second), rpm, 0.1rpm")
      ->type_name("UNIT")
      ->check(one_of({"counts", "rpm", "0.1rpm"}));
  c.add_option("--record", o.record, "Objects recorded by PDO every cycle, as INDEX[:SUB] or names")
      ->type_name("OBJECT,...")
      ->delimiter(',');
  c.add_flag("--i-may-move", o.may_move, "A drive may move");
}

void add_acceleration(CLI::App& c, BenchOptions& o) {
  c.add_option("--acceleration", o.acceleration, "Acceleration in rev/s2")
      ->type_name("REV/S2")
      ->check(number_within({1e-3, 1e6, text::both("rev/s2", "об/с2")}));
}

void add_periods(CLI::App& c, BenchOptions& o) {
  c.add_option("--period", o.period, "Of multisine and prbs: samples of a period, 16 to 1000000")
      ->type_name("N")
      ->check(number_within({16.0, 1e6, "", true}));
  c.add_option("--periods", o.periods, "Of multisine and prbs: how many, 1 to 1000")
      ->type_name("N")
      ->check(number_within({1.0, 1000.0, "", true}));
}

void add_band(CLI::App& c, BenchOptions& o) {
  c.add_option("--from", o.from_hz, "Lowest frequency in Hz, 0.01 to 2000")
      ->type_name("HZ")
      ->check(number_within({0.01, 2000.0, text::both("Hz", "Гц")}));
  c.add_option("--to", o.to_hz, "Highest frequency in Hz, 0.01 to 2000")
      ->type_name("HZ")
      ->check(number_within({0.01, 2000.0, text::both("Hz", "Гц")}));
}

void add_least_load(CLI::App& c, BenchOptions& o) {
  c.add_option(
       "--inertia", o.inertia_kg_m2,
       "Least inertia of motor and load in kg m2, by which --loop torque is looked at before it moves")
      ->type_name("KGM2")
      ->check(number_within({1e-9, 1e3, text::both("kg m2", "кг·м2")}));
  c.add_option("--friction", o.friction_nm, "Least dry friction of both in N m, for the same (default 0)")
      ->type_name("NM")
      ->check(number_within({0.0, 1e4, text::both("N m", "Н·м")}));
}

void add_run(CLI::App& bench, BenchOptions& o) {
  CLI::App& c = *bench.add_subcommand("run", "Gives the drive a test signal and says how it followed.");
  add_drive(c, o);
  c.add_option("--signal", o.signal, "step, ramp, trapezoid, jerk, sine, chirp, multisine or prbs")
      ->required()
      ->check(one_of({"step", "ramp", "trapezoid", "jerk", "sine", "chirp", "multisine", "prbs"}));
  c.add_option("--loop", o.loop, "position, velocity or torque")
      ->required()
      ->check(one_of({"position", "velocity", "torque"}));
  c.add_option("--amplitude", o.amplitude, "Size of the signal in rev, rev/s or N m")
      ->type_name("X")
      ->check(number_within({-1e6, 1e6, ""}));
  c.add_option("--offset", o.offset, "Added to every value of the signal")
      ->type_name("X")
      ->check(number_within({-1e6, 1e6, ""}));
  c.add_option("--duration", o.duration_s, "Length of the signal in s, 0.01 to 3600")
      ->type_name("S")
      ->check(number_within({0.01, 3600.0, text::both("s", "с")}));
  c.add_option("--move-speed", o.move_speed, "Of trapezoid and jerk: speed in rev/s")
      ->type_name("REV/S")
      ->check(number_within({1e-3, 1e4, kRevS}));
  c.add_option("--acceleration", o.acceleration, "Of trapezoid and jerk: acceleration in rev/s2")
      ->type_name("REV/S2")
      ->check(number_within({1e-3, 1e6, text::both("rev/s2", "об/с2")}));
  c.add_option("--jerk", o.jerk, "Of jerk: jerk in rev/s3")
      ->type_name("REV/S3")
      ->check(number_within({1e-3, 1e9, text::both("rev/s3", "об/с3")}));
  c.add_option("--with", o.with,
               "Further nodes that get the same signal in the same cycles, each in its envelope")
      ->type_name("NODE,...")
      ->delimiter(',')
      ->excludes("--read")
      ->check(number_within({1.0, 127.0, text::both("(node-ID)", "(номер узла)"), true}));
  c.add_option("--phase", o.phase_deg, "Of sine with --with: each further node is ahead by so many degrees")
      ->type_name("DEG")
      ->check(number_within({-360.0, 360.0, text::both("degrees", "градусов")}));
  add_band(c, o);
  add_periods(c, o);
  add_least_load(c, o);
  c.footer(
      "Example: servogate bench run socketcan:can0 5 --signal step --loop velocity --amplitude 2 --travel "
      "-1..5 "
      "--speed 5 --torque 1 --out step1 --i-may-move");
}

void add_identify(CLI::App& bench, BenchOptions& o) {
  CLI::App& c = *bench.add_subcommand(
      "identify", "Finds inertia, friction, cogging, resonance and backlash of motor and load.");
  add_drive(c, o);
  o.from_hz = 2.0;
  o.to_hz = 180.0;
  o.time_s = 150.0;
  add_band(c, o);
  c.add_option("--slowest", o.slowest_rev_s, "Slowest speed of the friction curve in rev/s")
      ->type_name("REV/S")
      ->check(number_within({1e-3, 1e3, kRevS}));
  c.add_option("--excitation", o.excitation_nm, "Torque of the frequency response in N m, root mean square")
      ->type_name("NM")
      ->check(number_within({1e-6, 1e4, text::both("N m", "Н·м")}));
  c.add_flag("--no-lost-motion", o.no_lost_motion, "Does not press the motor against the load at rest");
  c.footer(
      "Example: servogate bench identify socketcan:can0 5 --travel -10..400 --speed 20 --torque 2 --out "
      "axis1 "
      "--i-may-move");
}

void add_move(CLI::App& bench, BenchOptions& o) {
  CLI::App& c =
      *bench.add_subcommand("move", "Moves the motor by a distance and says how exactly it arrived.");
  add_drive(c, o);
  o.mode = "csp";
  c.add_option("DISTANCE", o.value, "Revolutions from where the motor stands, with sign")->required();
  c.add_option("--mode", o.mode, "csp: this computer forms the motion; pp: the drive does")
      ->check(one_of({"csp", "pp"}));
  c.add_option("--move-speed", o.move_speed, "Speed in rev/s")
      ->type_name("REV/S")
      ->check(number_within({1e-3, 1e4, kRevS}));
  add_acceleration(c, o);
  c.add_option("--jerk", o.jerk, "Of csp: jerk in rev/s3")
      ->type_name("REV/S3")
      ->check(number_within({1e-3, 1e9, text::both("rev/s3", "об/с3")}));
  c.footer(
      "Example: servogate bench move socketcan:can0 5 -2.5 --travel -3..1 --speed 5 --torque 1 --out move1 "
      "--i-may-move");
}

void add_jog(CLI::App& bench, BenchOptions& o) {
  CLI::App& c = *bench.add_subcommand(
      "jog", "Turns the motor at a speed or with a torque until a key, the end of the travel or --duration.");
  add_drive(c, o);
  o.mode = "csv";
  o.duration_s = 0.0;
  c.add_option("VALUE", o.value, "rev/s, in cst and tq N m, with sign")->required();
  c.add_option("--mode", o.mode, "csp, csv, pv, vl, cst or tq")
      ->check(one_of({"csp", "csv", "pv", "vl", "cst", "tq"}));
  add_acceleration(c, o);
  c.add_option("--duration", o.duration_s, "Ends after so many s; without it a key ends it")
      ->type_name("S")
      ->check(number_within({0.01, 3600.0, text::both("s", "с")}));
  c.footer(
      "Example: servogate bench jog socketcan:can0 5 0.5 --travel -10..10 --speed 2 --torque 1 --out jog1 "
      "--i-may-move");
}

void add_record(CLI::App& bench, BenchOptions& o) {
  CLI::App& c =
      *bench.add_subcommand("record", "Records objects of a drive by PDO, without giving it power.");
  add_bus_and_node(c, o);
  c.add_option("OBJECT", o.record, "What is recorded, as INDEX[:SUB] or names; 16 bytes in all")
      ->required()
      ->expected(1, 16);
  c.add_option("--rate", o.rate_hz, "SYNC in a second, 50 to 4000")
      ->type_name("HZ")
      ->check(number_within({50.0, 4000.0, text::both("Hz", "Гц")}));
  c.add_option("--duration", o.duration_s, "Length of the record in s, 0.01 to 3600")
      ->type_name("S")
      ->check(number_within({0.01, 3600.0, text::both("s", "с")}));
  c.footer(
      "Example: servogate bench record socketcan:can0 5 position_actual dc_link --rate 500 --duration 2 "
      "--out "
      "record1");
}

void add_response(CLI::App& bench, BenchOptions& o) {
  CLI::App& c = *bench.add_subcommand(
      "response", "Takes the frequency response of a loop: bandwidth, margins, resonances.");
  add_drive(c, o);
  o.amplitude = 0.2;
  o.from_hz = 2.0;
  o.to_hz = 300.0;
  o.periods = 12;
  c.add_option("--loop", o.loop, "position, velocity or torque")
      ->required()
      ->check(one_of({"position", "velocity", "torque"}));
  c.add_option("--amplitude", o.amplitude, "Root mean square of the excitation in rev, rev/s or N m")
      ->type_name("X")
      ->check(number_within({1e-9, 1e6, ""}));
  c.add_option("--offset", o.offset, "Added to the excitation: a speed at which the shaft never turns back")
      ->type_name("X")
      ->check(number_within({-1e6, 1e6, ""}));
  add_band(c, o);
  add_periods(c, o);
  add_least_load(c, o);
  c.footer(
      "Example: servogate bench response socketcan:can0 5 --loop velocity --offset 2 --travel -1..60 --speed "
      "5 "
      "--torque 1 --out response1 --i-may-move");
}

void add_tune(CLI::App& bench, BenchOptions& o) {
  CLI::App& c = *bench.add_subcommand(
      "tune", "Proposes gains of the loops by their measured response; with --apply writes and proves them.");
  add_drive(c, o);
  o.amplitude = 0.2;
  o.offset = 2.0;
  o.from_hz = 2.0;
  o.to_hz = 350.0;
  o.periods = 12;
  c.add_option("--gains", o.gains, "File that says in which objects the drive has its gains")->required();
  c.add_option("--phase-margin", o.phase_margin_deg, "Phase margin of the velocity loop in degrees, 30 to 80")
      ->type_name("DEG")
      ->check(number_within({30.0, 80.0, text::both("degrees", "градусов")}));
  c.add_option("--amplitude", o.amplitude, "Excitation of the velocity in rev/s, root mean square")
      ->type_name("REV/S")
      ->check(number_within({1e-6, 1e4, kRevS}));
  c.add_option("--offset", o.offset, "Added to the excitation: a speed at which the shaft never turns back")
      ->type_name("REV/S")
      ->check(number_within({-1e4, 1e4, kRevS}));
  c.add_option(
       "--inner-delay", o.inner_delay_ms,
       "What the drive needs from a measured speed to the torque that follows from it, in ms, 0 to 20")
      ->type_name("MS")
      ->check(number_within({0.0, 20.0, text::both("ms", "мс")}));
  c.add_option("--relay", o.relay_nm,
               "By a relay of this torque in N m instead of a multisine: faster, and blind to resonances")
      ->type_name("NM")
      ->check(number_within({1e-6, 1e4, text::both("N m", "Н·м")}));
  c.add_option("--step", o.step_rev_s, "Step of the velocity that shows the change, in rev/s")
      ->type_name("REV/S")
      ->check(number_within({1e-4, 1e4, kRevS}));
  add_band(c, o);
  add_periods(c, o);
  c.add_flag("--apply", o.apply, "Writes the gains, measures again, and takes them back if they are worse");
  c.footer(
      "Example: servogate bench tune socketcan:can0 5 --gains drive.gains.toml --apply --travel -1..100 "
      "--speed 5 "
      "--torque 2 --out tune1 --i-may-move");
}

void add_positioning(CLI::App& bench, BenchIsoOptions& o) {
  CLI::App& c = *bench.add_subcommand("positioning", "Figures of ISO 230-2 of measured approaches.");
  c.add_option("FILE", o.files, "CSV with the columns target, actual and direction (1 or -1)")
      ->required()
      ->expected(1);
  c.add_option("--out", o.out, "Page with their courses over one another")->type_name("FILE");
  c.add_flag("--json", o.json, "As JSON");
  c.footer("Example: servogate bench positioning approaches.csv");
}

void add_circle(CLI::App& bench, BenchIsoOptions& o) {
  CLI::App& c =
      *bench.add_subcommand("circle", "Figures of ISO 230-4 of the measured circular path of two axes.");
  c.add_option("FILE", o.files, "CSV with the path, and a second one with that of the other direction")
      ->required()
      ->expected(1, 2);
  c.add_option("--radius", o.radius, "Nominal radius, in the unit of the path")
      ->required()
      ->type_name("R")
      ->check(number_within({1e-9, 1e9, ""}));
  c.add_option("--columns", o.columns, "Heads of the columns of both axes (default x,y)")->type_name("X,Y");
  c.add_option("--out", o.out, "Page with their courses over one another")->type_name("FILE");
  c.add_flag("--json", o.json, "As JSON");
  c.footer("Example: servogate bench circle there.csv back.csv --radius 50");
}

void add_compare(CLI::App& bench, BenchCompareOptions& o) {
  CLI::App& c = *bench.add_subcommand("compare", "Shows the figures of kept runs beside one another.");
  c.add_option("RUN", o.runs, "Directories of runs")->required()->expected(2, 6);
  c.add_option("--out", o.out, "Page with their courses over one another")->type_name("FILE");
  c.add_flag("--json", o.json, "As JSON");
  c.footer("Example: servogate bench compare step1 step2 --out steps.html");
}

void add_latency(CLI::App& app, LatencyOptions& o) {
  CLI::App& c = *app.add_subcommand(
      "latency", "Measures how exactly this computer keeps a cycle, and says what would make it better.");
  CLI::Option* bus = c.add_option("BUS", o.bus, "Url of a bus whose SYNC is measured, too");
  c.add_option("--machine", o.machine,
               "Machine file with simulated buses whose cycle is measured phase by phase")
      ->excludes(bus);
  c.add_option("NODE", o.node, "Drive on it that answers with process data; it gets no power")
      ->check(number_within({1.0, 127.0, text::both("(node-ID)", "(номер узла)"), true}));
  c.add_option("--cycle", o.cycle_us, "Cycle in us, 100 to 20000")
      ->type_name("US")
      ->check(number_within({100.0, 20'000.0, text::both("us", "мкс"), true}));
  c.add_option("--seconds", o.seconds, "How long it measures, 0.1 to 86400")
      ->type_name("S")
      ->check(number_within({0.1, 86'400.0, text::both("s", "с")}));
  c.add_flag("--load", o.load, "Keeps every processor busy meanwhile");
  c.add_option("--priority", o.priority, "SCHED_FIFO priority of the cycle, 1 to 99")
      ->type_name("N")
      ->check(number_within({1.0, 99.0, "", true}));
  c.add_option("--cpu", o.cpu, "Processor to which the cycle keeps")
      ->type_name("N")
      ->check(number_within({0.0, 4095.0, "", true}));
  c.add_option("--bit-rate", o.bit_rate, "Bit rate of the bus in bit/s, 10000 to 1000000")
      ->type_name("BIT/S")
      ->check(number_within({10'000.0, 1e6, text::both("bit/s", "бит/с"), true}));
  c.add_option("--listen", o.listen_s, "How long the bus must show no master before, in s, 0.1 to 60")
      ->type_name("S")
      ->check(number_within({0.1, 60.0, text::both("s", "с")}));
  c.add_flag("--json", o.json, "As JSON");
  c.footer("Example: servogate latency --seconds 60 --load");
}

}  // namespace

void add_bench_commands(CLI::App& app, BenchCommands& options) {
  CLI::App& bench = *app.add_subcommand("bench", "One drive on the table: turned, measured and identified.");
  bench.require_subcommand(1);
  add_move(bench, options.move);
  add_jog(bench, options.jog);
  add_run(bench, options.run);
  add_response(bench, options.response);
  add_identify(bench, options.identify);
  add_tune(bench, options.tune);
  add_record(bench, options.record);
  add_compare(bench, options.compare);
  add_latency(app, options.latency);
  add_positioning(bench, options.positioning);
  add_circle(bench, options.circle);
}

}  // namespace servogate::gateway
