// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/commands/canopen_commands.hpp"

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/quantities.hpp"

namespace servogate::gateway {

namespace {

void add_bus(CLI::App& app, CanopenBusOptions& o) {
  app.add_option("BUS", o.bus, "Url of the bus, or MACHINE.toml#bus")->required();
  app.add_option("--bit-rate", o.bit_rate, "Bit rate of the bus in bit/s, 10000 to 1000000")
      ->type_name("BIT/S")
      ->check(number_within({10'000.0, 1e6, text::both("bit/s", "бит/с"), true}));
  app.add_flag("--json", o.json, "As JSON");
}

void add_timeout(CLI::App& app, CanopenBusOptions& o) {
  app.add_option("--timeout", o.timeout_ms, "Patience with an answer in ms, 1 to 60000")
      ->type_name("MS")
      ->check(number_within({1.0, 60'000.0, text::both("ms", "мс")}));
}

void add_no_block(CLI::App& app, CanopenBusOptions& o) {
  app.add_flag("--no-block", o.no_block, "Long objects in segments, never in blocks");
}

void add_listening(CLI::App& app, CanopenBusOptions& o) {
  app.add_option("--listen", o.listen_s, "How long the bus must show no master before, in s, 0.1 to 60")
      ->type_name("S")
      ->check(number_within({0.1, 60.0, text::both("s", "с")}));
}

void add_anyway(CLI::App& app, CanopenBusOptions& o) {
  app.add_flag("--anyway", o.anyway, "Reads although somebody controls the bus");
  add_listening(app, o);
}

void add_may_move(CLI::App& app, CanopenBusOptions& o) {
  app.add_flag("--i-may-move", o.may_move, "A drive may move");
}

void add_node(CLI::App& app, int& node) {
  app.add_option("NODE", node, "Node-ID, 1 to 127")
      ->required()
      ->check(number_within({1.0, 127.0, text::both("(node-ID)", "(номер узла)"), true}));
}

void add_scan(CLI::App& app, ScanOptions& o) {
  CLI::App& c = *app.add_subcommand("scan", "Who is on a CANopen bus: every node that answers or is heard.");
  add_bus(c, o);
  c.add_option("--seconds", o.seconds, "How long heartbeats are listened for, 0.1 to 60")
      ->type_name("S")
      ->check(number_within({0.1, 60.0, text::both("s", "с")}));
  add_timeout(c, o);
  add_anyway(c, o);
  c.footer("Example: servogate scan socketcan:can0");
}

void add_sdo(CLI::App& app, SdoOptions& o) {
  CLI::App& c = *app.add_subcommand("sdo", "Reads or writes objects of a CANopen node.");
  add_bus(c, o);
  add_node(c, o.node);
  c.add_option("ACTION", o.action, "read or write")->required()->check(one_of({"read", "write"}));
  c.add_option("OBJECT", o.object, "INDEX[:SUB], hexadecimal, or a name: 6041, 1018:4, statusword")
      ->required();
  c.add_option(
       "VALUE", o.words,
       "Of write: VALUE [TYPE], @FILE for the bytes of a file; of read: [TYPE]. Types: bool, u8 to u64, "
       "i8 to i64, f32, f64, str, hex, domain. Further objects may follow, also behind another read or write")
      ->expected(0, 1000);
  c.add_option("--eds", o.eds, "Data sheet (EDS or DCF) that knows names and types");
  c.add_option("--save", o.save, "read: writes the bytes to this file");
  add_timeout(c, o);
  add_no_block(c, o);
  add_may_move(c, o);
  add_anyway(c, o);
  c.footer("Example: servogate sdo socketcan:can0 5 read statusword error_code");
}

void add_od(CLI::App& app, OdOptions& o) {
  CLI::App& c = *app.add_subcommand("od", "Reads the object dictionary of a CANopen node.");
  add_bus(c, o);
  add_node(c, o.node);
  c.add_option("--eds", o.eds, "Data sheet (EDS or DCF) with the objects to be read");
  CLI::Option* range =
      c.add_option("--range", o.range, "Every index from FIRST to LAST, hexadecimal: 2000-5FFF");
  c.add_option("--save", o.save, "Writes what was read to this DCF");
  CLI::Option* compare =
      c.add_option("--compare", o.compare, "Compares with this DCF; exit 1 when a parameter differs");
  CLI::Option* write_eds =
      c.add_option("--write-eds", o.write_eds,
                   "Writes an EDS of the node to this file: its own (1021h), or from what was read");
  CLI::Option* restore = c.add_option(
      "--restore", o.restore, "Writes the parameters of this DCF that differ, and compares before and after");
  range->excludes(compare)->excludes(restore);
  write_eds->excludes(compare)->excludes(restore);
  restore->excludes(compare);
  add_timeout(c, o);
  add_no_block(c, o);
  add_anyway(c, o);
  c.get_option("--anyway")
      ->description("Reads although somebody controls the bus; --restore: the DCF of another serial number");
  c.footer("Example: servogate od socketcan:can0 5 --eds drive.eds --save node5.dcf");
}

void add_lss(CLI::App& app, LssOptions& o) {
  CLI::App& c =
      *app.add_subcommand("lss", "Layer setting services: node-ID and bit rate of a device (CiA 305).");
  add_bus(c, o);
  c.add_option(
       "STEP", o.words,
       "In their order: fastscan, select VENDOR:PRODUCT:REVISION:SERIAL, configuration, waiting, inquire, "
       "unconfigured, node N, bit-rate BIT/S, activate MS, store")
      ->required();
  add_timeout(c, o);
  add_listening(c, o);
  c.footer("Example: servogate lss socketcan:can0 fastscan node 5 store waiting");
}

void add_nmt(CLI::App& app, NmtOptions& o) {
  CLI::App& c = *app.add_subcommand("nmt", "Sends an NMT command and says what the nodes made of it.");
  add_bus(c, o);
  c.add_option("COMMAND", o.command, "start, stop, preop, reset or reset-comm")
      ->required()
      ->check(one_of({"start", "stop", "preop", "reset", "reset-comm"}));
  c.add_option("NODE", o.node, "Node-ID, or all (the default)");
  add_may_move(c, o);
  add_listening(c, o);
  c.footer("Example: servogate nmt socketcan:can0 preop 5 --i-may-move");
}

}  // namespace

void add_can_check(CLI::App& can, CanCheckOptions& o) {
  CLI::App& c = *can.add_subcommand("check", "Says how a bus is: link, bit rate, errors, load, who speaks.");
  add_bus(c, o);
  c.add_option("--seconds", o.seconds, "How long it listens, 0.1 to 600")
      ->type_name("S")
      ->check(number_within({0.1, 600.0, text::both("s", "с")}));
  c.add_flag("--detect", o.detect, "Finds the bit rate by listening only; the interface must be down");
  c.footer("Example: servogate can check socketcan:can0");
}

void add_canopen_commands(CLI::App& app, BusCommands& options) {
  add_scan(app, options.scan);
  add_sdo(app, options.sdo);
  add_od(app, options.od);
  add_lss(app, options.lss);
  add_nmt(app, options.nmt);
}

}  // namespace servogate::gateway
