// SPDX-License-Identifier: Apache-2.0
#include "drivers/gpio/gpio_chip.hpp"

#include <utility>

#include "drivers/clock.hpp"
#include "drivers/gpio/cycle_times.hpp"
#include "drivers/gpio/edge_thread.hpp"
#include "firmware_if/image/points/point_stage.hpp"

namespace servogate::gpio {

namespace {

bool bit(std::uint64_t levels, std::size_t n) noexcept { return (levels >> n & 1u) != 0; }

/// An output while nobody commands it, as the wire has it.
bool lost_level(const image::PointRule& rule) noexcept { return rule.loss != 0.0; }

}  // namespace

/// Points stand in the order: digital inputs, encoders, outputs; lines of the request of inputs in the order:
/// digital inputs, then two for each encoder.
struct GpioChip::Parts {
  explicit Parts(const ChipConfig& config) {
    std::vector<image::PointRule> rules;
    std::vector<InputSetting> tracks;
    for (const Line& line : config.lines) {
      if (!line.rule.input) continue;
      if (!line.b_offset) {
        rules.push_back(line.rule);
        settings.push_back({line.name, line.offset, line.bias, line.edges});
      } else {
        tracks.push_back({line.name, line.offset, line.bias, true});
        tracks.push_back({line.name, *line.b_offset, line.bias, true});
      }
    }
    digital = settings.size();
    settings.insert(settings.end(), tracks.begin(), tracks.end());
    for (const Line& line : config.lines)
      if (line.rule.input && line.b_offset) rules.push_back(line.rule);
    first_output = rules.size();
    for (const Line& line : config.lines)
      if (!line.rule.input) {
        if (lost_level(line.rule)) loss_levels |= std::uint64_t{1} << output_settings.size();
        output_settings.push_back({line.name, line.offset, lost_level(line.rule)});
        rules.push_back(line.rule);
      }
    written = loss_levels;
    stage = image::PointStage(std::move(rules), config.source);
  }

  bool take_lines(const ChipConfig& config, drivers::Notice& why) {
    chip = Chip::find(config.chip, why);
    if (chip == nullptr) return false;
    if (!settings.empty() && (inputs = chip->inputs(settings, config.consumer, why)) == nullptr) return false;
    if (!output_settings.empty() &&
        (outputs = chip->outputs(output_settings, config.consumer, why)) == nullptr)
      return false;
    if (inputs == nullptr || inputs->descriptor() < 0) return true;
    std::vector<bool> told;
    std::vector<Encoder> encoders;
    for (std::size_t n = 0; n < settings.size(); ++n) told.push_back(n < digital && settings[n].edges);
    for (std::size_t n = digital; n < settings.size(); n += 2) encoders.push_back({n, n + 1});
    edges.emplace(*inputs, std::move(told), encoders);
    return true;
  }

  ~Parts() {
    if (outputs != nullptr) outputs->write(loss_levels);
  }

  /// What edges tell of themselves is of the source, too.
  void count_faults() noexcept {
    const std::uint32_t faults = edges->lost() + edges->encoder_errors();
    for (int n = 0; n < kMostFaults && faults_told != faults; ++n, ++faults_told) stage.fault();
  }

  void show_edges(image::ProcessImage& image) noexcept {
    LineEvent event;
    for (std::size_t n = 0; n < image::Edges::kCapacity && edges->take(event); ++n) {
      const image::PointRule& rule = stage.rule(event.line);
      image.edges.add({rule.place, event.level != rule.inverted, times.machine(event.t_ns)});
    }
    const std::uint32_t lost = edges->lost();
    image.edges.note_lost(lost - lost_told);
    lost_told = lost;
  }

  std::unique_ptr<Chip> chip;
  std::vector<InputSetting> settings;
  std::vector<OutputSetting> output_settings;
  std::size_t digital = 0, first_output = 0;
  std::unique_ptr<InputLines> inputs;
  std::unique_ptr<OutputLines> outputs;
  image::PointStage stage;
  CycleTimes times;
  std::optional<EdgeThread> edges;        ///< ends before the inputs that it reads
  static constexpr int kMostFaults = 16;  ///< that one cycle takes in
  std::uint32_t lost_told = 0, faults_told = 0;
  std::uint64_t loss_levels = 0, written = 0;
  bool stale = false;  ///< what stands at the outputs may not be what was written last
};

GpioChip::GpioChip(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
GpioChip::~GpioChip() = default;

std::unique_ptr<GpioChip> GpioChip::open(const ChipConfig& config, drivers::Notice& why) {
  auto parts = std::make_unique<Parts>(config);
  if (!parts->take_lines(config, why)) return nullptr;
  return std::unique_ptr<GpioChip>(new GpioChip(std::move(parts)));
}

bool GpioChip::available(const ChipConfig& config, drivers::Notice& why) {
  const Parts parts(config);
  const auto chip = Chip::find(config.chip, why);
  return chip != nullptr && chip->free(parts.settings, why) && chip->free(parts.output_settings, why);
}

void GpioChip::open_cycle(image::ProcessImage& image) noexcept {
  if (parts_->edges) parts_->times.open(drivers::clock_ns(CLOCK_MONOTONIC), image.now.t_ns);
}

void GpioChip::receive(image::ProcessImage& image, image::Notices&) noexcept {
  Parts& p = *parts_;
  std::uint64_t levels = 0;
  const bool read = p.inputs == nullptr || (p.inputs->read(levels) && !(p.edges && p.edges->ended()));
  // Outputs that cannot be written are as bad as inputs that cannot be read.
  if (read && !p.stale) {
    for (std::size_t n = 0; n < p.digital; ++n) p.stage.take(n, bit(levels, n) ? 1.0 : 0.0);
    for (std::size_t n = p.digital; n < p.first_output; ++n) p.stage.take(n, p.edges->count(n - p.digital));
    p.stage.fresh(0, image.now.t_ns);
  } else {
    if (!read) p.stage.fault();
    p.stage.lost(0);
  }
  if (p.edges) p.count_faults();
  p.stage.settle(image);
  if (p.edges) p.show_edges(image);
}

void GpioChip::send(image::ProcessImage& image) noexcept {
  Parts& p = *parts_;
  if (p.outputs == nullptr) return;
  std::uint64_t levels = 0;
  for (std::size_t n = 0; n < p.output_settings.size(); ++n)
    if (p.stage.level(p.first_output + n, image.packets)) levels |= std::uint64_t{1} << n;
  if (levels == p.written && !p.stale) return;
  p.written = levels;
  p.stale = !p.outputs->write(levels);
  if (p.stale) p.stage.fault();
}

ChipCounters GpioChip::counters() const noexcept {
  if (!parts_->edges) return {};
  return {parts_->edges->taken(), parts_->edges->lost(), parts_->edges->encoder_errors()};
}

}  // namespace servogate::gpio
