// SPDX-License-Identifier: Apache-2.0
#include "drivers/gpio/gpio_chip.hpp"

#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware_if/image/points/point_stage.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::gpio {

namespace {

using text::Entry;

const Entry kNoChip{"gpio.no-chip", "there is no GPIO chip {0}; there are: {1} (see `gpiodetect`)",
                    "нет микросхемы GPIO {0}; есть: {1} (см. `gpiodetect`)"};
const Entry kNoChips{"gpio.no-chips", "there is no GPIO chip {0}: this computer has none",
                     "нет микросхемы GPIO {0}: на этом компьютере их нет"};
const Entry kNotAllowed{
    "gpio.not-allowed",
    "the GPIO chip {0} may not be opened: {1}. Allow it: sudo usermod -aG gpio $USER, or a "
    "udev rule for /dev/gpiochip*, then log in again",
    "микросхему GPIO {0} нельзя открыть: {1}. Разрешить: sudo usermod -aG gpio $USER или "
    "правило udev для /dev/gpiochip*, затем войти заново"};
const Entry kNoLine{"gpio.no-line", "'{0}': the GPIO chip {1} has no line {2}; its lines are 0 to {3}",
                    "«{0}»: у микросхемы GPIO {1} нет линии {2}; её линии — от 0 до {3}"};
const Entry kTooMany{"gpio.too-many", "the GPIO chip {0} can carry {1} lines of one direction, not {2}",
                     "микросхема GPIO {0}: не более {1} линий одного направления, а не {2}"};
const Entry kHeld{
    "gpio.line-held",
    "'{0}': line {2} of the GPIO chip {1} is held by '{3}'; end that program or its overlay",
    "«{0}»: линию {2} микросхемы GPIO {1} занимает «{3}»; завершите эту программу или уберите её "
    "оверлей"};
const Entry kRefused{"gpio.refused", "the lines of the GPIO chip {0} are not given: {1}",
                     "линии микросхемы GPIO {0} не предоставлены: {1}"};

struct CloseChip {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

/// Labels and names of all chips, for a message.
std::string chips_there() {
  std::string list;
  gpiod_chip_iter* all = gpiod_chip_iter_new();
  if (all == nullptr) return list;
  for (gpiod_chip* chip = gpiod_chip_iter_next(all); chip != nullptr; chip = gpiod_chip_iter_next(all))
    list +=
        (list.empty() ? "" : ", ") + std::string(gpiod_chip_label(chip)) + " (" + gpiod_chip_name(chip) + ")";
  gpiod_chip_iter_free(all);
  return list;
}

bool fail(drivers::Notice& why, const Entry& entry, std::vector<std::string> arguments) {
  why = {&entry, std::move(arguments)};
  return false;
}

}  // namespace

/// The lines of one direction, as the kernel gives them together.
struct GpioChip::Lines {
  explicit Lines(const ChipConfig& config) {
    std::vector<image::PointRule> rules;
    for (const bool input : {true, false})
      for (const Line& line : config.lines)
        if (line.rule.input == input) {
          rules.push_back(line.rule);
          (input ? inputs_of : outputs_of).push_back(line);
        }
    stage = image::PointStage(std::move(rules), config.source);
    gpiod_line_bulk_init(&inputs);
    gpiod_line_bulk_init(&outputs);
    levels.fill(0);
    written.fill(0);
  }

  bool find_chip(const std::string& name, drivers::Notice& why) {
    errno = 0;
    chip.reset(gpiod_chip_open_lookup(name.c_str()));
    if (chip != nullptr) return true;
    if (errno == EACCES || errno == EPERM) return fail(why, kNotAllowed, {name, text::words_of(errno)});
    const std::string there = chips_there();
    return there.empty() ? fail(why, kNoChips, {name}) : fail(why, kNoChip, {name, there});
  }

  bool find_lines(const std::string& name, const std::vector<Line>& wanted, gpiod_line_bulk& bulk,
                  drivers::Notice& why) {
    if (wanted.size() > kMostLines)
      return fail(why, kTooMany, {name, std::to_string(kMostLines), std::to_string(wanted.size())});
    for (const Line& w : wanted) {
      const unsigned count = gpiod_chip_num_lines(chip.get());
      gpiod_line* line = w.offset < count ? gpiod_chip_get_line(chip.get(), w.offset) : nullptr;
      if (line == nullptr)
        return fail(why, kNoLine,
                    {w.name, name, std::to_string(w.offset), std::to_string(count > 0 ? count - 1 : 0)});
      if (gpiod_line_is_used(line)) {
        const char* holder = gpiod_line_consumer(line);
        return fail(why, kHeld, {w.name, name, std::to_string(w.offset), holder != nullptr ? holder : "?"});
      }
      gpiod_line_bulk_add(&bulk, line);
    }
    return true;
  }

  /// An output while nobody commands it, as the wire has it.
  static int lost_level(const image::PointRule& rule) noexcept { return rule.loss != 0.0 ? 1 : 0; }

  bool request(const ChipConfig& config, drivers::Notice& why) {
    if (!find_lines(config.chip, inputs_of, inputs, why) ||
        !find_lines(config.chip, outputs_of, outputs, why))
      return false;
    for (std::size_t n = 0; n < outputs_of.size(); ++n) written[n] = lost_level(outputs_of[n].rule);
    const char* consumer = config.consumer.c_str();
    if (!inputs_of.empty() && gpiod_line_request_bulk_input(&inputs, consumer) != 0)
      return fail(why, kRefused, {config.chip, text::words_of(errno)});
    inputs_taken = !inputs_of.empty();
    if (!outputs_of.empty() && gpiod_line_request_bulk_output(&outputs, consumer, written.data()) != 0)
      return fail(why, kRefused, {config.chip, text::words_of(errno)});
    outputs_taken = !outputs_of.empty();
    return true;
  }

  ~Lines() {
    if (outputs_taken) {
      for (std::size_t n = 0; n < outputs_of.size(); ++n) written[n] = lost_level(outputs_of[n].rule);
      gpiod_line_set_value_bulk(&outputs, written.data());
      gpiod_line_release_bulk(&outputs);
    }
    if (inputs_taken) gpiod_line_release_bulk(&inputs);
  }

  Chip chip;
  std::vector<Line> inputs_of, outputs_of;
  gpiod_line_bulk inputs, outputs;
  bool inputs_taken = false, outputs_taken = false;
  image::PointStage stage;  ///< inputs, then outputs
  std::array<int, kMostLines> levels, written;
  bool stale = false;  ///< what stands at the outputs may not be what was written last
};

GpioChip::GpioChip(std::unique_ptr<Lines> lines) : lines_(std::move(lines)) {}
GpioChip::~GpioChip() = default;

std::unique_ptr<GpioChip> GpioChip::open(const ChipConfig& config, drivers::Notice& why) {
  auto lines = std::make_unique<Lines>(config);
  if (!lines->find_chip(config.chip, why) || !lines->request(config, why)) return nullptr;
  return std::unique_ptr<GpioChip>(new GpioChip(std::move(lines)));
}

void GpioChip::receive(image::ProcessImage& image, image::Notices&) noexcept {
  Lines& l = *lines_;
  const bool read = !l.inputs_taken || gpiod_line_get_value_bulk(&l.inputs, l.levels.data()) == 0;
  // Outputs that cannot be written are as bad as inputs that cannot be read.
  if (read && !l.stale) {
    for (std::size_t n = 0; n < l.inputs_of.size(); ++n) l.stage.take(n, l.levels[n]);
    l.stage.fresh(0, image.now.t_ns);
  } else {
    if (!read) l.stage.fault();
    l.stage.lost(0);
  }
  l.stage.settle(image);
}

void GpioChip::send(image::ProcessImage& image) noexcept {
  Lines& l = *lines_;
  if (!l.outputs_taken) return;
  bool changed = l.stale;
  for (std::size_t n = 0; n < l.outputs_of.size(); ++n) {
    const int level = l.stage.level(l.inputs_of.size() + n, image.packets) ? 1 : 0;
    changed = changed || level != l.written[n];
    l.written[n] = level;
  }
  if (!changed) return;
  l.stale = gpiod_line_set_value_bulk(&l.outputs, l.written.data()) != 0;
  if (l.stale) l.stage.fault();
}

}  // namespace servogate::gpio
