// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware_if/board/protocol/messages.hpp"

/// Messages to bytes and back. Freestanding and real-time safe.
namespace servogate::board {

/// Mark, kind, length of the whole, sequence: before each message.
inline constexpr std::size_t kHeaderBytes = 8;
inline constexpr std::uint8_t kMark = 0x53;
/// Of the longest message with its padding; a buffer of it is a multiple of every bulk packet.
inline constexpr std::size_t kMostBytes = 512;

struct Header {
  Kind kind = Kind::refused;
  std::uint32_t sequence = 0;  ///< an answer has that of its question
};
/// A message that came: its header and what follows it.
struct Message {
  Header header;
  std::span<const std::uint8_t> body;
};

/// Takes a message apart. False: the bytes are none, or their length is not the one they tell. A message
/// whose length would be a multiple of 64 has one byte of padding, so that it ends with a short packet.
bool parse(std::span<const std::uint8_t> bytes, Message& message) noexcept;

/// Put into `buffer`, which is kMostBytes long; how many bytes were used.
std::size_t put(Header header, std::span<std::uint8_t> buffer) noexcept;  ///< without a body
std::size_t put(Header header, const Description& body, std::span<std::uint8_t> buffer) noexcept;
std::size_t put(Header header, const Configuration& body, std::span<std::uint8_t> buffer) noexcept;
std::size_t put(Header header, const Configured& body, std::span<std::uint8_t> buffer) noexcept;
std::size_t put(Header header, const Command& body, std::span<std::uint8_t> buffer) noexcept;
std::size_t put(Header header, const Status& body, std::span<std::uint8_t> buffer) noexcept;
std::size_t put(Header header, const Injection& body, std::span<std::uint8_t> buffer) noexcept;
std::size_t put(Header header, const Refusal& body, std::span<std::uint8_t> buffer) noexcept;

/// The body of a message. False: it has another length, or a value that is none.
bool take(std::span<const std::uint8_t> body, Description& to) noexcept;
bool take(std::span<const std::uint8_t> body, Configuration& to) noexcept;
bool take(std::span<const std::uint8_t> body, Configured& to) noexcept;
bool take(std::span<const std::uint8_t> body, Command& to) noexcept;
bool take(std::span<const std::uint8_t> body, Status& to) noexcept;
bool take(std::span<const std::uint8_t> body, Injection& to) noexcept;
bool take(std::span<const std::uint8_t> body, Refusal& to) noexcept;

}  // namespace servogate::board
