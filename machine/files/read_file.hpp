// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "firmware_if/text/finding.hpp"

namespace servogate::files {

/// What is said of it: {0} why, as read_file() gives it.
extern const text::Entry kCannotRead;

/// Most bytes that are read of a file, by what it is; more is taken for a mistake of its name.
inline constexpr std::int64_t kMostOfSettings = std::int64_t{4} << 20;   ///< machine, device and state files
inline constexpr std::int64_t kMostOfSource = std::int64_t{16} << 20;    ///< Structured Text
inline constexpr std::int64_t kMostOfProgram = std::int64_t{256} << 20;  ///< part programs

/// Why a file is not read that has more than `most` bytes, in both languages.
std::string too_large(std::int64_t most);

/// The whole content of a regular file of at most `most` bytes. nullopt: `error` says why in both languages
/// (text::both): missing, not permitted, a folder, a pipe or a device, too large. Never waits for a pipe's
/// other end. Not real-time safe.
std::optional<std::string> read_file(const std::string& path, std::int64_t most, std::string& error);

/// Why a file cannot be read piece by piece, whatever its size, in both languages; empty: it can be, and is a
/// regular one. Not real-time safe.
std::string why_unreadable(const std::string& path);

}  // namespace servogate::files
