// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/words/stop_words.hpp"

#include <array>

#include "gateway/control/run/words/wait_words.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::gateway {

namespace {

using text::Entry;

constexpr Entry kInLine{"stop.in-line", "the program was stopped in line {0}: {1}",
                        "программа остановлена в строке {0}: {1}"};
constexpr Entry kSomewhere{"stop.somewhere", "the program was stopped: {1}", "программа остановлена: {1}"};
constexpr Entry kTyped{"stop.typed", "the typed block was stopped: {1}", "введённый кадр остановлен: {1}"};
constexpr Entry kDrivesOff{"stop.drives-off", "{0} switched the drives off while it ran",
                           "приводы выключены во время выполнения ({0})"};
constexpr Entry kEnable{"stop.enable-withdrawn",
                        "the PLC took the enable of the drives away ({0}.enable or MC.power_on)",
                        "ПЛК снял разрешение приводов ({0}.enable или MC.power_on)"};
constexpr Entry kAgain{"stop.again",
                       "`servogate power on`, then `servogate start` runs the program from its beginning.",
                       "`servogate power on`, затем `servogate start` выполнит программу с начала."};
constexpr Entry kAgainTyped{"stop.again-typed", "`servogate power on`, then type the block again.",
                            "`servogate power on`, затем введите кадр снова."};
constexpr Entry kSeePlc{"stop.see-plc", "See in {0} what took it away; {1}",
                        "Посмотрите в {0}, что его сняло; {1}"};

}  // namespace

std::optional<StopWords> stop_words(Control& control, const image::ProcessImage& image, int process,
                                    text::Language language) {
  const image::ProcessStatus& p = image.processes[static_cast<std::size_t>(process)];
  if (p.state != image::ProcessState::stopped || p.stop.cause == image::StopCause::none) return std::nullopt;
  const machine::MachineConfig& m = control.machine();
  const auto say = [&](const Entry& entry, const std::string& first = {}, const std::string& second = {}) {
    return text::render(entry, std::array{first, second}, language);
  };
  const bool by_plc = p.stop.cause == image::StopCause::enable_withdrawn;
  const std::string letter =
      p.stop.axis >= 0 ? m.axes[static_cast<std::size_t>(p.stop.axis)].letter : std::string();
  const std::string cause =
      by_plc ? say(kEnable, letter) : say(kDrivesOff, cycle::asker_words(p.stop.asker, language));
  StopWords w;
  w.cause = by_plc ? "enable_withdrawn" : "drives_off";
  w.text = p.typed ? say(kTyped, {}, cause)
                   : say(p.line > 0 ? kInLine : kSomewhere, std::to_string(p.line), cause);
  w.remedy = say(p.typed ? kAgainTyped : kAgain);
  if (by_plc) w.remedy = say(kSeePlc, plc_sources(m), w.remedy);
  return w;
}

}  // namespace servogate::gateway
