// SPDX-License-Identifier: Apache-2.0
// The control, a process of its own, dies in a rapid of the hanging axis: killed, or stopped and woken later.
#include <chrono>
#include <csignal>
#include <fstream>
#include <optional>
#include <thread>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "tests/comes.hpp"
#include "tests/usercan/rig/mill.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {
namespace {

using namespace std::chrono_literals;

constexpr canopen::NodeId kZ = 3;
constexpr double kCountsPerMm = 26214.4;
constexpr double kReach = 295.0;  ///< mm; the program's way ends at 290, and the axis itself at 311

std::string up_and_down() {
  const std::string file = scratch("up_and_down.nc");
  std::ofstream nc(file);
  nc << "N1 G90 G94\n";
  for (int i = 0; i < 20; ++i) nc << "G0 Z290\nG0 Z-290\n";
  nc << "M30\n";
  return file;
}

/// Somebody else on the wire, who only reads.
class Reader {
 public:
  explicit Reader(std::unique_ptr<SocketcandBus> bus) : bus_(std::move(bus)) {}

  std::optional<std::int32_t> value(std::uint16_t index) {
    image::CanFrame frame;
    while (bus_->receive(frame)) {
    }
    bus_->send(make(canopen::cob::sdo_request(kZ), {0x40, static_cast<std::uint8_t>(index & 0xFF),
                                                    static_cast<std::uint8_t>(index >> 8), 0, 0, 0, 0, 0}));
    for (int i = 0; i < 1000 && wait_for(*bus_, frame); ++i)
      if (frame.id == canopen::cob::sdo_response(kZ) && (frame.data[1] | frame.data[2] << 8) == index)
        return static_cast<std::int32_t>(frame.data[4] | frame.data[5] << 8 | frame.data[6] << 16 |
                                         std::uint32_t{frame.data[7]} << 24);
    return std::nullopt;
  }
  /// Waits for a fast way down while the control lives; where it was seen.
  std::optional<std::int32_t> rapid_down(const Process& control) {
    std::optional<std::int32_t> before;
    const auto end = std::chrono::steady_clock::now() + tests::kPatience;
    for (image::CanFrame frame;
         std::chrono::steady_clock::now() < end && !control.ended() && wait_for(*bus_, frame);) {
      if (frame.id != canopen::cob::tpdo(1, kZ) || frame.length != 6) continue;
      const auto now = static_cast<std::int32_t>(frame.data[2] | frame.data[3] << 8 | frame.data[4] << 16 |
                                                 std::uint32_t{frame.data[5]} << 24);
      // 4 ms at 70 mm/s
      if (before && now - *before < -0.28 * kCountsPerMm && now - *before > -10.0 * kCountsPerMm) return now;
      before = now;
    }
    return std::nullopt;
  }
  bool in_fault() { return (value(0x6041).value_or(0) & 0x4F) == 0x08; }

 private:
  std::unique_ptr<SocketcandBus> bus_;
};

class ControlDeath : public ::testing::TestWithParam<int> {};

TEST_P(ControlDeath, in_a_rapid_downwards_lets_the_axis_not_fall_and_waking_does_not_move_it) {
  RunningServer server;
  const std::string machine = mill("socketcand:" + server.address().str() + "/can0", patience());
  auto living = mill_drives(machine);
  Reader reader(server.join());
  // At a fifth of the speed: a drive whose process comes 30 ms late does not jump farther than an axis can
  // (1007). Where the computer stalls for longer, control and drives begin anew.
  std::optional<Process> control;
  std::optional<std::int32_t> seen;
  for (int attempt = 0; attempt < 20 && !seen; ++attempt) {
    if (attempt > 0) {
      living.clear();
      living = mill_drives(machine);
    }
    control.emplace(std::vector<std::string>{"run", machine, up_and_down(), "--realtime=best-effort",
                                             "--override", "20", "-q"});
    seen = reader.rapid_down(*control);
  }
  ASSERT_TRUE(seen.has_value()) << control->said();
  const Process& run = *control;
  run.signal(GetParam());
  // Its heartbeat of 1 s is missed after three; then the ramp, the brake, and the torque goes.
  ASSERT_TRUE(tests::comes([&] { return reader.in_fault(); }, 100ms));
  const auto rests = reader.value(0x6064);
  ASSERT_TRUE(rests.has_value());
  std::this_thread::sleep_for(1s);  // true after any time
  EXPECT_EQ(reader.value(0x6064), rests) << "without torque it hangs on its brake";
  // However late the signal was: it never left the way of the program. What falls leaves it within a second.
  EXPECT_GT(*rests, -kReach * kCountsPerMm);
  if (GetParam() != SIGSTOP) return;
  run.signal(SIGCONT);
  std::this_thread::sleep_for(1s);  // true after any time
  EXPECT_EQ(reader.value(0x6064), rests) << "a fault wants its reset";
  EXPECT_TRUE(reader.in_fault());
}

INSTANTIATE_TEST_SUITE_P(Signals, ControlDeath, ::testing::Values(SIGKILL, SIGSTOP), [](const auto& signal) {
  return std::string(signal.param == SIGKILL ? "kill" : "stop");
});

}  // namespace
}  // namespace servogate::usercan
