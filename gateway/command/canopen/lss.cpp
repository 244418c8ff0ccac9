// SPDX-License-Identifier: Apache-2.0
// `servogate lss`: layer setting services, one after the other. Source: CiA 305.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "drivers/clock.hpp"
#include "firmware_if/canopen/305/lss_master.hpp"
#include "firmware_if/text/in_both.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {

namespace {

using canopen::LssMode;
using nlohmann::json;

const text::Entry kBadStep{"lss.bad-step", "'{0}' is no step of layer setting; known: {1}",
                           "«{0}» — не шаг LSS; известны: {1}"};
const text::Entry kNeeds{"lss.needs", "`{0}` needs {1}", "для `{0}` нужно {1}"};
const text::Entry kNoRate{"lss.no-rate", "{0} bit/s is not in the table of CiA 305: {1}",
                          "скорости {0} бит/с нет в таблице CiA 305: {1}"};
const text::Entry kNobody{"lss.nobody", "`{0}`: nobody answers", "`{0}`: никто не отвечает"};
const text::Entry kRefused{"lss.refused", "`{0}`: the device refuses: {1}",
                           "`{0}`: устройство отказывает: {1}"};
const text::Entry kFound{"lss.found", "found, and now in configuration: {0}",
                         "найдено, теперь в настройке: {0}"};
const text::Entry kSelected{"lss.selected", "in configuration: {0}", "в настройке: {0}"};
const text::Entry kInquired{"lss.inquired", "{0}, node-ID {1}", "{0}, номер узла {1}"};
const text::Entry kNone{"lss.none", "none", "нет"};
const text::Entry kThere{"lss.unconfigured", "a device without node-ID is there",
                         "есть устройство без номера узла"};
const text::Entry kAllConfiguration{"lss.configuration", "all devices are in configuration",
                                    "все устройства в настройке"};
const text::Entry kAllWaiting{"lss.waiting", "all devices are waiting again", "все устройства снова ждут"};
const text::Entry kNode{
    "lss.node", "node-ID {0}; a device that had another takes it over with `nmt reset-comm`",
    "номер узла {0}; устройство, у которого был другой, примет его после `nmt reset-comm`"};
const text::Entry kSeveral{"lss.several",
                           "`{0}`: {1} devices answer ({2}), and this is for one: `select "
                           "VENDOR:PRODUCT:REVISION:SERIAL` before it, "
                           "or `fastscan` where they have no node-ID",
                           "`{0}`: отвечают {1} (устройств), {2}, а это для одного: сначала `select "
                           "ИЗГОТОВИТЕЛЬ:ИЗДЕЛИЕ:РЕВИЗИЯ:НОМЕР`, "
                           "а без номеров узла — `fastscan`"};
const text::Entry kDevices{"lss.devices", "{0}; {1} devices answer", "{0}; отвечают {1} (устройств)"};
const text::Entry kRate{"lss.rate", "bit rate {0} bit/s", "скорость {0} бит/с"};
const text::Entry kActivated{"lss.activated", "the new bit rate begins in {0} ms",
                             "новая скорость начнётся через {0} мс"};
const text::Entry kStored{"lss.stored", "stored in the device", "сохранено в устройстве"};

/// A step of the command line: its word, what follows it, and whether it changes or disturbs a bus in use.
struct Step {
  std::string word, argument;
};

std::string part_words(std::uint32_t part) {
  char text[16];
  std::snprintf(text, sizeof text, "%08X", part);
  return text;
}

std::string identity_words(const canopen::LssIdentity& id) {
  std::string words;
  for (const std::uint32_t part : id.part) words += (words.empty() ? "" : ":") + part_words(part);
  return words;
}

json identity_json(const canopen::LssIdentity& id) {
  return {{"vendor_id", id.part[0]},
          {"product_code", id.part[1]},
          {"revision", id.part[2]},
          {"serial_number", id.part[3]}};
}

std::optional<std::uint32_t> number(std::string_view text, int base) {
  if (base == 16 && (text.starts_with("0x") || text.starts_with("0X"))) text.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// VENDOR:PRODUCT:REVISION:SERIAL, hexadecimal.
std::optional<canopen::LssIdentity> identity_of(std::string_view text) {
  canopen::LssIdentity id;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t colon = text.find(':');
    if ((colon == std::string_view::npos) != (i == 3)) return std::nullopt;
    const auto part = number(text.substr(0, colon), 16);
    if (!part) return std::nullopt;
    id.part[i] = *part;
    text = i == 3 ? std::string_view() : text.substr(colon + 1);
  }
  return id;
}

/// Carries out the steps, saying what each came to.
class Layers {
 public:
  Layers(ToolBus& bus, const LssOptions& options)
      : bus_(bus), options_(options), master_(static_cast<image::Nanoseconds>(options.timeout_ms * 1e6)) {}

  int run(const std::vector<Step>& steps) {
    int code = kDone;
    for (const Step& step : steps) {
      code = one(step);
      if (code != kDone) break;
    }
    if (options_.json) print_exact(json{{"schema", 1}, {"ok", code == kDone}, {"steps", said_}}.dump(1));
    return code;
  }

  struct Row {
    const char* word;
    const char* argument;  ///< what follows, for a message; nullptr: nothing
    int (Layers::*carry_out)(const Step& step);
  };
  static const Row kRows[];
  static const Row* row(const std::string& word);
  static std::string words();

 private:
  int one(const Step& step) { return (this->*row(step.word)->carry_out)(step); }

  /// Waits for the end of the service that was started.
  canopen::LssStatus wait() {
    answers_.clear();
    while (master_.busy() && !bus_.over()) {
      while (master_.poll(drivers::clock_ns(CLOCK_MONOTONIC), *bus_.transport().bus)) {
      }
      bus_.listen(2 * image::kMillisecond, [this](const image::CanFrame& frame) {
        return frame.id == canopen::cob::kLssSlave && !frame.extended && hear(frame);
      });
    }
    return master_.busy() ? canopen::LssStatus::no_answer : master_.result().status;
  }
  /// An answer; it is kept, so that those of several devices can be told.
  bool hear(const image::CanFrame& frame) {
    if (frame.length == 8 && frame.data[0] == static_cast<std::uint8_t>(master_.result().command))
      std::copy_n(frame.data.begin(), 8, answers_.emplace_back().begin());
    return master_.on_frame(frame);
  }
  /// After the first answer: those of the others.
  void hear_others() {
    bus_.listen(static_cast<image::Nanoseconds>(options_.timeout_ms * 1e6), [this](const auto& frame) {
      if (frame.id == canopen::cob::kLssSlave && !frame.extended) hear(frame);
      return false;
    });
  }
  /// kDone, or what went wrong, said.
  int outcome(const Step& step) {
    const canopen::LssStatus status = wait();
    if (status == canopen::LssStatus::done) return kDone;
    if (status == canopen::LssStatus::refused)
      return refuse(step, master_.result().error, master_.result().specific);
    complain(kNobody, {step.word});
    return kAlarm;
  }
  int refuse(const Step& step, std::uint8_t error, std::uint8_t specific) {
    complain(kRefused, {step.word, text::in_both(canopen::lss_error_text(master_.result().command, error),
                                                 {std::to_string(error == 255 ? specific : error)})});
    return kAlarm;
  }
  /// Of a setting that all devices in configuration take: none of them may refuse.
  int outcome_of_all(const Step& step) {
    if (const int code = outcome(step); code != kDone) return code;
    hear_others();
    for (const canopen::LssBytes& answer : answers_)
      if (answer[1] != 0) return refuse(step, answer[1], answer[2]);
    return kDone;
  }
  /// The words with the number of devices that answered, where they were several.
  int say_of_all(const Step& step, const text::Entry& entry, const std::vector<std::string>& arguments,
                 json facts = json::object()) {
    facts["devices"] = answers_.size();
    if (answers_.size() < 2) return say(step, entry, arguments, std::move(facts));
    return say(step, kDevices, {text::in_both(entry, arguments), std::to_string(answers_.size())},
               std::move(facts));
  }

  /// What the one device in configuration says of itself. Of several, who would answer at once, it is said
  /// that they are, and nothing else is believed: kAlarm. Source: CiA 305: node-ID and inquiries are for
  /// exactly one device in configuration state.
  int identify(const Step& step, canopen::LssIdentity& id, std::uint32_t& node) {
    std::size_t devices = 0;
    std::string words;
    for (int part = 0; part <= 4; ++part) {
      if (part < 4)
        master_.inquire(part);
      else
        master_.inquire_node();
      if (const int code = outcome(step); code != kDone) return code;
      hear_others();
      std::vector<std::uint32_t> values;
      for (const canopen::LssBytes& answer : answers_) values.push_back(canopen::lss_value(answer));
      devices = std::max(devices, values.size());
      if (part == 4) break;
      id.part[static_cast<std::size_t>(part)] = values.front();
      std::sort(values.begin(), values.end());
      values.erase(std::unique(values.begin(), values.end()), values.end());
      for (std::size_t i = 0; i < values.size(); ++i)
        words += (i > 0 ? "|" : part > 0 ? ":" : "") + part_words(values[i]);
    }
    node = master_.result().value;
    if (devices == 1) return kDone;
    complain(kSeveral, {step.word, std::to_string(devices), words});
    return kAlarm;
  }
  /// Before a service that is for one device: exactly one answers, and it alone is left in configuration,
  /// since equal answers of several are one frame on a wire.
  int single_out(const Step& step) {
    if (one_) return kDone;
    canopen::LssIdentity id;
    std::uint32_t node = 0;
    if (const int code = identify(step, id, node); code != kDone) return code;
    return choose(step, id);
  }
  /// Only this device is in configuration afterwards.
  int choose(const Step& step, const canopen::LssIdentity& id) {
    all_wait();
    master_.switch_selective(id);
    const int code = outcome(step);
    one_ = code == kDone;
    return code;
  }
  void all_wait() {
    one_ = false;
    master_.switch_global(LssMode::waiting);
    wait();
  }
  int say(const Step& step, const text::Entry& entry, const std::vector<std::string>& arguments,
          json facts = json::object()) {
    facts["step"] = step.word;
    said_.push_back(std::move(facts));
    if (!options_.json) print_line(text::render(entry, arguments, text::user_language()));
    return kDone;
  }

  int fastscan(const Step& step) {
    all_wait();  // the one that is found is to be alone
    master_.fastscan();
    if (const int code = outcome(step); code != kDone) return code;
    one_ = true;
    const canopen::LssIdentity found = master_.result().identity;
    return say(step, kFound, {identity_words(found)}, identity_json(found));
  }
  int select(const Step& step) {
    const auto id = identity_of(step.argument);
    if (const int code = choose(step, *id); code != kDone) return code;
    return say(step, kSelected, {identity_words(*id)}, identity_json(*id));
  }
  int configuration(const Step& step) {
    one_ = false;
    master_.switch_global(LssMode::configuration);
    wait();
    return say(step, kAllConfiguration, {});
  }
  int waiting(const Step& step) {
    all_wait();
    return say(step, kAllWaiting, {});
  }
  int inquire(const Step& step) {
    canopen::LssIdentity id;
    std::uint32_t node = 0;
    if (const int code = identify(step, id, node); code != kDone) return code;
    json facts = identity_json(id);
    facts["node"] = node == canopen::kUnconfiguredNode ? json() : json(node);
    return say(step, kInquired,
               {identity_words(id),
                node == canopen::kUnconfiguredNode ? text::in_both(kNone, {}) : std::to_string(node)},
               facts);
  }
  int unconfigured(const Step& step) {
    master_.identify_unconfigured();
    if (const int code = outcome(step); code != kDone) return code;
    return say(step, kThere, {});
  }
  int node(const Step& step) {
    const std::uint32_t id =
        step.argument == "none" ? canopen::kUnconfiguredNode : *number(step.argument, 10);
    if (const int code = single_out(step); code != kDone) return code;
    master_.configure_node(static_cast<canopen::NodeId>(id));
    if (const int code = outcome(step); code != kDone) return code;
    return say(step, kNode, {step.argument}, {{"node", id}});
  }
  int bit_rate(const Step& step) {
    const auto rate = *number(step.argument, 10);
    master_.configure_bit_rate(rate);
    if (const int code = outcome_of_all(step); code != kDone) return code;
    return say_of_all(step, kRate, {step.argument}, {{"bit_rate", rate}});
  }
  int activate(const Step& step) {
    master_.activate_bit_rate(static_cast<std::uint16_t>(*number(step.argument, 10)));
    wait();
    return say(step, kActivated, {step.argument});
  }
  int store(const Step& step) {
    master_.store();
    if (const int code = outcome_of_all(step); code != kDone) return code;
    return say_of_all(step, kStored, {});
  }

  ToolBus& bus_;
  const LssOptions& options_;
  canopen::LssMaster master_;
  bool one_ = false;  ///< exactly one device is in configuration
  std::vector<canopen::LssBytes> answers_;
  json said_ = json::array();
};

const Layers::Row Layers::kRows[] = {{"fastscan", nullptr, &Layers::fastscan},
                                     {"select", "VENDOR:PRODUCT:REVISION:SERIAL", &Layers::select},
                                     {"configuration", nullptr, &Layers::configuration},
                                     {"waiting", nullptr, &Layers::waiting},
                                     {"inquire", nullptr, &Layers::inquire},
                                     {"unconfigured", nullptr, &Layers::unconfigured},
                                     {"node", "1...127 | none", &Layers::node},
                                     {"bit-rate", "BIT/S", &Layers::bit_rate},
                                     {"activate", "0...65535 ms", &Layers::activate},
                                     {"store", nullptr, &Layers::store}};

const Layers::Row* Layers::row(const std::string& word) {
  for (const Row& r : kRows)
    if (r.word == word) return &r;
  return nullptr;
}

std::string Layers::words() {
  std::string list;
  for (const Row& r : kRows) list += (list.empty() ? "" : ", ") + std::string(r.word);
  return list;
}

bool argument_fits(const Step& step) {
  if (step.word == "select") return identity_of(step.argument).has_value();
  if (step.word == "node" && step.argument == "none") return true;
  const auto value = number(step.argument, 10);
  if (!value) return false;
  if (step.word == "node") return *value >= 1 && *value <= canopen::kMaxNode;
  return step.word != "activate" || *value <= 0xFFFF;
}

/// The words as steps; false: they are none, which has been said.
bool read_steps(const std::vector<std::string>& words, std::vector<Step>& steps) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Layers::Row* row = Layers::row(words[i]);
    if (row == nullptr) {
      complain(kBadStep, {words[i], Layers::words()});
      return false;
    }
    Step step{words[i], {}};
    if (row->argument != nullptr) {
      step.argument = i + 1 < words.size() ? words[++i] : "";
      if (!argument_fits(step)) {
        complain(kNeeds, {step.word, row->argument});
        return false;
      }
    }
    if (step.word == "bit-rate" && canopen::lss_bit_rate_index(*number(step.argument, 10)) < 0) {
      std::string rates;
      for (const std::uint32_t rate : canopen::kLssBitRates)
        if (rate != 0) rates += (rates.empty() ? "" : ", ") + std::to_string(rate);
      complain(kNoRate, {step.argument, rates});
      return false;
    }
    steps.push_back(std::move(step));
  }
  return true;
}

}  // namespace

int lss(const LssOptions& options) {
  std::vector<Step> steps;
  if (!read_steps(options.words, steps)) return kWrongUse;
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(options.bus, holder, code)) return code;
  if (holder) return refuse_held(*holder, options.bus, "`lss`");
  const auto bus = ToolBus::open(options, code);
  if (bus == nullptr) return code;
  code = must_be_idle(*bus, "`lss`", options);
  if (code == kDone) code = Layers(*bus, options).run(steps);
  return bus->finish(code);
}

}  // namespace servogate::gateway::command
