// SPDX-License-Identifier: Apache-2.0
#include "drivers/socketcan/kernel_frame.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <cstring>

namespace servogate::socketcan {
namespace {

// Those that travel on the wire; the kernel's own CANFD_FDF only says that the frame is one.
constexpr std::uint8_t kFlags = image::kBitRateSwitch | image::kErrorStateIndicator;
static_assert(image::kBitRateSwitch == CANFD_BRS && image::kErrorStateIndicator == CANFD_ESI);

}  // namespace

std::size_t to_kernel(const image::CanFrame& frame, canfd_frame& out) noexcept {
  std::memset(&out, 0, sizeof out);
  out.can_id = frame.extended ? (frame.id & CAN_EFF_MASK) | CAN_EFF_FLAG : frame.id & CAN_SFF_MASK;
  const std::size_t most = frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN;
  out.len = static_cast<__u8>(std::min<std::size_t>(frame.length, most));
  if (frame.fd) out.flags = frame.fd_flags & kFlags;
  if (frame.remote && !frame.fd) {
    out.can_id |= CAN_RTR_FLAG;
  } else {
    std::copy_n(frame.data.begin(), out.len, out.data);
  }
  return frame.fd ? CANFD_MTU : CAN_MTU;
}

bool from_kernel(const canfd_frame& in, std::size_t size, image::CanFrame& frame) noexcept {
  if (size != CAN_MTU && size != CANFD_MTU) return false;
  frame.fd = size == CANFD_MTU;
  frame.error = (in.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && !frame.fd && (in.can_id & CAN_RTR_FLAG) != 0;
  frame.id = in.can_id & (frame.error      ? CAN_ERR_MASK
                          : frame.extended ? CAN_EFF_MASK
                                           : static_cast<__u32>(CAN_SFF_MASK));
  const std::size_t most = frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN;
  frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(in.len, most));
  frame.fd_flags = frame.fd ? in.flags & kFlags : std::uint8_t{0};
  frame.data = {};
  if (!frame.remote) std::copy_n(in.data, frame.length, frame.data.begin());
  return true;
}

image::CanState state_after(const image::CanFrame& error, image::CanState before) noexcept {
  using image::CanState;
  if (error.id & CAN_ERR_BUSOFF) return CanState::bus_off;
  if (error.id & CAN_ERR_RESTARTED) return CanState::error_active;
  if (!(error.id & CAN_ERR_CRTL)) return before;
  const unsigned detail = error.data[1];
  if (detail & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) return CanState::error_passive;
  if (detail & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) return CanState::error_warning;
  if (detail & CAN_ERR_CRTL_ACTIVE) return CanState::error_active;
  return before;
}

}  // namespace servogate::socketcan
