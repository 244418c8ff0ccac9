// SPDX-License-Identifier: Apache-2.0
#include "drivers/gpio/chip.hpp"

#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>
#include <vector>

#include "drivers/gpio/kernel_inputs.hpp"
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
const Entry kNoEdges{
    "gpio.no-edges",
    "the GPIO chip {0} does not give its lines with edges or with a bias: {1}. Take `edges`, `bias` and "
    "`b_line` away from its points, or wire them to a chip with interrupts and resistors of its own",
    "микросхема GPIO {0} не предоставляет линии с фронтами или с подтяжкой: {1}. Уберите `edges`, `bias` и "
    "`b_line` у её точек или подключите их к микросхеме с прерываниями и собственными резисторами"};

struct CloseChip {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }
};
using OpenChip = std::unique_ptr<gpiod_chip, CloseChip>;

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

std::nullptr_t refuse(drivers::Notice& why, const Entry& entry, std::vector<std::string> arguments) {
  why = {&entry, std::move(arguments)};
  return nullptr;
}

int flags_of(Bias bias) noexcept {
  switch (bias) {
    case Bias::off:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case Bias::up:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case Bias::down:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case Bias::as_is:
      break;
  }
  return 0;
}

class GpiodInputs final : public InputLines {
 public:
  explicit GpiodInputs(const gpiod_line_bulk& lines) : lines_(lines) {}
  ~GpiodInputs() override { gpiod_line_release_bulk(&lines_); }
  GpiodInputs(const GpiodInputs&) = delete;
  GpiodInputs& operator=(const GpiodInputs&) = delete;

  bool read(std::uint64_t& levels) noexcept override {
    if (gpiod_line_get_value_bulk(&lines_, values_.data()) != 0) return false;
    levels = 0;
    for (unsigned n = 0; n < lines_.num_lines; ++n)
      if (values_[n] != 0) levels |= std::uint64_t{1} << n;
    return true;
  }

 private:
  gpiod_line_bulk lines_;
  std::array<int, kMostLines> values_{};
};

class GpiodOutputs final : public OutputLines {
 public:
  explicit GpiodOutputs(const gpiod_line_bulk& lines) : lines_(lines) {}
  ~GpiodOutputs() override { gpiod_line_release_bulk(&lines_); }
  GpiodOutputs(const GpiodOutputs&) = delete;
  GpiodOutputs& operator=(const GpiodOutputs&) = delete;

  bool write(std::uint64_t levels) noexcept override {
    for (unsigned n = 0; n < lines_.num_lines; ++n) values_[n] = static_cast<int>(levels >> n & 1u);
    return gpiod_line_set_value_bulk(&lines_, values_.data()) == 0;
  }

 private:
  gpiod_line_bulk lines_;
  std::array<int, kMostLines> values_{};
};

}  // namespace

struct Chip::Impl {
  std::string name;  ///< as it was asked for
  OpenChip chip;

  template <typename Setting>
  bool find_lines(std::span<const Setting> wanted, gpiod_line_bulk& bulk, drivers::Notice& why) const {
    gpiod_line_bulk_init(&bulk);
    if (wanted.size() > kMostLines) {
      refuse(why, kTooMany, {name, std::to_string(kMostLines), std::to_string(wanted.size())});
      return false;
    }
    for (const Setting& w : wanted) {
      const unsigned count = gpiod_chip_num_lines(chip.get());
      gpiod_line* line = w.offset < count ? gpiod_chip_get_line(chip.get(), w.offset) : nullptr;
      if (line == nullptr) {
        refuse(why, kNoLine,
               {w.name, name, std::to_string(w.offset), std::to_string(count > 0 ? count - 1 : 0)});
        return false;
      }
      if (gpiod_line_is_used(line)) {
        const char* holder = gpiod_line_consumer(line);
        refuse(why, kHeld, {w.name, name, std::to_string(w.offset), holder != nullptr ? holder : "?"});
        return false;
      }
      gpiod_line_bulk_add(&bulk, line);
    }
    return true;
  }
};

Chip::Chip(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Chip::~Chip() = default;

std::unique_ptr<Chip> Chip::find(const std::string& name, drivers::Notice& why) {
  errno = 0;
  OpenChip chip(gpiod_chip_open_lookup(name.c_str()));
  if (chip == nullptr) {
    if (errno == EACCES || errno == EPERM) return refuse(why, kNotAllowed, {name, text::words_of(errno)});
    const std::string there = chips_there();
    return there.empty() ? refuse(why, kNoChips, {name}) : refuse(why, kNoChip, {name, there});
  }
  return std::unique_ptr<Chip>(new Chip(std::make_unique<Impl>(Impl{name, std::move(chip)})));
}

bool Chip::free(std::span<const InputSetting> lines, drivers::Notice& why) const {
  gpiod_line_bulk bulk;
  return impl_->find_lines(lines, bulk, why);
}

bool Chip::free(std::span<const OutputSetting> lines, drivers::Notice& why) const {
  gpiod_line_bulk bulk;
  return impl_->find_lines(lines, bulk, why);
}

std::unique_ptr<InputLines> Chip::inputs(std::span<const InputSetting> lines, const std::string& consumer,
                                         drivers::Notice& why) {
  gpiod_line_bulk bulk;
  if (!impl_->find_lines(lines, bulk, why)) return nullptr;
  const bool edges = std::ranges::any_of(lines, &InputSetting::edges);
  const bool biases =
      std::ranges::any_of(lines, [&](const InputSetting& l) { return l.bias != lines.front().bias; });
  if (edges || biases) {
    const std::string path = std::string("/dev/") + gpiod_chip_name(impl_->chip.get());
    auto inputs = KernelInputs::request(path, lines, consumer);
    if (inputs == nullptr) return refuse(why, kNoEdges, {impl_->name, text::words_of(errno)});
    return inputs;
  }
  const gpiod_line_request_config config{consumer.c_str(), GPIOD_LINE_REQUEST_DIRECTION_INPUT,
                                         flags_of(lines.front().bias)};
  if (gpiod_line_request_bulk(&bulk, &config, nullptr) != 0)
    return refuse(why, kRefused, {impl_->name, text::words_of(errno)});
  return std::make_unique<GpiodInputs>(bulk);
}

std::unique_ptr<OutputLines> Chip::outputs(std::span<const OutputSetting> lines, const std::string& consumer,
                                           drivers::Notice& why) {
  gpiod_line_bulk bulk;
  if (!impl_->find_lines(lines, bulk, why)) return nullptr;
  std::array<int, kMostLines> levels{};
  for (std::size_t n = 0; n < lines.size(); ++n) levels[n] = lines[n].level ? 1 : 0;
  if (gpiod_line_request_bulk_output(&bulk, consumer.c_str(), levels.data()) != 0)
    return refuse(why, kRefused, {impl_->name, text::words_of(errno)});
  return std::make_unique<GpiodOutputs>(bulk);
}

}  // namespace servogate::gpio
