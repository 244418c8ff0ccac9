// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/commands/pendant_commands.hpp"

namespace servogate::gateway {

void add_pendant_commands(CLI::App& app, BusCommands& options) {
  CLI::App& pendant =
      *app.add_subcommand("pendant", "HID devices of this computer, and what a pendant says.");
  pendant.require_subcommand(1);

  PendantOptions& l = options.pendant_list;
  CLI::App& list = *pendant.add_subcommand("list", "HID devices of this computer, and which may be opened.");
  list.add_flag("--json", l.json, "As JSON");
  list.footer("Example: servogate pendant list");

  PendantOptions& w = options.pendant_watch;
  CLI::App& watch =
      *pendant.add_subcommand("watch", "What a pendant says, by its device file; moves nothing.");
  watch.add_option("DEVICE", w.device, "Device file of the pendant, by name or path")->required();
  watch.add_option("--url", w.url, "hid:any (the default), hid:SERIAL or hid:/dev/hidraw0")->type_name("URL");
  watch.add_option("--count", w.count, "Ends after so many reports")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  watch.add_flag("--json", w.json, "As JSON");
  watch.footer("Example: servogate pendant watch xhc-whb04b-6");
}

}  // namespace servogate::gateway
