// SPDX-License-Identifier: Apache-2.0
// Once everything is attached, neither the segment nor a drive takes memory, whatever happens.
#include <gtest/gtest.h>

#include "tests/counting/allocations.hpp"
#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

TEST(DriveMemory, nothing_is_allocated_by_cycles_faults_or_sdo_traffic) {
  DriveBench b;
  b.start_cyclic_position();
  for (const int word : {0x06, 0x07, 0x0F})
    for (int i = 0; i < 5; ++i) b.cycle(static_cast<std::uint16_t>(word), 0);
  CanFrame sync, pdo, sdo, got;
  sync.id = 0x080;
  pdo.id = 0x205;
  pdo.length = 6;
  pdo.data = {0x0F};
  sdo.id = 0x605;
  sdo.length = 8;
  sdo.data = {0x40, 0x08, 0x10};
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 2000; ++i) {
    b.master.send(sync);
    b.master.send(pdo);
    if (i % 10 == 0) b.master.send(sdo);
    if (i == 500) b.segment.inject({.kind = fault::Kind::corrupt, .count = 5});
    if (i == 1000) b.drive.inject({.kind = fault::Kind::pdo_late, .delay_ns = 700'000});
    if (i == 1500) b.drive.inject({.kind = fault::Kind::over_current});
    b.segment.advance_to(b.now += image::kMillisecond);
    while (b.master.receive(got)) {
    }
  }
  EXPECT_EQ(counting::allocations(), before);
  EXPECT_EQ(b.drive.state(), image::DriveState::fault);
  ::operator delete(::operator new(8));
  EXPECT_EQ(counting::allocations(), before + 1) << "the counter itself works";
}

}  // namespace
}  // namespace servogate::mock
