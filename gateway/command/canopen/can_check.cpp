// SPDX-License-Identifier: Apache-2.0
// `servogate can check`: how a bus is, in sentences.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/master/segment_load.hpp"
#include "firmware_if/image/frames/can_wire.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/named_bus.hpp"
#include "gateway/command/canopen/bus/bit_rate_detection.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {

namespace {

using image::CanState;
using nlohmann::json;
using text::Entry;

const Entry kLink{"check.link", "{0} is up at {1} bit/s, {2}", "{0} включён, {1} бит/с, {2}"};
const Entry kVirtual{"check.virtual", "{0} is a virtual interface: it has no bit rate and makes no errors",
                     "{0} — виртуальный интерфейс: у него нет скорости и не бывает ошибок"};
const Entry kServed{"check.served", "{0} answers; a bus between processes has no error counters",
                    "{0} отвечает; у шины между процессами нет счётчиков ошибок"};
const Entry kAdapter{
    "check.adapter",
    "{0} is a USB adapter, its firmware of version {1}; it runs at {2} bit/s, reads a bit at {3} % "
    "of it, and is {4}",
    "{0} — адаптер USB с прошивкой версии {1}; работает на {2} бит/с, читает бит на {3} % его "
    "длины, состояние: {4}"};
const Entry kDown{"check.down", "{0} is down; bring it up with: sudo {1}",
                  "{0} выключен; включить: sudo {1}"};
const Entry kCounters{
    "check.counters",
    "error counters of the controller: transmit {0}, receive {1} (0 is healthy, from 96 on it warns, "
    "from 128 on it is passive)",
    "счётчики ошибок контроллера: передача {0}, приём {1} (0 — исправно, с 96 предупреждение, со 128 "
    "пассивное состояние)"};
const Entry kRising{
    "check.rising",
    "errors are counted while it listens: look at bit rate, termination (60 ohms between CAN_H and "
    "CAN_L) and wiring",
    "ошибки растут во время прослушивания: проверьте скорость, терминаторы (60 Ом между CAN_H и CAN_L) "
    "и кабель"};
const Entry kRestart{"check.restart", "after bus-off the controller restarts by itself, {0} ms later",
                     "после bus-off контроллер перезапустится сам через {0} мс"};
const Entry kNoRestart{"check.no-restart",
                       "after bus-off the controller stays off: `restart-ms 100` lets it return by itself",
                       "после bus-off контроллер останется выключенным: `restart-ms 100` вернёт его сам"};
const Entry kQueue{
    "check.queue",
    "the kernel keeps {0} frames waiting; a control wants at least {1}: sudo ip link set "
    "{2} txqueuelen {1}",
    "в очереди ядра {0} кадров; управлению нужно не меньше {1}: sudo ip link set {2} txqueuelen {1}"};
const Entry kQuiet{"check.quiet", "no frame came within {0} s", "за {0} с не пришло ни одного кадра"};
const Entry kTraffic{"check.traffic", "frames within {1} s: {0}, {2} % of the bit rate of {3} bit/s",
                     "кадров за {1} с: {0}, {2} % скорости {3} бит/с"};
const Entry kFull{
    "check.full",
    "{0} % of the bit rate is taken: frames of low priority, heartbeats first, come late or not at "
    "all. A bus with drives should stay below {1} %: raise the bit rate, lengthen the cycle, or "
    "divide the nodes among two buses",
    "занято {0} % скорости: кадры низкого приоритета, прежде всего heartbeat, приходят поздно или "
    "не приходят. Для приводов шина не должна быть занята более чем на {1} %: увеличьте скорость "
    "или такт либо разделите узлы на две шины"};
const Entry kNearlyFull{"check.nearly-full",
                        "{0} % of the bit rate is taken; above {1} % frames of low priority come late",
                        "занято {0} % скорости; свыше {1} % кадры низкого приоритета приходят поздно"};
const Entry kLong{
    "check.29-bit",
    "{0} frames had 29-bit identifiers, the first {1}: they are not of CANopen. A device of "
    "another protocol (J1939, for example) shares this bus; give it a bus of its own, as its "
    "traffic is in no load that `check` plans",
    "кадров с 29-битными идентификаторами: {0}, первый {1}; в CANopen таких нет. На этой шине есть "
    "устройство другого протокола (например, J1939); дайте ему отдельную шину: его кадры не "
    "входят в загрузку, которую считает `check`"};
const Entry kHeard{"check.heard", "nodes heard: {0}", "слышны узлы: {0}"};
const Entry kMaster{"check.master", "another master controls this bus: {0}",
                    "этой шиной кто-то управляет: {0}"};
const Entry kHolder{"check.holder", "the running control of '{0}' holds it ({1})",
                    "её держит работающее управление «{0}» ({1})"};
const Entry kIdle{"check.idle", "nobody controls it", "ею никто не управляет"};
const Entry kErrorFrames{"check.error-frames", "{0} error frames came", "пришло кадров ошибок: {0}"};
const Entry kNoDetection{
    "check.no-detection",
    "the bit rate of {0} cannot be found by listening: only CAN hardware of this computer can do it",
    "скорость {0} прослушиванием не найти: это умеет только аппаратный CAN этого компьютера"};
const Entry kDetectedAdapter{"check.detected-adapter", "the bus runs at {0} bit/s: --bit-rate {0}",
                             "шина работает на {0} бит/с: --bit-rate {0}"};
const Entry kDetectUp{
    "check.detect-up", "{0} is up, and what uses it would be cut off: sudo ip link set {0} down, then again",
    "{0} включён, и тот, кто им пользуется, был бы отключён: sudo ip link set {0} down, и снова"};
const Entry kTrying{"check.trying", "listening at {0} bit/s", "прослушивание на {0} бит/с"};
const Entry kDetected{"check.detected", "the bus runs at {0} bit/s: sudo {1}",
                      "шина работает на {0} бит/с: sudo {1}"};
const Entry kUndetected{"check.undetected",
                        "no frame came at any usual bit rate: nobody speaks, or the wiring is open",
                        "ни на одной обычной скорости кадров нет: никто не говорит, либо обрыв кабеля"};
const Entry kCannotDetect{"check.cannot-detect", "{0} cannot be set to listen only: {1}",
                          "{0} не переводится в прослушивание: {1}"};

/// Frames that fit into one cycle of a full segment, with room.
constexpr std::uint32_t kWantedQueue = 64;

struct StateRow {
  CanState state;
  const char* name;
  const char* english;
  const char* russian;
  bool healthy;
};
constexpr StateRow kStates[] = {
    {CanState::error_active, "error_active", "error-active (healthy)", "error-active (исправно)", true},
    {CanState::error_warning, "error_warning", "error-warning: errors pile up",
     "error-warning: ошибки копятся", true},
    {CanState::error_passive, "error_passive",
     "error-passive: nobody acknowledges (no other node, another bit rate, open wiring), or most frames are "
     "destroyed",
     "error-passive: никто не подтверждает (нет других узлов, другая скорость, обрыв) или большинство кадров "
     "гибнет",
     false},
    {CanState::bus_off, "bus_off", "bus-off: it has taken itself off the bus after too many errors",
     "bus-off: отключился от шины после слишком многих ошибок", false},
    {CanState::down, "down", "down", "выключен", false},
};
const StateRow& row_of(CanState state) {
  for (const StateRow& r : kStates)
    if (r.state == state) return r;
  return kStates[0];
}

/// What came while it listened.
struct Traffic {
  std::uint64_t frames = 0, bits = 0, errors = 0;
  std::uint64_t extended = 0;  ///< with 29-bit identifiers
  image::CanFrame first_extended;
  std::set<int> nodes;
  std::string master;  ///< its first frame, both languages
};

Traffic listen(ToolBus& bus, double seconds) {
  Traffic t;
  bus.listen(std::llround(seconds * 1e9), [&](const image::CanFrame& frame) {
    if (frame.error) {
      ++t.errors;
      return false;
    }
    ++t.frames;
    t.bits += image::known_bits(frame) + image::kIntermissionBits;
    if (frame.extended && t.extended++ == 0) t.first_extended = frame;
    const canopen::CobId id = canopen::classify(frame.id, frame.extended);
    using canopen::Service;
    if (!frame.remote && (id.service == Service::heartbeat || id.service == Service::emcy ||
                          id.service == Service::sdo_response))
      t.nodes.insert(id.node);
    if (t.master.empty() && canopen::sent_by_masters(frame)) t.master = canopen::frame_words(frame);
    return false;
  });
  return t;
}

/// Sentences and facts, told at the end at once.
class Report {
 public:
  explicit Report(const CanCheckOptions& options) : options_(options) {
    facts_["schema"] = 1;
    facts_["bus"] = options.bus;
  }
  void say(const Entry& entry, const std::vector<std::string>& arguments = {}) {
    sentences_.push_back(text::render(entry, arguments, text::user_language()));
  }
  void wrong(const Entry& entry, const std::vector<std::string>& arguments = {}) {
    say(entry, arguments);
    healthy_ = false;
  }
  void mark(bool healthy) { healthy_ = healthy_ && healthy; }
  json& facts() { return facts_; }
  int tell() {
    facts_["ok"] = healthy_;
    facts_["sentences"] = sentences_;
    if (options_.json)
      print_exact(facts_.dump(1, ' ', false, json::error_handler_t::replace));
    else
      for (const std::string& s : sentences_) print_line(s);
    return healthy_ ? kDone : kAlarm;
  }

 private:
  const CanCheckOptions& options_;
  json facts_;
  std::vector<std::string> sentences_;
  bool healthy_ = true;
};

bool is_virtual(const socketcan::LinkInfo& link) { return link.kind == "vcan" || link.kind == "vxcan"; }

void tell_counters(Report& report, std::uint32_t transmit, std::uint32_t receive) {
  report.facts()["link"]["transmit_errors"] = transmit;
  report.facts()["link"]["receive_errors"] = receive;
  report.say(kCounters, {std::to_string(transmit), std::to_string(receive)});
}

void tell_link(Report& report, const socketcan::LinkInfo& link) {
  const StateRow& state = row_of(link.state);
  report.facts()["link"] = {{"interface", link.name},
                            {"kind", link.kind},
                            {"up", link.up},
                            {"state", state.name},
                            {"bit_rate", link.bit_rate},
                            {"restart_ms", link.restart_ms},
                            {"queue", link.transmit_queue},
                            {"fd", link.fd}};
  if (is_virtual(link)) {
    report.say(kVirtual, {link.name});
  } else {
    report.say(kLink, {link.name, std::to_string(link.bit_rate), text::both(state.english, state.russian)});
    report.say(link.restart_ms > 0 ? kRestart : kNoRestart, {std::to_string(link.restart_ms)});
    if (link.transmit_queue < kWantedQueue)
      report.say(kQueue, {std::to_string(link.transmit_queue), std::to_string(kWantedQueue), link.name});
  }
  report.mark(state.healthy);
  if (!link.counters) return;
  tell_counters(report, link.transmit_errors, link.receive_errors);
}

/// Whether the state and the error counters of the adapter's controller rose since `before` is told, too.
void tell_adapter(Report& report, const std::string& url, gsusb::GsUsbBus& adapter,
                  const std::optional<gsusb::ControllerState>& before) {
  const auto now = adapter.ask_state();
  const StateRow& state = row_of(now ? now->state : adapter.state());
  report.facts()["link"] = {{"kind", "gs_usb"},
                            {"state", state.name},
                            {"bit_rate", adapter.bit_rate()},
                            {"sample_point", adapter.timing().sample_point()},
                            {"firmware", adapter.device().software}};
  report.say(kAdapter, {url, std::to_string(adapter.device().software), std::to_string(adapter.bit_rate()),
                        text::number(adapter.timing().sample_point() * 100.0, 1),
                        text::both(state.english, state.russian)});
  report.mark(state.healthy);
  if (!now) return;
  tell_counters(report, now->transmit_errors, now->receive_errors);
  if (before &&
      (now->transmit_errors > before->transmit_errors || now->receive_errors > before->receive_errors))
    report.wrong(kRising);
}

/// On a controlled bus 127 is the heartbeat of a servogate that controls it.
std::string node_words(const Traffic& t, int node) {
  const std::string number = std::to_string(node);
  if (t.master.empty() || node != canopen::SegmentConfig().own_node) return number;
  return text::both(number + " (the control)", number + " (управление)");
}

/// By the limits for which `check` plans a machine.
void tell_load(Report& report, double percent) {
  const auto words = [](double limit) { return text::number(limit * 100.0, 0); };
  if (percent > canopen::kLoadError * 100.0)
    report.wrong(kFull, {text::number(percent, 1), words(canopen::kLoadWarning)});
  else if (percent > canopen::kLoadWarning * 100.0)
    report.say(kNearlyFull, {text::number(percent, 1), words(canopen::kLoadError)});
}

void tell_traffic(Report& report, const Traffic& t, const CanCheckOptions& options, std::uint32_t bit_rate) {
  const double load = static_cast<double>(t.bits) / (options.seconds * bit_rate) * 100.0;
  report.facts()["traffic"] = {{"seconds", options.seconds},     {"frames", t.frames},
                               {"error_frames", t.errors},       {"load_percent", load},
                               {"frames_29_bit", t.extended},    {"nodes", t.nodes},
                               {"controlled", !t.master.empty()}};
  if (t.frames == 0)
    report.say(kQuiet, {text::number(options.seconds)});
  else
    report.say(kTraffic, {std::to_string(t.frames), text::number(options.seconds), text::number(load, 1),
                          std::to_string(bit_rate)});
  tell_load(report, load);
  if (t.extended > 0)
    report.wrong(kLong, {std::to_string(t.extended), canopen::frame_words(t.first_extended)});
  if (t.errors > 0) report.wrong(kErrorFrames, {std::to_string(t.errors)});
  std::string nodes;
  for (const int node : t.nodes) nodes += (nodes.empty() ? "" : ", ") + node_words(t, node);
  if (!nodes.empty()) report.say(kHeard, {nodes});
}

int detect(const CanCheckOptions& options, const std::string& url,
           const std::optional<socketcan::LinkInfo>& link, Report& report) {
  const bool adapter = url.starts_with("gsusb:");
  if (!adapter && (!link || is_virtual(*link) || link->kind.empty())) {
    complain(kNoDetection, {options.bus});
    return kInfrastructure;
  }
  if (link && link->up) {
    complain(kDetectUp, {link->name});
    return kWrongUse;
  }
  const EndBySignal signals;
  const auto trying = [&](std::uint32_t rate) {
    tell(text::render(kTrying, std::vector<std::string>{std::to_string(rate)}, text::user_language()));
    return !signals.ended();
  };
  const DetectedRate found = adapter ? detect_bit_rate(url, trying) : detect_bit_rate(*link, trying);
  if (signals.ended()) return kStopped;
  if (!found.problem.empty()) {
    complain(kCannotDetect, {adapter ? url : link->name, found.problem});
    return kInfrastructure;
  }
  report.facts()["bit_rate"] = found.bit_rate ? json(*found.bit_rate) : json();
  if (found.bit_rate && adapter)
    report.say(kDetectedAdapter, {std::to_string(*found.bit_rate)});
  else if (found.bit_rate)
    report.say(kDetected, {std::to_string(*found.bit_rate), socketcan::command_up(*link, *found.bit_rate)});
  else
    report.wrong(kUndetected);
  return report.tell();
}

/// Errors were counted between two looks at the link.
bool rising(const std::optional<socketcan::LinkInfo>& before,
            const std::optional<socketcan::LinkInfo>& after) {
  return before && after && after->counters &&
         (after->transmit_errors > before->transmit_errors || after->receive_errors > before->receive_errors);
}

}  // namespace

int can_check(const CanCheckOptions& options) {
  const auto named = named_bus(options.bus, options.bit_rate);
  if (!named) return kWrongUse;
  const bool interface = named->url.starts_with("socketcan:");
  const auto look = [&] {
    return interface ? socketcan::read_link(named->url.substr(std::string_view("socketcan:").size()))
                     : std::nullopt;
  };
  const std::optional<socketcan::LinkInfo> before = look();
  Report report(options);
  if (options.detect) return detect(options, named->url, before, report);
  if (before && before->is_can && !before->up) {
    const std::uint32_t rate = named->bit_rate != 0 ? named->bit_rate : 1'000'000;
    report.facts()["link"] = {{"interface", before->name}, {"up", false}};
    report.wrong(kDown, {before->name, socketcan::command_up(*before, rate)});
    return report.tell();
  }
  const std::optional<Holder> holder = holder_of(*named);
  if (holder && !holder->silent) {
    report.facts()["held_by"] = {{"machine", holder->machine}, {"socket", holder->socket}};
    if (named->url.starts_with("mock:")) {
      report.say(kHolder, {holder->machine, holder->socket});
      return report.tell();
    }
  }
  int code = kDone;
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  gsusb::GsUsbBus* const adapter = bus->transport().adapter;
  const auto adapter_before = adapter != nullptr ? adapter->ask_state() : std::nullopt;
  const Traffic traffic = listen(*bus, options.seconds);
  if (bus->over()) return bus->finish(kDone);
  const std::optional<socketcan::LinkInfo> after = look();
  if (adapter != nullptr)
    tell_adapter(report, named->url, *adapter, adapter_before);
  else if (after)
    tell_link(report, *after);
  else
    report.say(kServed, {named->url});
  tell_traffic(report, traffic, options, bus->bit_rate());
  if (rising(before, after)) report.wrong(kRising);
  if (holder) report.say(kHolder, {holder->machine, holder->socket});
  if (!traffic.master.empty())
    report.say(kMaster, {traffic.master});
  else if (!holder)
    report.say(kIdle);
  return bus->finish(report.tell());
}

}  // namespace servogate::gateway::command
