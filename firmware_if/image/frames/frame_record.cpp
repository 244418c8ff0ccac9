// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/frames/frame_record.hpp"

#include <algorithm>

namespace servogate::image {

FrameDetail frame_detail(const CanFrame& frame) noexcept {
  FrameDetail d;
  d.id = frame.id;
  d.length = static_cast<std::uint8_t>(std::min<std::size_t>(frame.length, d.data.size()));
  d.remote = frame.remote ? 1 : 0;
  d.extended = frame.extended ? 1 : 0;
  std::copy_n(frame.data.begin(), d.length, d.data.begin());
  return d;
}

CanFrame frame_of(const FrameDetail& d) noexcept {
  CanFrame frame;
  frame.id = d.id;
  frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(d.length, d.data.size()));
  frame.remote = d.remote != 0;
  frame.extended = d.extended != 0;
  std::copy_n(d.data.begin(), frame.length, frame.data.begin());
  return frame;
}

}  // namespace servogate::image
