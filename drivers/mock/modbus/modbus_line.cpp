// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/modbus/modbus_line.hpp"

#include <algorithm>

#include "firmware_if/modbus/line_time.hpp"

namespace servogate::mock {

using image::Nanoseconds;
using modbus::LineTime;

namespace {

// A machine file is checked against these.
static_assert(LineSettings{}.stale_after_periods == modbus::kStaleAfterPeriods);
static_assert(StationSettings{}.answer_delay_ns == modbus::kAnswerDelay);

constexpr std::size_t kRtuOverhead = 3;  // station address and checksum

std::vector<modbus::Unit> units_of(const std::vector<StationSettings>& stations,
                                   const std::vector<int>& sources) {
  std::vector<modbus::Unit> units;
  for (std::size_t n = 0; n < stations.size(); ++n)
    units.push_back({stations[n].unit, n < sources.size() ? sources[n] : static_cast<int>(n)});
  return units;
}

}  // namespace

MockModbusLine::MockModbusLine(LineSettings line, const modbus::Map& map,
                               std::vector<StationSettings> stations, const std::vector<int>& sources)
    : line_(line),
      poller_(line.poll, map.blocks),
      exchange_(map, units_of(stations, sources), line.stale_after_periods) {
  for (StationSettings& s : stations) stations_.emplace_back(std::move(s));
}

std::size_t MockModbusLine::station_of(std::uint8_t unit) const noexcept {
  std::size_t n = 0;
  while (n + 1 < stations_.size() && stations_[n].settings().unit != unit) ++n;
  return n;
}

Nanoseconds MockModbusLine::characters_ns(std::size_t count) const noexcept {
  return LineTime(line_.baud).characters(count);
}

Nanoseconds MockModbusLine::silence_ns() const noexcept { return LineTime(line_.baud).silence(); }

Nanoseconds MockModbusLine::transaction_ns(const modbus::Block& b, Nanoseconds answer_delay) const noexcept {
  return line_.latency_ns + LineTime(line_.baud).transaction(b, answer_delay);
}

double MockModbusLine::planned_load() const noexcept {
  double load = 0.0;
  for (const modbus::Block& block : map().blocks) {
    const Nanoseconds delay = stations_[station_of(block.unit)].settings().answer_delay_ns;
    load += static_cast<double>(transaction_ns(block, delay)) / static_cast<double>(block.period_ns);
  }
  return load;
}

void MockModbusLine::advance_to(Nanoseconds t) {
  if (!started_) {
    started_ = true;
    idle_since_ns_ = t;
    tally_.opened();
    poller_.start_at(t);
  }
  for (;;) {
    if (!now_.active && !open(t)) break;
    if (!now_.served && now_.arrival_ns <= t) serve();
    if (!now_.served || now_.end_ns > t) break;
    close();
  }
  for (ModbusStation& s : stations_) s.advance_to(t);
}

/// The next transaction, if it begins by `t`.
bool MockModbusLine::open(Nanoseconds t) {
  const auto next = poller_.next(idle_since_ns_);
  if (!next || next->start_ns > t) return false;
  const modbus::Block& b = map().blocks[next->block];
  now_.active = true;
  now_.station = station_of(b.unit);
  now_.served = now_.answered = now_.damaged = false;
  now_.arrival_ns = next->start_ns + line_.latency_ns / 2 + LineTime(line_.baud).request(b);
  now_.end_ns = now_.arrival_ns;
  now_.request = poller_.begin(*next);
  tally_.asked(next->attempt > 0);
  return true;
}

void MockModbusLine::serve() {
  ModbusStation& station = stations_[now_.station];
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
  now_.answered = answered && delay <= line_.answer_timeout_ns;
  now_.damaged = station.fault() && station.fault()->kind == fault::Kind::corrupt;
  now_.served = true;
}

void MockModbusLine::close() {
  now_.active = false;
  idle_since_ns_ = now_.end_ns;
  modbus::Response response;
  const bool good = now_.answered && !now_.damaged &&
                    decode_response(now_.answer.view(), now_.request, response) == modbus::AnswerFault::none;
  const modbus::Heard heard = good            ? modbus::Heard::answer
                              : now_.answered ? modbus::Heard::malformed
                                              : modbus::Heard::silence;
  tally_.heard(heard, good && response.exception != modbus::Exception::none);
  exchange_.take(good ? poller_.answered(response, now_.end_ns) : poller_.unanswered(now_.end_ns));
}

void MockModbusLine::receive(image::ProcessImage& image, image::Notices&) noexcept {
  exchange_.receive(image);
}

void MockModbusLine::send(image::ProcessImage& image) noexcept { exchange_.send(image, poller_); }

}  // namespace servogate::mock
