// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace servogate::files {

/// A regular file seen as memory, however large it is: only what is looked at is read. Not real-time safe.
class MappedFile {
 public:
  MappedFile() = default;
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Once. Empty: done; otherwise why not, in both languages (text::both), as read_file().
  std::string open(const std::string& path);
  std::string_view content() const noexcept { return {static_cast<const char*>(at_), size_}; }

 private:
  void* at_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace servogate::files
