// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace servogate::files {

/// A text, or a copy of a regular file, that nobody else can change, on disk under no name, and seen as
/// memory: only what is looked at takes memory. Not real-time safe.
class SpooledFile {
 public:
  SpooledFile() = default;
  ~SpooledFile();
  SpooledFile(const SpooledFile&) = delete;
  SpooledFile& operator=(const SpooledFile&) = delete;

  /// Once. Empty: done; otherwise why not, in both languages (text::both), as read_file().
  std::string open(const std::string& path, std::int64_t most);
  /// The same with the pieces that `next` gives, up to the first empty one.
  std::string hold(const std::function<std::string()>& next, std::int64_t most);
  std::string_view content() const noexcept { return {static_cast<const char*>(at_), size_}; }
  /// These bytes are not looked at for a while: their memory is free until they are.
  void leave(std::size_t from, std::size_t to) const noexcept;

 private:
  std::string take(const std::function<std::string_view()>& next, std::int64_t most);
  void* at_ = nullptr;
  std::size_t size_ = 0;
};

/// Bytes of a file, -1 where it cannot be said.
std::int64_t size_of(const std::string& path);

}  // namespace servogate::files
