// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/words/ready_words.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "firmware_if/image/interface_map.hpp"
#include "gateway/control/run/words/wait_words.hpp"

namespace servogate::gateway {

namespace {

using image::DriveState;
using text::Entry;

constexpr image::Place kEstopOk = image::field(image::kMachineFields, "estop_ok", image::kMachineBase);
constexpr image::Place kPowerOn = image::field(image::kMachineFields, "power_on", image::kMachineBase);
constexpr image::Place kPowerRequest =
    image::field(image::kMachineFields, "power_request", image::kMachineBase);
constexpr image::Place kEnable = image::field(image::kAxisFields, "enable");

/// {0} place, axes or alarm, {1} further words.
constexpr Entry kChain{"ready.chain", "the emergency-stop chain is open: {0} is FALSE",
                       "цепь аварийного останова разомкнута: {0} = FALSE"};
constexpr Entry kChainMock{
    "ready.chain-mock",
    "`servogate input {1} on` closes the simulated chain; for `servogate run` name it in [simulation] "
    "operator_closes of the machine file; then `servogate reset`.",
    "`servogate input {1} on` замыкает имитируемую цепь; для `servogate run` назовите её в [simulation] "
    "operator_closes файла станка; затем `servogate reset`."};
constexpr Entry kChainReal{
    "ready.chain-real",
    "Remove the danger, unlock the button, then `servogate reset` and `servogate power "
    "on`.",
    "Устраните опасность, отпустите кнопку, затем `servogate reset` и `servogate power "
    "on`."};
constexpr Entry kEstopByPlc{"ready.estop-by-plc",
                            "the PLC reports the emergency stop: MC.estop_ok ({0}) is FALSE",
                            "ПЛК сообщает об аварийном останове: MC.estop_ok ({0}) = FALSE"};
constexpr Entry kAlarm{"ready.alarm", "alarm {0} is active: {1}", "действует авария {0}: {1}"};
constexpr Entry kPower{"ready.power-on", "the PLC does not permit the power: MC.power_on ({0}) is FALSE",
                       "ПЛК не разрешает питание: MC.power_on ({0}) = FALSE"};
constexpr Entry kOffline{"ready.offline", "no answer from the drive of {0}", "не отвечает привод {0}"};
constexpr Entry kSupply{"ready.supply", "Check its supply, the bus and the node number in the machine file.",
                        "Проверьте его питание, шину и номер узла в файле станка."};
constexpr Entry kAxisEnable{"ready.enable", "the PLC does not enable {0}: its `enable` is FALSE",
                            "ПЛК не разрешает {0}: `enable` = FALSE"};
constexpr Entry kStarting{"ready.starting", "{0} is not switched on yet ({1})", "{0} ещё не включена ({1})"};
constexpr Entry kWaitOrSee{
    "ready.wait", "Wait for the drive and its brake; if it stays so, see its power stage and its STO input.",
    "Дождитесь привода и тормоза; если не меняется, проверьте силовую часть и вход STO."};
constexpr Entry kEnding{"ready.switching-off", "the drives are still being switched off",
                        "приводы ещё выключаются"};
constexpr Entry kAskLater{"ready.ask-later", "Wait until they are off, then `servogate power on`.",
                          "Дождитесь их выключения, затем `servogate power on`."};
constexpr Entry kNotAsked{"ready.not-asked", "the drives are not switched on", "приводы не включены"};
constexpr Entry kAxisNotAsked{"ready.axis-not-asked", "the drive of {0} is not switched on",
                              "не включён привод {0}"};
constexpr Entry kAsk{"ready.ask", "`servogate power on`.", "`servogate power on`."};

/// Index = image::DriveState.
constexpr std::string_view kDriveWords[][2] = {
    {"it is offline", "нет связи"},
    {"it starts up", "запускается"},
    {"its power stage is locked: switch on disabled", "силовая часть заблокирована: switch on disabled"},
    {"ready to switch on", "готов к включению"},
    {"switched on, not enabled", "включён, но не разрешён"},
    {"its brake opens", "отпускается тормоз"},
    {"quick stop", "быстрый останов"},
    {"reacts to a fault", "реагирует на отказ"},
    {"in fault", "отказ"}};

class Look {
 public:
  Look(Control& control, const image::ProcessImage& image, const cycle::AlarmSnapshot& alarms,
       text::Language language)
      : control_(control), m_(control.machine()), image_(image), alarms_(alarms), language_(language) {}

  std::vector<MissingCondition> run() {
    if (axes([](const image::AxisImage& a, std::size_t) { return !a.enabled; }).empty()) return {};
    const bool chain = chain_open();
    offline();
    if (chain) return std::move(found_);
    alarms();
    if (!on(kPowerRequest) && found_.empty()) {
      const auto powered = [](const image::AxisImage& a, std::size_t) { return a.drive_command.power; };
      if (const std::string letters = axes(powered); !letters.empty())
        add("switching_off", say(kEnding), say(kAskLater), letters);
      else
        add("not_asked", say(kNotAsked), say(kAsk));
    }
    if (!on(kPowerRequest)) return std::move(found_);
    if (!on(kPowerOn)) add("power_on", say(kPower, image::to_string(kPowerOn)), plc_remedy("MC.power_on"));
    not_enabled();
    if (found_.empty()) starting();
    if (found_.empty()) not_asked();
    return std::move(found_);
  }

 private:
  std::string say(const Entry& entry, const std::string& first = {}, const std::string& second = {}) const {
    return text::render(entry, std::array{first, second}, language_);
  }
  bool on(const image::Place& place) const { return image_.packets.bit(place); }
  void add(std::string_view reason, std::string text, std::string remedy, std::string axes = {}) {
    found_.push_back({reason, std::move(text), std::move(remedy), std::move(axes)});
  }
  std::string axes(const std::function<bool(const image::AxisImage&, std::size_t)>& is) const {
    std::string letters;
    for (std::size_t a = 0; a < m_.program_axes(); ++a)
      if (is(image_.axes[a], a)) letters += (letters.empty() ? "" : ", ") + m_.axes[a].letter;
    return letters;
  }
  std::string plc_remedy(const std::string& name) const {
    image::Symbol symbol;
    symbol.name = name;
    symbol.writer = image::Writer::plc;
    return writer_remedy(m_, &symbol, name, language_);
  }

  bool chain_open() {
    int station = -1;
    const machine::PointConfig* point = m_.point(m_.safety.estop, &station);
    if (point != nullptr && !on(point->place)) {
      const bool mock = m_.stations[static_cast<std::size_t>(station)].mock();
      add("emergency_stop", say(kChain, point->name + " (" + image::to_string(point->place) + ")"),
          say(mock ? kChainMock : kChainReal, {}, point->name));
      return true;
    }
    if (on(kEstopOk)) return false;
    add("emergency_stop", say(kEstopByPlc, image::to_string(kEstopOk)), plc_remedy("MC.estop_ok"));
    return true;
  }
  void offline() {
    const std::string letters = axes([](const image::AxisImage& a, std::size_t) { return !a.drive.online; });
    if (!letters.empty()) add("drive", say(kOffline, letters), say(kSupply), letters);
  }
  void alarms() {
    const image::AlarmNames names = control_.alarm_names();
    for (int i = 0; i < alarms_.count; ++i) {
      const image::AlarmRecord& r = alarms_.records[static_cast<std::size_t>(i)];
      if (r.reaction < image::Reaction::stop_on_path || r.sequence != r.first_fault) continue;
      add("alarm", say(kAlarm, std::to_string(r.number), image::render(r, names, language_)),
          image::render_remedy(r, names, language_));
    }
  }
  void not_enabled() {
    const std::string letters = axes([&](const image::AxisImage&, std::size_t a) {
      return !on(image::at(kEnable, image::axis_base(static_cast<int>(a))));
    });
    if (!letters.empty()) add("enable", say(kAxisEnable, letters), plc_remedy("enable"), letters);
  }
  void starting() {
    for (std::size_t a = 0; a < m_.program_axes(); ++a)
      if (!image_.axes[a].enabled && image_.axes[a].drive_command.power) {
        const auto& words = kDriveWords[static_cast<std::size_t>(image_.axes[a].drive.state)];
        const std::string_view state = words[language_ == text::Language::russian];
        add("starting", say(kStarting, m_.axes[a].letter, std::string(state)), say(kWaitOrSee),
            m_.axes[a].letter);
      }
  }

  /// An axis that lost its drive by an alarm of its own; the others are on.
  void not_asked() {
    const std::string letters =
        axes([](const image::AxisImage& a, std::size_t) { return !a.enabled && !a.drive_command.power; });
    if (!letters.empty()) add("not_asked", say(kAxisNotAsked, letters), say(kAsk), letters);
  }

  Control& control_;
  const machine::MachineConfig& m_;
  const image::ProcessImage& image_;
  const cycle::AlarmSnapshot& alarms_;
  text::Language language_;
  std::vector<MissingCondition> found_;
};

}  // namespace

std::vector<MissingCondition> missing_for_power(Control& control, const image::ProcessImage& image,
                                                const cycle::AlarmSnapshot& alarms, text::Language language) {
  return Look(control, image, alarms, language).run();
}

}  // namespace servogate::gateway
