// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "kernel/program/geometry/frame.hpp"

namespace servogate::channel {

/// What a process' programs say in words: findings (an error that ends a run, warnings), messages (NC-110
/// DIS), names of files, and
/// which frame each block works in. The feeder writes it, whoever speaks to people reads it, on any thread;
/// never the cycle, whose image and alarms hold only the numbers. Numbers begin at 1 and rise through all
/// runs; the newest are kept.
class ProgramTexts {
 public:
  /// More than the event queue holds, so that what the cycle reaches is still there.
  static constexpr std::size_t kMessagesKept = 8192;
  static constexpr std::size_t kFindingsKept = 2048;
  static constexpr std::size_t kRunsKept = 8;       ///< of file names
  static constexpr std::size_t kFramesKept = 4096;  ///< blocks that change the frame, read ahead of motion

  std::int32_t add_finding(text::Finding finding);
  std::int32_t add_message(std::string words);
  /// Files that run `run` has met so far, main program first.
  void set_files(std::uint32_t run, const std::vector<std::string>& files);

  /// From block `executed` (as counted in Tag::command) of run `run` on this frame is in force; before
  /// anything of that block is published.
  void add_frame(std::uint32_t run, std::int64_t executed, const program::Frame& frame);

  std::optional<text::Finding> finding(std::int32_t number) const;
  std::optional<std::string> message(std::int32_t number) const;
  /// Empty: not known.
  std::string file(std::uint32_t run, std::int32_t index) const;
  /// In force in this block; nullopt: not known any more.
  std::optional<program::Frame> frame(std::uint32_t run, std::int64_t executed) const;

 private:
  struct Files {
    std::uint32_t run = 0;
    std::vector<std::string> names;
  };
  mutable std::mutex mutex_;
  std::deque<text::Finding> findings_;
  std::deque<std::string> messages_;
  std::int32_t findings_gone_ = 0, messages_gone_ = 0;  ///< how many are not kept any more
  std::deque<Files> files_;
  struct FrameFrom {
    std::uint32_t run = 0;
    std::int64_t executed = 0;
    program::Frame frame;
  };
  std::deque<FrameFrom> frames_;
};

}  // namespace servogate::channel
