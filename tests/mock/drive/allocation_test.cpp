// SPDX-License-Identifier: Apache-2.0
// Once everything is attached, neither the segment nor a drive takes memory, whatever happens.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/mock/drive/drive_bench.hpp"

namespace {
std::atomic<bool> g_watch{false};
std::atomic<int> g_allocations{0};
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  if (g_watch) ++g_allocations;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (g_watch) ++g_allocations;
  return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

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
  g_watch = true;
  for (int i = 0; i < 2000; ++i) {
    b.master.send(sync);
    b.master.send(pdo);
    if (i % 10 == 0) b.master.send(sdo);
    if (i == 500) b.segment.inject({.kind = CanFault::Kind::corrupt, .count = 5});
    if (i == 1000) b.drive.inject({.kind = DriveFaultKind::pdo_late, .delay_ns = 700'000});
    if (i == 1500) b.drive.inject({.kind = DriveFaultKind::over_current});
    b.segment.advance_to(b.now += image::kMillisecond);
    while (b.master.receive(got)) {
    }
  }
  g_watch = false;
  EXPECT_EQ(g_allocations, 0);
  EXPECT_EQ(b.drive.state(), image::DriveState::fault);
  g_watch = true;
  ::operator delete(::operator new(8));
  g_watch = false;
  EXPECT_EQ(g_allocations, 1) << "the counter itself works";
}

}  // namespace
}  // namespace servogate::mock
