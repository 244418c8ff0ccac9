// SPDX-License-Identifier: Apache-2.0
// An axis that is homed on a switch at a line of the kernel's simulated chip, in the computer's time: by the
// time of the edge, and by the level that the next cycle reads. How repeatable both are is printed, not
// judged.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <iostream>
#include <map>
#include <thread>

#include "drivers/clock.hpp"
#include "tests/axis/rig.hpp"
#include "tests/gpio/simulated_chip.hpp"

namespace servogate::gpio {
namespace {

using image::Nanoseconds;

constexpr unsigned kHomeLine = 23;
constexpr Nanoseconds kPeriod = 4 * image::kMillisecond;
constexpr std::int64_t kSwitchAt = 12'345;  ///< counts; on it below, off it above

/// A contact that opens at a given time of the computer's clock.
class Contact {
 public:
  explicit Contact(const std::string& sysfs) : wire_(sysfs, kHomeLine), thread_([this] { work(); }) {}
  ~Contact() {
    stop_ = true;
    thread_.join();
  }
  Contact(const Contact&) = delete;
  Contact& operator=(const Contact&) = delete;
  void close() { wire_.pull(true); }
  void open_at(Nanoseconds t) { due_ = t; }

 private:
  void work() {
    while (!stop_) {
      const Nanoseconds due = due_;
      if (due == 0 || drivers::clock_ns(CLOCK_MONOTONIC) < due) {
        if (due == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
        continue;
      }
      wire_.pull(false);
      due_ = 0;
    }
  }
  Wire wire_;
  std::atomic<Nanoseconds> due_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// The axis and its drive with a cycle of 4 ms. What is commanded in cycle k is where the axis stands when
/// cycle k + 1 opens; the switch opens on the straight way between.
class HomedByTheKernel : public ChipOfTheKernel {
 protected:
  struct Result {
    std::int64_t captured = 0;
    std::int64_t at_edge = 0;  ///< where the axis was at the time of the kernel
    bool edge = false;
    bool missed = false;  ///< homed by the level, since no edge came in time
  };
  Result home(bool edges, double from_mm) {
    axis::AxisConfig config = axis::test::mill_axis();
    config.homing.method = axis::HomingMethod::switch_only;
    config.homing.edges = edges;
    config.homing.slow = 30.0;
    config.in_position_window = 1.0;
    axis::Axis axis;
    axis.configure(config, 0);
    axis::test::FakeDrive drive;
    drive.start_at(std::llround(from_mm * 1e3));
    for (const char* permits : {"enable", "feed_enable"})
      for (const auto& f : image::kAxisFields)
        if (f.name == permits)
          image_->packets.set_bit(
              {image::Packet::k, image::Format::bl, (image::axis_base(0) + f.byte) * 8 + f.bit, 1}, true);
    image_->packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
    image_->packets.set_bit(axis::test::kPlusSwitch.place, true);
    image_->packets.set_bit(axis::test::kMinusSwitch.place, true);
    image_->now.period_ns = kPeriod;

    Contact contact(sysfs_);
    contact.close();
    Line line{"home", kHomeLine, rule("SA2", true)};
    line.edges = edges;
    const auto chip = open({line});
    if (chip == nullptr) {
      ADD_FAILURE() << why_.str();
      return {};
    }
    Result result;
    std::map<Nanoseconds, std::int64_t> places;  ///< counts at the begin of cycles
    const Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC) + kPeriod;
    axis.request_power(true);
    bool asked = false, opened = false;
    std::int64_t last = drive.counts;
    Nanoseconds edge_ns = -1;
    for (int k = 0; k < 60'000; ++k) {
      const Nanoseconds t = k * kPeriod;
      const timespec until{(start + t) / image::kSecond, (start + t) % image::kSecond};
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
      image_->now = {k, t, kPeriod};
      image_->edges.clear();
      chip->open_cycle(*image_);
      drive.cycle(image_->axes[0].drive_command, image_->axes[0].drive);
      chip->receive(*image_, notices_);
      for (const image::Edge& e : image_->edges.list()) edge_ns = e.t_ns;
      axis.read(*image_);
      axis.react(image::Reaction::none);
      if (!asked && axis.motion_permitted()) asked = axis.home();
      axis.command(*image_);
      // A computer that stands still for long misses the edge: then it says so.
      for (const axis::Event& e : axis.events()) {
        EXPECT_EQ(e.number, axis::alarm::kHomingNoEdge);
        result.missed = true;
      }
      const std::int64_t next = image_->axes[0].drive_command.position_counts;
      places[t + kPeriod] = next;
      if (!opened && last <= kSwitchAt && next > kSwitchAt) {
        opened = true;
        contact.open_at(start + t +
                        static_cast<Nanoseconds>(static_cast<double>(kSwitchAt - last) /
                                                 static_cast<double>(next - last) * kPeriod));
      }
      last = next;
      if (asked && !axis.homing().active()) break;
    }
    EXPECT_TRUE(axis.homed());
    result.captured = axis.reference_counts();
    result.edge = edge_ns >= 0;
    const auto behind = places.upper_bound(edge_ns);
    if (!result.edge || behind == places.end() || behind == places.begin()) return result;
    const auto before = std::prev(behind);
    result.at_edge = before->second + std::llround(static_cast<double>(edge_ns - before->first) /
                                                   static_cast<double>(kPeriod) *
                                                   static_cast<double>(behind->second - before->second));
    return result;
  }
};

/// Of what a homing has captured, in words.
std::string spread(const std::vector<std::int64_t>& captured) {
  const auto [low, high] = std::minmax_element(captured.begin(), captured.end());
  double mean = 0.0, square = 0.0;
  for (const std::int64_t c : captured) mean += static_cast<double>(c) / static_cast<double>(captured.size());
  for (const std::int64_t c : captured)
    square += (static_cast<double>(c) - mean) * (static_cast<double>(c) - mean);
  return std::to_string(*low) + " to " + std::to_string(*high) + " um, standard deviation " +
         std::to_string(std::sqrt(square / static_cast<double>(captured.size() - 1))) + " um";
}

TEST_F(HomedByTheKernel, captures_where_it_was_at_the_time_of_the_edge) {
  std::vector<std::int64_t> captured[2];
  for (int n = 0; n < 8; ++n)
    for (const bool edges : {false, true}) {
      const Result r = home(edges, 10.0 + 0.0373 * n);
      EXPECT_EQ(r.edge, edges);
      if (edges && !r.missed) {
        EXPECT_NEAR(static_cast<double>(r.captured), static_cast<double>(r.at_edge), 1.5);
      }
      captured[edges].push_back(r.captured);
    }
  std::cout << "homed at 30 mm/s with a cycle of 4 ms, the switch at " << kSwitchAt
            << " um\n  by the level: " << spread(captured[0]) << "\n  by the edge:  " << spread(captured[1])
            << "\n";
}

}  // namespace
}  // namespace servogate::gpio
