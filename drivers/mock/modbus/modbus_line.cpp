// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/modbus/modbus_line.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace servogate::mock {

using image::Nanoseconds;
using image::Quality;

namespace {

// RTU adds station address and checksum to a PDU. Source: Modbus over Serial Line V1.02, section 2.5.1.
constexpr std::size_t kRtuOverhead = 3;
constexpr int kBitsPerCharacter = 11;
constexpr Nanoseconds kFastSilence = 1'750'000;  // fixed above 19200 baud, section 2.5.1.1

}  // namespace

MockModbusLine::MockModbusLine(LineSettings line, modbus::Map map, std::vector<StationSettings> stations,
                               int first_source)
    : line_(line), map_(std::move(map)), first_source_(first_source) {
  for (StationSettings& s : stations) stations_.emplace_back(std::move(s));
  health_.resize(stations_.size());
  blocks_.resize(map_.blocks.size());
  for (const modbus::Block& block : map_.blocks) {
    const auto found = std::find_if(stations_.begin(), stations_.end(),
                                    [&](const ModbusStation& s) { return s.settings().unit == block.unit; });
    if (found == stations_.end())
      throw std::invalid_argument("a block names Modbus unit " + std::to_string(block.unit) +
                                  ", which no station has");
    block_station_.push_back(static_cast<std::size_t>(found - stations_.begin()));
  }
}

Nanoseconds MockModbusLine::characters_ns(std::size_t count) const noexcept {
  if (line_.baud == 0) return 0;
  return static_cast<Nanoseconds>(count) * kBitsPerCharacter * image::kSecond / line_.baud;
}

Nanoseconds MockModbusLine::silence_ns() const noexcept {
  if (line_.baud == 0) return 0;
  return line_.baud > 19200 ? kFastSilence : characters_ns(7) / 2;
}

Nanoseconds MockModbusLine::transaction_ns(const modbus::Block& b, Nanoseconds answer_delay) const noexcept {
  return line_.latency_ns + characters_ns(request_size(b.function, b.count) + kRtuOverhead) + answer_delay +
         characters_ns(response_size(b.function, b.count) + kRtuOverhead) + silence_ns();
}

double MockModbusLine::planned_load() const noexcept {
  double load = 0.0;
  for (std::size_t n = 0; n < map_.blocks.size(); ++n) {
    const Nanoseconds delay = stations_[block_station_[n]].settings().answer_delay_ns;
    load += static_cast<double>(transaction_ns(map_.blocks[n], delay)) /
            static_cast<double>(map_.blocks[n].period_ns);
  }
  return load;
}

void MockModbusLine::start_at(Nanoseconds t) {
  started_ = true;
  start_ns_ = idle_since_ns_ = t;
  for (BlockState& b : blocks_) b.due_ns = t;
}

void MockModbusLine::advance_to(Nanoseconds t) {
  if (!started_) start_at(t);
  for (;;) {
    if (!now_.active) {
      std::size_t block = 0;
      Nanoseconds start = 0;
      if (!pick(block, start) || start > t) break;
      open(block, start, 0);
    }
    if (!now_.served && now_.arrival_ns <= t) serve();
    if (!now_.served || now_.end_ns > t) break;
    close();
  }
  for (ModbusStation& s : stations_) s.advance_to(t);
}

Nanoseconds MockModbusLine::ready_ns(std::size_t n) const noexcept {
  const Health& health = health_[block_station_[n]];
  return health.lost ? std::max(blocks_[n].due_ns, health.retry_ns) : blocks_[n].due_ns;
}

bool MockModbusLine::pick(std::size_t& block, Nanoseconds& start) const {
  bool found = false;
  for (std::size_t i = 1; i <= blocks_.size(); ++i) {
    const std::size_t n = (last_block_ + i) % blocks_.size();  // who was served last comes last among equals
    if (modbus::writes(map_.blocks[n].function) && !blocks_[n].armed) continue;
    const Nanoseconds ready = std::max(ready_ns(n), idle_since_ns_);
    if (found && ready >= start) continue;
    found = true;
    block = n;
    start = ready;
  }
  return found;
}

void MockModbusLine::open(std::size_t n, Nanoseconds start, int attempt) {
  const modbus::Block& b = map_.blocks[n];
  now_.active = true;
  now_.block = n;
  now_.attempt = attempt;
  now_.served = now_.answered = false;
  now_.arrival_ns =
      start + line_.latency_ns / 2 + characters_ns(request_size(b.function, b.count) + kRtuOverhead);
  now_.end_ns = now_.arrival_ns;
  now_.request.function = b.function;
  now_.request.address = b.address;
  now_.request.count = b.count;
  if (modbus::writes(b.function)) now_.request.data = blocks_[n].data;
  blocks_[n].changed = false;
  if (attempt == 0) blocks_[n].due_ns = std::max(blocks_[n].due_ns + b.period_ns, start);
  last_block_ = n;
  ++transactions_;
}

void MockModbusLine::serve() {
  ModbusStation& station = station_of(now_.block);
  modbus::Pdu request;
  encode(now_.request, request);
  const Nanoseconds delay = station.answer_delay_ns();
  const bool answered = station.serve(now_.arrival_ns, request, now_.answer);
  const Nanoseconds patience = now_.arrival_ns + line_.answer_timeout_ns;
  const Nanoseconds complete = now_.arrival_ns + delay + characters_ns(now_.answer.size + kRtuOverhead) +
                               line_.latency_ns - line_.latency_ns / 2 + silence_ns();
  // A late answer is thrown away with the silence after it; it never counts for the next request.
  now_.end_ns = !answered                         ? patience
                : delay > line_.answer_timeout_ns ? std::max(patience, complete)
                                                  : complete;
  now_.answered =
      answered && delay <= line_.answer_timeout_ns && station.fault().kind != StationFault::Kind::garbled;
  now_.served = true;
}

void MockModbusLine::close() {
  now_.active = false;
  idle_since_ns_ = now_.end_ns;
  modbus::Response response;
  if (!now_.answered ||
      decode_response(now_.answer.view(), now_.request, response) != modbus::AnswerFault::none) {
    fail(true);
  } else if (response.exception != modbus::Exception::none) {
    health_of(now_.block).last_exception = response.exception;
    fail(false);
  } else {
    succeed(response);
  }
}

void MockModbusLine::succeed(const modbus::Response& response) {
  BlockState& state = blocks_[now_.block];
  health_of(now_.block).lost = false;
  state.updated_ns = now_.end_ns;
  if (modbus::writes(response.function)) {
    if (state.changed) state.due_ns = std::min(state.due_ns, now_.end_ns);
    return;
  }
  state.data = response.data;
  state.fresh = true;
}

void MockModbusLine::fail(bool worth_repeating) {
  Health& health = health_of(now_.block);
  ++health.errors;
  if (modbus::writes(map_.blocks[now_.block].function)) blocks_[now_.block].changed = true;
  if (!worth_repeating) return;
  if (!health.lost && now_.attempt < line_.retries) {
    open(now_.block, now_.end_ns, now_.attempt + 1);
    return;
  }
  health.lost = true;
  health.retry_ns = now_.end_ns + line_.lost_retry_ns;
}

void MockModbusLine::receive(image::ProcessImage& image) noexcept {
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    if (modbus::writes(map_.blocks[n].function)) continue;
    if (blocks_[n].fresh) {
      blocks_[n].fresh = false;
      scatter(map_, n, blocks_[n].data, image.packets);
    }
    if (quality(n, image.now.t_ns) == Quality::bad) apply_loss(map_, n, image.packets);
  }
  for (std::size_t s = 0; s < stations_.size(); ++s) update_source(s, image);
}

void MockModbusLine::send(image::ProcessImage& image) noexcept {
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    if (!modbus::writes(map_.blocks[n].function)) continue;
    BlockState& state = blocks_[n];
    if (gather(map_, n, image.packets, state.data) || !state.armed) {
      state.changed = true;
      state.due_ns = std::min(state.due_ns, image.now.t_ns);
    }
    state.armed = true;
  }
}

Quality MockModbusLine::quality(std::size_t n, Nanoseconds t) const noexcept {
  const BlockState& state = blocks_[n];
  const Nanoseconds limit = map_.blocks[n].period_ns * line_.stale_after_periods;
  const Nanoseconds age = t - std::max(state.updated_ns, start_ns_);
  if (age > 2 * limit) return Quality::bad;
  if (state.updated_ns < 0) return Quality::never;
  return age > limit ? Quality::stale : Quality::good;
}

void MockModbusLine::update_source(std::size_t station, image::ProcessImage& image) const noexcept {
  const int index = first_source_ + static_cast<int>(station);
  if (index < 0 || index >= image::kMaxSources) return;
  const auto severity = [](Quality q) {
    return q == Quality::bad ? 3 : q == Quality::stale ? 2 : q == Quality::never;
  };
  Quality worst = Quality::good;
  Nanoseconds newest = 0;
  for (std::size_t n = 0; n < blocks_.size(); ++n) {
    if (block_station_[n] != station) continue;
    if (modbus::writes(map_.blocks[n].function) && !blocks_[n].armed) continue;
    newest = std::max(newest, blocks_[n].updated_ns);
    const Quality q = quality(n, image.now.t_ns);
    if (severity(q) > severity(worst)) worst = q;
  }
  image.sources[static_cast<std::size_t>(index)] = {worst, newest, health_[station].errors};
}

}  // namespace servogate::mock
