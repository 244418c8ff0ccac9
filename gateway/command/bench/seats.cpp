// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/seats.hpp"

#include <algorithm>

namespace servogate::gateway::command {

class DriveSeats::Seat final : public bench::BenchDrive {
 public:
  Seat(DriveSeats& all, std::size_t axis) : all_(all), axis_(axis) {}
  double period_s() const noexcept override { return all_.drives_.period_s(); }
  bool cycle(const bench::DriveAsk& ask, bench::DriveAnswer& answer) override {
    return all_.cycle(axis_, ask, answer);
  }
  bool ended() const override { return all_.ended(); }

 private:
  DriveSeats& all_;
  std::size_t axis_;
};

DriveSeats::DriveSeats(BusDrive& drives)
    : drives_(drives),
      asks_(drives.count()),
      answers_(drives.count()),
      present_(drives.count()),
      ready_(drives.count(), false) {
  for (std::size_t k = 0; k < drives.count(); ++k) seats_.push_back(std::make_unique<Seat>(*this, k));
}

void DriveSeats::exchange_when_all_asked() {
  if (present_ == 0 || asked_ < present_) return;
  gone_ = gone_ || !drives_.cycle_all(asks_, answers_);
  ended_ = ended_ || drives_.ended();
  all_ready_ = std::find(ready_.begin(), ready_.end(), false) == ready_.end();
  asked_ = 0;
  ++round_;
  next_.notify_all();
}

bool DriveSeats::cycle(std::size_t axis, const bench::DriveAsk& ask, bench::DriveAnswer& answer) {
  std::unique_lock lock(lock_);
  asks_[axis] = ask;
  ++asked_;
  const std::uint64_t mine = round_;
  exchange_when_all_asked();
  next_.wait(lock, [&] { return round_ != mine; });
  answer = answers_[axis];
  return !gone_;
}

bool DriveSeats::may_begin(std::size_t axis) {
  const std::lock_guard lock(lock_);
  ready_[axis] = true;
  return all_ready_;
}

bool DriveSeats::ended() {
  const std::lock_guard lock(lock_);
  return ended_;
}

void DriveSeats::end_all() {
  const std::lock_guard lock(lock_);
  ended_ = true;
}

void DriveSeats::leave(std::size_t axis) {
  const std::lock_guard lock(lock_);
  asks_[axis].power = false;
  --present_;
  exchange_when_all_asked();
}

}  // namespace servogate::gateway::command
