// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/io/io_link.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::canopen {
namespace {

std::uint64_t limited(double raw, std::uint8_t bits) noexcept {
  if (!std::isfinite(raw)) return 0;
  const double limit = std::ldexp(1.0, bits - 1);
  return static_cast<std::uint64_t>(std::llround(std::clamp(raw, -limit, limit - 1.0)));
}

image::PointStage stage_of(const NodeConfig& node) {
  std::vector<image::PointRule> rules;
  for (const IoPoint& p : node.io.points) rules.push_back(p.rule);
  return image::PointStage(std::move(rules), node.target_index);
}

}  // namespace

IoLink::IoLink(const NodeConfig& node, const SegmentConfig& segment)
    : watch_(node.profile.tpdo, segment.cycle_ns, max_missed_pdo(node, segment)),
      data_(node.profile, segment.cycle_ns),
      stage_(stage_of(node)) {
  for (const IoPoint& p : node.io.points) {
    PdoField field = find_field(p.rule.input ? node.profile.tpdo : node.profile.rpdo, p.index, p.subindex);
    if (p.rule.digital) {
      field.offset = static_cast<std::uint8_t>(field.offset + p.bit);
      field.bits = 1;
    }
    fields_.push_back(field);
  }
  restart();
}

void IoLink::restart() noexcept {
  data_.clear();
  watch_.restart();
}

bool IoLink::update() noexcept {
  const bool on_time = watch_.step(data_);
  data_.end_of_cycle();
  return on_time;
}

void IoLink::fill(image::ProcessImage& image, bool online) noexcept {
  if (online)
    stage_.fresh(0, image.now.t_ns);
  else
    stage_.lost(0);
  for (std::size_t n = 0; online && n < stage_.size(); ++n) {
    const image::PointRule& rule = stage_.rule(n);
    if (!rule.input) continue;
    stage_.take(n, rule.digital ? static_cast<double>(data_.raw(fields_[n]))
                                : static_cast<double>(data_.number(fields_[n])));
  }
  stage_.settle(image);
}

void IoLink::apply(const image::Packets& packets, bool online) noexcept {
  for (std::size_t n = 0; n < stage_.size(); ++n) {
    const image::PointRule& rule = stage_.rule(n);
    if (rule.input || (!online && rule.hold)) continue;
    if (rule.digital)
      data_.set(fields_[n], (online ? stage_.level(n, packets) : rule.loss != 0.0) ? 1 : 0);
    else
      data_.set(fields_[n], online ? limited(stage_.raw(n, packets), fields_[n].bits)
                                   : static_cast<std::uint64_t>(std::llround(rule.loss)));
  }
}

}  // namespace servogate::canopen
