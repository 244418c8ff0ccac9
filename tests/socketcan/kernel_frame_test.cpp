// SPDX-License-Identifier: Apache-2.0
#include "drivers/socketcan/kernel_frame.hpp"

#include <gtest/gtest.h>

namespace servogate::socketcan {
namespace {

TEST(KernelFrame, of_FD_keeps_its_flags_both_ways) {
  for (const std::uint8_t flags : {0, 1, 2, 3}) {
    image::CanFrame frame, back;
    frame.id = 0x123;
    frame.fd = true;
    frame.length = 12;
    frame.fd_flags = flags;
    canfd_frame kernel;
    ASSERT_EQ(to_kernel(frame, kernel), CANFD_MTU);
    EXPECT_EQ(kernel.flags, flags);
    kernel.flags |= CANFD_FDF;  // newer kernels mark every FD frame so
    ASSERT_TRUE(from_kernel(kernel, CANFD_MTU, back));
    EXPECT_TRUE(back.fd);
    EXPECT_EQ(back.fd_flags, flags);
    EXPECT_EQ(back.length, 12);
  }
}

TEST(KernelFrame, of_classic_CAN_has_no_flags) {
  image::CanFrame frame, back;
  frame.fd_flags = image::kBitRateSwitch;  // left from an FD frame that it was
  canfd_frame kernel;
  ASSERT_EQ(to_kernel(frame, kernel), CAN_MTU);
  EXPECT_EQ(kernel.flags, 0);
  kernel.flags = 0xFF;  // reserved in a classic frame
  ASSERT_TRUE(from_kernel(kernel, CAN_MTU, back));
  EXPECT_EQ(back.fd_flags, 0);
}

}  // namespace
}  // namespace servogate::socketcan
