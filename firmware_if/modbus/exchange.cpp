// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/exchange.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace servogate::modbus {

Exchange::Exchange(Map map, const std::vector<Unit>& units, int stale_after_periods)
    : map_(std::move(map)), blocks_(map_.blocks.size()) {
  std::vector<std::vector<image::PointRule>> rules(units.size());
  std::vector<std::vector<image::AgeLimits>> limits(units.size());
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    const Block& block = map_.blocks[n];
    const auto unit = std::ranges::find(units, block.unit, &Unit::unit);
    if (unit == units.end())
      throw std::invalid_argument("a block names Modbus unit " + std::to_string(block.unit) +
                                  ", which no station has");
    blocks_[n].unit = static_cast<std::size_t>(unit - units.begin());
    auto& groups = limits[blocks_[n].unit];
    blocks_[n].group = groups.size();
    const image::Nanoseconds stale = block.period_ns * stale_after_periods;
    groups.push_back({stale, 2 * stale});
  }
  for (const Point& p : map_.points) {
    BlockState& block = blocks_[p.block];
    const Function function = map_.blocks[p.block].function;
    image::PointRule rule = p.rule;
    rule.input = !writes(function);
    rule.digital = carries_bits(function) || p.bit >= 0;
    rule.group = static_cast<std::uint16_t>(block.group);
    block.points.push_back({p, rules[block.unit].size()});
    rules[block.unit].push_back(rule);
  }
  for (std::size_t u = 0; u < units.size(); ++u)
    stages_.emplace_back(std::move(rules[u]), units[u].source, std::move(limits[u]));
  for (const Inverter& inverter : map_.inverters) {
    inverters_.emplace_back(inverter);
    for (std::size_t n = 0; n < blocks_.size(); ++n)
      if (inverters_.back().writes_to(n)) blocks_[n].of_inverter = true;
  }
}

void Exchange::take(const Outcome& outcome) noexcept {
  const BlockState& block = blocks_[outcome.block];
  image::PointStage& stage = stages_[block.unit];
  if (!outcome.good) return stage.fault();
  stage.fresh(block.group, outcome.end_ns);
  for (InverterControl& inverter : inverters_) inverter.take(outcome);
  if (writes(map_.blocks[outcome.block].function)) return;
  for (const Carried& p : block.points)
    stage.take(p.in_stage, raw_value(map_.blocks[outcome.block], p.point, outcome.data));
}

void Exchange::receive(image::ProcessImage& image) noexcept {
  for (image::PointStage& stage : stages_) stage.settle(image);
  for (InverterControl& inverter : inverters_)
    inverter.receive(image, quality(inverter.inverter(), image.now.t_ns));
}

/// That of the worst of its blocks.
image::Quality Exchange::quality(const Inverter& inverter, image::Nanoseconds t) const noexcept {
  image::Quality worst = image::Quality::good;
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    if (map_.blocks[n].unit != inverter.unit) continue;
    const image::Quality q = stages_[blocks_[n].unit].quality(blocks_[n].group, t);
    if (q == image::Quality::good) continue;
    if (worst == image::Quality::good || q > worst) worst = q;
  }
  return worst;
}

void Exchange::send(const image::ProcessImage& image, WriteSink& sink) noexcept {
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    BlockState& block = blocks_[n];
    if (!writes(map_.blocks[n].function) || block.of_inverter) continue;
    bool changed = !block.armed;
    const image::PointStage& stage = stages_[block.unit];
    const bool coils = carries_bits(map_.blocks[n].function);
    for (const Carried& p : block.points) {
      if (coils && stage.level(p.in_stage, image.packets) == block.data.bit(p.point.offset)) continue;
      changed =
          set_raw_value(map_.blocks[n], p.point, stage.raw(p.in_stage, image.packets), block.data) || changed;
    }
    if (!changed) continue;
    block.armed = true;
    sink.write(n, block.data, image.now.t_ns);
  }
  for (InverterControl& inverter : inverters_) inverter.send(image, sink);
}

void Exchange::leave(WriteSink& sink) noexcept {
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    BlockState& block = blocks_[n];
    if (!block.armed || block.of_inverter) continue;
    for (const Carried& p : block.points)
      if (!p.point.rule.hold) set_raw_value(map_.blocks[n], p.point, p.point.rule.loss, block.data);
    sink.write(n, block.data, 0);
  }
  for (InverterControl& inverter : inverters_) inverter.leave(sink);
}

}  // namespace servogate::modbus
