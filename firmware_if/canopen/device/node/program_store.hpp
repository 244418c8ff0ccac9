// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Rows 1F50h, 1F51h, 1F56h and 1F57h of a device with one program. Not real-time safe.
std::vector<ObjectSpec> program_objects(std::uint32_t identification);

/// Program memory of a device: stop, clear, write, start, with the flash status in between. The
/// identification of a program is the CRC-32 (IEEE 802.3) of its bytes. Source: CiA 302-3, "Program
/// download". real-time safe but for the constructor.
class ProgramStore {
 public:
  struct Times {
    image::Nanoseconds clear = 200 * image::kMillisecond;
    image::Nanoseconds write_per_kbyte = 10 * image::kMillisecond;
  };
  /// `dictionary` has program_objects(). The program that 1F56h names runs.
  ProgramStore(ObjectDictionary& dictionary, std::size_t capacity, const Times& times);

  bool running() const noexcept { return running_; }
  /// The next write of the flash ends with this error of 1F57h (0: none), for tests of masters.
  void spoil_next_write(std::uint8_t error) noexcept { spoil_ = error; }

  /// Whether 1F51h may take this value now.
  AbortCode check_control(std::int64_t value) const noexcept;
  /// 1F51h was written. True: the program starts, the device begins with its boot-up.
  bool control(std::int64_t value, image::Nanoseconds now) noexcept;
  /// Memory that a download of 1F50h may fill; empty: not now.
  std::span<std::uint8_t> room() noexcept;
  AbortCode check_download() const noexcept;
  /// 1F50h has come, in room().
  void written(std::size_t size, image::Nanoseconds now) noexcept;
  void tick(image::Nanoseconds now) noexcept;

 private:
  enum class Flash : std::uint8_t { valid, cleared, invalid };
  void work_until(image::Nanoseconds t) noexcept;

  ObjectDictionary& dictionary_;
  std::int64_t &control_, &identification_, &status_;
  Times times_;
  std::vector<std::uint8_t> memory_;
  Flash flash_ = Flash::valid;
  bool running_ = true, busy_ = false;
  std::uint8_t spoil_ = 0, error_after_ = 0;
  std::uint32_t next_identification_ = 0;
  image::Nanoseconds ready_at_ = 0;
};

/// CRC-32 as in IEEE 802.3. real-time safe, its time grows with the length.
std::uint32_t program_identification(std::span<const std::uint8_t> image) noexcept;

}  // namespace servogate::canopen
