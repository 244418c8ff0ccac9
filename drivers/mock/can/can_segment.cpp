// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/can/can_segment.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <stdexcept>

#include "drivers/mock/can/can_endpoint.hpp"
#include "drivers/mock/can/foreign_sender.hpp"

namespace servogate::mock {
namespace {

constexpr std::size_t kMaxFaults = 16;
constexpr std::size_t kMaxEndpoints = 64;
// Flag of six bits, the others' flags superposed with it, delimiter of eight. Source: ISO 11898-1, 10.4.4.
constexpr std::uint32_t kErrorFrameBits = 6 + 6 + 8;
constexpr std::uint32_t kBitsAfterAcknowledge = 8;

std::uint64_t whole_nanoseconds_of_a_bit(std::uint32_t bit_rate) {
  if (bit_rate == 0) throw std::invalid_argument("a CAN segment needs a bit rate above zero");
  return image::kSecond % bit_rate == 0 ? image::kSecond / bit_rate : 0;
}

}  // namespace

CanSegment::CanSegment(CanSegmentConfig config)
    : config_(config), bit_ns_(whole_nanoseconds_of_a_bit(config.bit_rate)) {
  faults_.reserve(kMaxFaults);
}
CanSegment::~CanSegment() = default;

image::CanBus& CanSegment::add_endpoint(std::string name) {
  if (endpoints_.size() == kMaxEndpoints)
    throw std::length_error("a mock CAN segment has 64 endpoints at most");
  const int number = static_cast<int>(endpoints_.size());
  return *endpoints_.emplace_back(std::make_unique<Endpoint>(*this, number, std::move(name), nullptr));
}

int CanSegment::attach(CanNode& node, std::string name) {
  if (endpoints_.size() == kMaxEndpoints)
    throw std::length_error("a mock CAN segment has 64 endpoints at most");
  const int number = static_cast<int>(endpoints_.size());
  Endpoint& e = *endpoints_.emplace_back(std::make_unique<Endpoint>(*this, number, std::move(name), &node));
  node.connect(e, now_);
  e.plan(now_);
  return number;
}

int CanSegment::number_of(const image::CanBus& endpoint) const noexcept {
  for (std::size_t i = 0; i < endpoints_.size(); ++i)
    if (endpoints_[i].get() == &endpoint) return static_cast<int>(i);
  return -1;
}

void CanSegment::advance_to(Nanoseconds t) {
  if (t < now_) return;
  for (;;) {
    Nanoseconds wire = busy_ ? attempt_.end : earliest_start();
    // Whoever sends at t itself still takes part in the arbitration at t.
    if (!busy_ && wire >= t) wire = kNever;
    const Nanoseconds node = earliest_node();
    const Nanoseconds next = std::min(wire, node);
    if (next > t) break;
    now_ = std::max(now_, next);
    if (busy_ && attempt_.end <= now_) {
      finish_attempt();
    } else if (node <= now_) {
      run_due_nodes();
    } else {
      start_frame();
    }
  }
  now_ = t;
  for (auto& e : endpoints_) {
    if (!e->node()) continue;
    e->node()->advance_to(t);
    e->plan(t);
  }
}

Nanoseconds CanSegment::next_event_ns() const noexcept {
  return std::min(busy_ ? attempt_.end : earliest_start(), earliest_node());
}

CanSegment::Endpoint& CanSegment::endpoint_of(std::uint64_t set) const noexcept {
  return *endpoints_[static_cast<std::size_t>(std::countr_zero(set))];
}

Nanoseconds CanSegment::earliest_start() const noexcept {
  const Nanoseconds free = std::max(bus_free_, now_);
  Nanoseconds earliest = kNever;
  for (std::uint64_t rest = waiting_; rest != 0 && earliest > free; rest &= rest - 1)
    earliest = std::min(earliest, endpoint_of(rest).ready_at());
  return std::max(earliest, free);
}

Nanoseconds CanSegment::earliest_node() const noexcept {
  if (!node_due_known_) {
    node_due_ = kNever;
    for (const auto& e : endpoints_) node_due_ = std::min(node_due_, e->due());
    node_due_known_ = true;
  }
  return node_due_;
}

void CanSegment::run_due_nodes() noexcept {
  for (auto& e : endpoints_) {
    if (e->due() > now_) continue;
    e->node()->advance_to(now_);
    e->plan(now_);
  }
}

void CanSegment::start_frame() noexcept {
  const Endpoint::Pending* best = nullptr;
  attempt_.sender = -1;
  for (std::uint64_t rest = waiting_; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    const Endpoint::Pending* const offered = endpoint_of(rest).offer();
    if (offered == nullptr || (best != nullptr && offered->key > best->key)) continue;
    const std::uint64_t bit = std::uint64_t{1} << i;
    if (best != nullptr && offered->key == best->key) {
      // Two senders of one identifier: equal bits pass as one frame, different ones are a bit error.
      attempt_.error |= !offered->same(*best);
      attempt_.senders |= bit;
    } else {
      best = offered;
      attempt_.sender = i;
      attempt_.senders = bit;
      attempt_.error = false;
    }
  }
  if (best == nullptr) return;
  best->fill(attempt_.frame);
  attempt_.key = best->key;
  attempt_.bits = best->bits;
  attempt_.drop = attempt_.duplicate = false;
  if (const fault::Fault* fault =
          faults_.empty() ? nullptr : fault_for(attempt_.frame, attempt_.sender, false)) {
    attempt_.error |= fault->kind == fault::Kind::corrupt;
    attempt_.drop = fault->kind == fault::Kind::drop;
    attempt_.duplicate = fault->kind == fault::Kind::repeat;
  }
  attempt_.unacknowledged = !attempt_.error && !acknowledged(attempt_.senders);
  if (attempt_.error) attempt_.bits = attempt_.bits * 3 / 4 + kErrorFrameBits;
  if (attempt_.unacknowledged) attempt_.bits += kErrorFrameBits - kBitsAfterAcknowledge;
  attempt_.start = now_;
  attempt_.end = now_ + bit_time(attempt_.bits);
  busy_ = true;
}

void CanSegment::finish_attempt() noexcept {
  busy_ = false;
  bus_free_ = attempt_.end + bit_time(image::kIntermissionBits);
  account(attempt_.bits + image::kIntermissionBits);
  const bool failed = attempt_.error || attempt_.unacknowledged;
  if (monitor_) {
    monitor_->on_wire(attempt_.frame, attempt_.sender, attempt_.start, attempt_.end,
                      failed          ? CanMonitor::Outcome::error
                      : attempt_.drop ? CanMonitor::Outcome::dropped
                                      : CanMonitor::Outcome::received);
  }
  if (failed) return finish_error();
  ++statistics_.frames;
  for (std::uint64_t rest = attempt_.senders; rest != 0; rest &= rest - 1) {
    endpoint_of(rest).drop_pending(attempt_.key, attempt_.frame);
    endpoint_of(rest).sent();
  }
  if (attempt_.drop) return;
  attempt_.frame.timestamp_ns = attempt_.end;
  for (int n = attempt_.duplicate ? 2 : 1; n > 0; --n) deliver(attempt_.frame, attempt_.senders);
}

void CanSegment::finish_error() noexcept {
  ++statistics_.errors;
  for (std::size_t i = 0; i < endpoints_.size(); ++i) {
    Endpoint& e = *endpoints_[i];
    if (attempt_.senders >> i & 1) {
      // An error-passive sender that nobody acknowledges counts no further. Source: ISO 11898-1, 12.1.4.2.
      e.transmit_error(!attempt_.unacknowledged || e.state() != image::CanState::error_passive);
    } else if (e.on_bus() && attempt_.error) {
      e.receive_error();
    }
  }
}

void CanSegment::deliver(const CanFrame& frame, std::uint64_t senders) noexcept {
  const bool filtered = !frame.extended && !frame.remote && frame.id < kFilterSize;
  for (std::size_t i = 0; i < endpoints_.size(); ++i) {
    Endpoint& e = *endpoints_[i];
    if (senders >> i & 1) continue;
    const bool accepted = !filtered || e.accepts(frame.id);
    // A frame that leaves nothing behind: most are for one node alone.
    if (!accepted && e.hears_well() && e.due() > now_) continue;
    if (!e.on_bus()) continue;
    e.received_well();
    if (e.node() == nullptr) {
      e.push(frame);
      continue;
    }
    if (accepted) e.node()->on_frame(frame);
    if (accepted || e.due() <= now_) e.plan(now_);
  }
}

void CanSegment::account(std::uint32_t bits) noexcept {
  statistics_.bits += bits;
  if (now_ - window_start_ >= image::kSecond) {
    const double seconds = static_cast<double>(now_ - window_start_) * 1e-9;
    last_load_ = static_cast<double>(window_bits_) / (config_.bit_rate * seconds);
    window_start_ = now_;
    window_bits_ = 0;
  }
  window_bits_ += bits;
}

double CanSegment::load() const noexcept {
  if (last_load_ >= 0.0 && now_ - window_start_ < 2 * image::kSecond) return last_load_;
  const double seconds = static_cast<double>(now_ - window_start_) * 1e-9;
  return seconds > 0.0 ? static_cast<double>(window_bits_) / (config_.bit_rate * seconds) : 0.0;
}

bool CanSegment::acknowledged(std::uint64_t senders) const noexcept {
  for (std::size_t i = 0; i < endpoints_.size(); ++i)
    if (!(senders >> i & 1) && endpoints_[i]->on_bus()) return true;
  return false;
}

const fault::Fault* CanSegment::fault_for(const CanFrame& frame, int sender, bool queued) noexcept {
  for (ActiveFault& a : faults_) {
    const fault::Fault& f = a.fault;
    if ((f.kind == fault::Kind::delay) != queued) continue;
    if ((frame.id & f.mask) != (f.id & f.mask) || (f.sender >= 0 && f.sender != sender)) continue;
    if (a.passed < f.skip) {
      ++a.passed;
    } else if (f.count == 0 || a.hit < f.count) {
      ++a.hit;
      return &f;
    }
  }
  return nullptr;
}

bool CanSegment::inject(const fault::Fault& fault) {
  if (fault.kind == fault::Kind::foreign) {
    if (foreign_ == nullptr) {
      foreign_ = std::make_unique<ForeignSender>();
      attach(*foreign_, "foreign");
    }
    return foreign_->begin(fault, now_) && replan(*foreign_);
  }
  constexpr fault::Kind kOfWire[] = {fault::Kind::drop, fault::Kind::delay, fault::Kind::corrupt,
                                     fault::Kind::repeat};
  if (std::find(std::begin(kOfWire), std::end(kOfWire), fault.kind) == std::end(kOfWire)) return false;
  if (faults_.size() == kMaxFaults) {
    const auto used_up = [](const ActiveFault& a) { return a.fault.count > 0 && a.hit >= a.fault.count; };
    std::erase_if(faults_, used_up);
    if (faults_.size() == kMaxFaults) return false;
  }
  faults_.push_back({fault, 0, 0});
  return true;
}

void CanSegment::clear_faults() noexcept {
  faults_.clear();
  if (foreign_ != nullptr) foreign_->end_all();
}
void CanSegment::clear(const fault::Fault& fault) noexcept {
  if (fault.kind == fault::Kind::foreign && foreign_ != nullptr) foreign_->end(fault);
  const auto same = std::find_if(faults_.begin(), faults_.end(),
                                 [&](const ActiveFault& active) { return active.fault == fault; });
  if (same != faults_.end()) faults_.erase(same);
}

bool CanSegment::replan(const CanNode& node) noexcept {
  for (auto& e : endpoints_)
    if (e->node() == &node) e->plan(now_);
  return true;
}

void CanSegment::force_bus_off(int endpoint) noexcept {
  if (endpoint >= 0 && endpoint < endpoints()) endpoints_[static_cast<std::size_t>(endpoint)]->go_bus_off();
}
void CanSegment::restart(int endpoint) noexcept {
  if (endpoint >= 0 && endpoint < endpoints()) endpoints_[static_cast<std::size_t>(endpoint)]->recover();
}
void CanSegment::set_connected(int endpoint, bool connected) noexcept {
  if (endpoint >= 0 && endpoint < endpoints())
    endpoints_[static_cast<std::size_t>(endpoint)]->set_connected(connected);
}

}  // namespace servogate::mock
