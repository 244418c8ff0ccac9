// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "drivers/hid/hid_port.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/run/exit_code.hpp"
#include "gateway/control/server/pendant/texts.hpp"
#include "machine/check/device_kind.hpp"
#include "machine/loading/pendant_layout.hpp"

namespace servogate::gateway::command {

namespace {

using drivers::PendantNews;
using nlohmann::json;

const text::Entry kNone{"pendant.none", "this computer has no HID device",
                        "на этом компьютере нет устройств HID"};
const text::Entry kForbidden{"pendant.forbidden", "  may not be opened: 70-servogate.rules lets it",
                             "  нельзя открыть: это разрешает 70-servogate.rules"};
const text::Entry kNoFile{"pendant.no-file", "there is no device file '{0}'; looked in {1}",
                          "нет файла устройства «{0}»; искали в {1}"};
const text::Entry kNoPendant{"pendant.no-pendant", "'{0}' describes no pendant but a device of kind {1}",
                             "«{0}» описывает не пульт, а устройство вида {1}"};
const text::Entry kNoUrl{"pendant.no-url", "'{0}' is none of hid:any, hid:SERIAL, hid:/dev/hidraw0",
                         "«{0}» — не hid:any, hid:СЕРИЙНЫЙ_НОМЕР, hid:/dev/hidraw0"};
const text::Entry kHere{"pendant.is-here", "the pendant is here ({0})", "пульт подключён ({0})"};
const text::Entry kGone{"pendant.is-gone", "the pendant is unplugged; it is waited for",
                        "пульт отключён; его ждут"};
const text::Entry kStrange{"pendant.strange", "{0}  is no report of this device file",
                           "{0}  — не отчёт этого файла устройства"};

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  char word[4];
  for (const std::uint8_t b : bytes) {
    std::snprintf(word, sizeof word, "%02x", b);
    out += (out.empty() ? "" : " ") + std::string(word);
  }
  return out;
}

std::optional<machine::DeviceConfig> device_file(const std::string& name) {
  std::vector<std::string> folders{".", "devices"};
  for (std::string& folder : machine::device_folders()) folders.push_back(std::move(folder));
  std::string path, looked;
  std::error_code error;
  if (name.ends_with(".toml")) path = name;
  for (const std::string& folder : folders) {
    const std::string found = (std::filesystem::path(folder) / (name + ".toml")).string();
    if (path.empty() && std::filesystem::exists(found, error)) path = found;
    looked += (looked.empty() ? "" : ", ") + folder;
  }
  if (path.empty()) {
    complain(kNoFile, {name, looked});
    return std::nullopt;
  }
  machine::DeviceResult read = machine::load_device(path);
  if (print_findings(read.findings) > 0) return std::nullopt;
  if (read.device.kind == machine::DeviceKind::pendant) return std::move(read.device);
  complain(kNoPendant, {name, machine::kind_name(read.device.kind)});
  return std::nullopt;
}

/// A report in words, and as JSON.
json as_json(const pendant::Layout& layout, const pendant::Reading& reading) {
  json buttons = json::array();
  for (std::size_t b = 0; b < layout.buttons.size(); ++b)
    if ((reading.buttons >> b & 1u) != 0) buttons.push_back(layout.buttons[b].name);
  json out{{"buttons", buttons}, {"counts", reading.counts}};
  if (layout.ring >= 0) out["ring"] = reading.ring;
  if (layout.axis >= 0)
    out["axis"] = reading.axis < 0
                      ? json()
                      : json(std::string(1, layout.axes[static_cast<std::size_t>(reading.axis)].letter));
  if (layout.step >= 0)
    out["step"] =
        reading.step < 0 ? json() : json(layout.steps[static_cast<std::size_t>(reading.step)].length);
  return out;
}

std::string as_words(const json& reading) {
  std::string out;
  for (const auto& [key, value] : reading.items()) {
    if (value.is_array() && value.empty()) continue;
    std::string shown = value.is_null() ? "-" : value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_array()) {
      shown.clear();
      for (const json& v : value) shown += (shown.empty() ? "" : "+") + v.get<std::string>();
    }
    out += (out.empty() ? "" : "  ") + key + " " + shown;
  }
  return out;
}

void say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  print_line(text::render(entry, arguments, text::user_language()));
  keep_order();
}

/// False: it was no report.
bool tell(const PendantOptions& o, const pendant::Layout& layout, pendant::ReportReader& reader,
          const PendantNews& news) {
  switch (news.kind) {
    case PendantNews::Kind::plugged:
      o.json ? print_json_line({{"event", "plugged"}, {"path", news.words}}) : say(kHere, {news.words});
      reader.restart();
      return false;
    case PendantNews::Kind::unplugged:
      o.json ? print_json_line({{"event", "unplugged"}}) : say(kGone, {});
      return false;
    case PendantNews::Kind::not_allowed:
      complain(pendant_says::kNotAllowed, {o.device, news.words});
      return false;
    case PendantNews::Kind::report:
      break;
  }
  const std::string bytes = hex(news.report.view());
  const auto reading = reader.read(news.report.view());
  if (o.json) {
    json event = reading ? as_json(layout, *reading) : json::object();
    event["event"] = reading ? "report" : "strange";
    event["bytes"] = bytes;
    print_json_line(event);
  } else if (reading) {
    print_line(bytes + "  " + as_words(as_json(layout, *reading)));
    keep_order();
  } else {
    say(kStrange, {bytes});
  }
  return true;
}

}  // namespace

int pendant_list(const PendantOptions& o) {
  json list = json::array();
  for (const hid::HidEntry& d : hid::hid_devices()) {
    char ids[16];
    std::snprintf(ids, sizeof ids, "%04X:%04X", d.vendor, d.product);
    list.push_back(
        {{"usb", ids}, {"path", d.path}, {"serial", d.serial}, {"name", d.name}, {"allowed", d.allowed}});
    if (o.json) continue;
    print_line(std::string(ids) + "  " + d.path + "  " + (d.serial.empty() ? "-" : d.serial) + "  " + d.name);
    if (!d.allowed) print_line(text::render(kForbidden, {}, text::user_language()));
  }
  if (o.json) print_exact(json{{"schema", 1}, {"devices", list}}.dump(1));
  if (!list.empty()) return kDone;
  if (!o.json) print_line(text::render(kNone, {}, text::user_language()));
  return kAlarm;
}

int pendant_watch(const PendantOptions& o) {
  const auto device = device_file(o.device);
  if (!device) return kWrongUse;
  const auto place = machine::hid_place(o.url);
  if (!place) {
    complain(kNoUrl, {o.url});
    return kWrongUse;
  }
  const pendant::Layout layout = machine::pendant_layout(*device);
  drivers::Notice why;
  const EndBySignal end;
  const auto port =
      hid::HidPort::open({layout.usb_vendor, layout.usb_product, place->serial, place->path}, why);
  if (port == nullptr) {
    complain(*why.entry, why.arguments);
    return kInfrastructure;
  }
  if (!o.json) say(pendant_says::kLooked, {o.device, o.url});
  pendant::ReportReader reader(layout);
  int reports = 0;
  while (!end.ended()) {
    PendantNews news;
    port->wait(std::chrono::milliseconds(50));
    while (port->take(news))
      if (tell(o, layout, reader, news) && ++reports == o.count) return kDone;
  }
  return kStopped;
}

}  // namespace servogate::gateway::command
