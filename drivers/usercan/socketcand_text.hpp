// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware_if/image/can_bus.hpp"

/// The words of the socketcand protocol (rawmode): elements "< word word ... >" on a byte stream, everything
/// between them ignored. Source: socketcand, doc/protocol.md. Servogate adds `remote` (remote frames, which
/// socketcand leaves out) and the words of lockstep. All real-time safe.
namespace servogate::usercan {

/// No element is longer, an FD frame excepted, which nobody sends here.
inline constexpr std::size_t kMaxElement = 128;

/// The words of an element, one after the other; empty when none is left.
class Words {
 public:
  explicit Words(std::string_view text) noexcept : rest_(text) {}
  std::string_view next() noexcept;

 private:
  std::string_view rest_;
};

/// Finds the first element in the bytes that have come. `taken`: how many of them are done with, element
/// included. nullopt: none is complete yet.
std::optional<std::string_view> find_element(std::string_view bytes, std::size_t& taken) noexcept;

/// The words after "send" or "remote" from a participant: ID LEN B B ... An identifier of eight digits has 29
/// bits, and one of four to seven, which python-can writes without leading zeros; of up to three it has 11.
/// False: no frame.
bool read_send(Words words, bool remote, image::CanFrame& frame) noexcept;
/// The words after "frame" or "remote" from a server: ID SEC.USEC DATA. The time stamp is the server's.
bool read_frame(Words words, bool remote, image::CanFrame& frame) noexcept;
/// A whole number, decimal. nullopt: it is none.
std::optional<std::int64_t> read_number(std::string_view word) noexcept;

/// What gives a participant in lockstep time before its wish. A word behind the wish of `done`; none: any.
enum class LockstepWake : std::uint8_t {
  any,     ///< every instant that is granted to anybody
  frames,  ///< "frames": the end of a frame that it hears
  wish,    ///< "wish": nothing; frames that end meanwhile come with its grant
};
LockstepWake lockstep_wake(std::string_view word) noexcept;

/// Text of an element in a buffer of its own.
class Element {
 public:
  std::string_view view() const noexcept { return {text_.data(), size_}; }
  void add(std::string_view text) noexcept;
  void add_number(std::int64_t value, int digits = 0) noexcept;
  void add_hex(std::uint64_t value, int digits) noexcept;

 private:
  std::array<char, kMaxElement> text_;
  std::size_t size_ = 0;
};

/// What a participant sends: "< send 181 2 DE AD >".
Element send_element(const image::CanFrame& frame) noexcept;
/// What a server sends: " < frame 181 12.000345 DEAD >". The space in front is what python-can 4.1 needs: it
/// throws away one byte after the last complete element of each read.
Element frame_element(const image::CanFrame& frame, image::Nanoseconds time) noexcept;

}  // namespace servogate::usercan
