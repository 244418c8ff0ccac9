// SPDX-License-Identifier: Apache-2.0
// A record of what came into the cycles repeats several runs, whenever their reader was quick or slow.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

#include "tests/channel/rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::channel::test {
namespace {

using image::RequestKind;

constexpr const char* kFirst = R"(N10 M8
N20 G1 X30 Y10 F9000
N30 X35 Y40
N40 G2 X45 Y50 I45 J40
N50 SK10=1
N60 G1 X60
N70 X61 Y51
N80 X62 Y50
N90 X100 Y0
N100 M30
)";
constexpr const char* kSecond =
    "N10 & SYVAR3.BY=7\nN20 G1 X-50 Y20 F12000\nN30 X-55 Y25\nN40 X0 Y0\nN50 M30\n";

class Tap final : public cycle::InputTap {
 public:
  void take(const cycle::CycleInputs& inputs) noexcept override { cycles.push_back(inputs); }
  std::vector<cycle::CycleInputs> cycles;
};

class Source final : public cycle::InputSource {
 public:
  explicit Source(const std::vector<cycle::CycleInputs>& cycles) : cycles_(cycles) {}
  const cycle::CycleInputs& next() const { return cycles_[at_]; }
  bool give(cycle::CycleInputs& inputs) noexcept override {
    if (at_ == cycles_.size()) return false;
    inputs = cycles_[at_++];
    return true;
  }

 private:
  const std::vector<cycle::CycleInputs>& cycles_;
  std::size_t at_ = 0;
};

struct Recording {
  std::vector<cycle::CycleInputs> cycles;
  std::vector<std::array<double, kAxes>> path;
  std::size_t changed_in = 0;  ///< the cycle before which the second program was loaded
};

void go_back_and_forward(Rig& rig) {
  const auto stands = [&] { return !rig.status().retracing && !rig.moving(); };
  EXPECT_TRUE(rig.until([&] { return rig.x() < -20.0; }, 3.0));
  rig.ask(RequestKind::hold);
  EXPECT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::held && stands(); }, 3.0));
  EXPECT_EQ(rig.ask(RequestKind::retrace, 10.0), cycle::Refusal::none);
  EXPECT_TRUE(rig.until(stands, 3.0));
  EXPECT_GT(rig.status().retraced_mm, 9.9);
  EXPECT_EQ(rig.ask(RequestKind::reposition), cycle::Refusal::none);
  EXPECT_TRUE(rig.until(stands, 3.0));
  EXPECT_EQ(rig.ask(RequestKind::resume), cycle::Refusal::none);
}

/// Three starts: the first given up in motion, then another program, then that once more, led back along its
/// path and forward again. The reader reads at random moments, also between what the cycle looks at and what
/// it does.
Recording recorded(unsigned seed) {
  std::mt19937 random(seed);
  Rig rig(kFirst);
  Tap tap;
  rig.cycle->attach(&tap);
  const std::size_t before = rig.path.size();
  rig.read = [&] {
    for (unsigned n = random() % 4; n > 1; --n) rig.process->work();
  };
  rig.logic.during = [&] {
    for (unsigned n = random() % 4; n > 1; --n) rig.process->work();
  };
  rig.start();
  EXPECT_EQ(rig.started(), cycle::Refusal::none);
  rig.run(0.3 + 0.001 * static_cast<double>(random() % 900));
  rig.ask(RequestKind::stop);
  EXPECT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::idle && !rig.moving(); }, 3.0));
  while (rig.process->feeder().reads()) rig.process->work();
  const std::size_t changed_in = tap.cycles.size();
  rig.load(kSecond);
  EXPECT_TRUE(rig.until([&] { return rig.ask(RequestKind::start) == cycle::Refusal::none; }, 3.0));
  EXPECT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::ended; }, 20.0)) << rig.alarm_list();
  EXPECT_TRUE(rig.until([&] { return rig.ask(RequestKind::start) == cycle::Refusal::none; }, 3.0));
  go_back_and_forward(rig);
  EXPECT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::ended; }, 20.0)) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
  rig.cycle->attach(static_cast<cycle::InputTap*>(nullptr));
  rig.logic.during = nullptr;
  rig.path.erase(rig.path.begin(), rig.path.begin() + static_cast<std::ptrdiff_t>(before));
  return {std::move(tap.cycles), std::move(rig.path), changed_in};
}

std::vector<std::array<double, kAxes>> replayed(const Recording& run) {
  Rig rig(kFirst);
  Source source(run.cycles);
  rig.cycle->attach(&source);
  const std::size_t before = rig.path.size();
  rig.read = [&] {
    if (rig.path.size() - before == run.changed_in) {
      while (rig.process->feeder().reads()) rig.process->work();
      rig.load(kSecond);
    }
    const auto& wanted = source.next().visible;
    for (bool enough = false, more = true; !enough && more;) {
      more = rig.process->work();
      std::array<std::uint64_t, Process::kCrossingsEach> filled{};
      rig.process->published(filled);
      enough = std::equal(filled.begin(), filled.end(), wanted.begin(), std::greater_equal<>());
    }
  };
  for (std::size_t n = 0; n < run.cycles.size(); ++n) rig.run(0.001);
  rig.path.erase(rig.path.begin(), rig.path.begin() + static_cast<std::ptrdiff_t>(before));
  return std::move(rig.path);
}

TEST(Replay, of_several_starts_repeats_every_set_point) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  for (unsigned i = 0; i < 20; ++i) {
    const Recording run = recorded(seed + i);
    const auto path = replayed(run);
    ASSERT_EQ(path.size(), run.path.size());
    for (std::size_t n = 0; n < path.size(); ++n)
      ASSERT_EQ(path[n], run.path[n]) << "cycle " << n << " of " << path.size() << ", seed " << seed + i;
  }
}

/// As a replay does, which knows no time: it calls until nothing is left to do.
TEST(Replay, needs_no_call_of_the_reader_behind_its_word_that_nothing_is_left) {
  // One element of them is known to be several windows of the planner.
  std::string program = "N10 G27\n";
  for (int k = 0; k < 30; ++k) program += "G2 X40 Y0 I20 J0 F6000\nG2 X0 Y0 I20 J0\n";
  Rig rig(program + "M30\n");
  const auto filled = [&] {
    std::array<std::uint64_t, Process::kCrossingsEach> counts{};
    rig.process->published(counts);
    return counts;
  };
  int said = 0;
  rig.read = [&] {
    if (rig.process->work()) return;
    const auto before = filled();
    for (int n = 0; n < 20; ++n) rig.process->work();
    EXPECT_EQ(filled(), before);
    ++said;
  };
  rig.start();
  rig.run(6.0);
  EXPECT_EQ(rig.state(), image::ProcessState::running);
  EXPECT_GT(said, 100);
}

TEST(Counts, of_what_is_published_begin_at_zero_with_every_start) {
  Rig rig(kFirst);
  const auto filled = [&] {
    std::array<std::uint64_t, Process::kCrossingsEach> counts{};
    rig.process->published(counts);
    return counts;
  };
  rig.start();
  rig.run(0.5);
  const auto first = filled();
  EXPECT_GT(first[0], 3u);
  EXPECT_GT(first[1], 0u);
  rig.ask(RequestKind::stop);
  rig.run(1.0);
  rig.read = [] {};  // nobody reads
  rig.start();
  ASSERT_EQ(rig.started(), cycle::Refusal::none);
  rig.run(0.01);
  EXPECT_EQ(filled()[0], 0u);
  EXPECT_EQ(filled()[1], 0u);
  rig.read = nullptr;
  rig.run(0.001);
  EXPECT_GT(filled()[0], 0u);
  EXPECT_LE(filled()[0], first[0]);
  ASSERT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::ended; }, 20.0)) << rig.alarm_list();
}

}  // namespace
}  // namespace servogate::channel::test
