// SPDX-License-Identifier: Apache-2.0
#include "gateway/machine/state/state_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "firmware_if/text/system_words.hpp"

namespace servogate::machine {

const text::Entry kStateTaken{"state.taken", "cannot use the state directory {0}: {1}",
                              "нельзя использовать каталог состояния {0}: {1}"};

namespace {

std::string owner(int file) {
  char number[32] = {};
  const ssize_t length = ::pread(file, number, sizeof number - 1, 0);
  std::string out(number, length > 0 ? static_cast<std::size_t>(length) : 0);
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out.empty() ? "?" : out;
}

}  // namespace

StateLock::~StateLock() {
  if (file_ >= 0) ::close(file_);
}

std::string StateLock::take(const std::string& directory) {
  std::error_code code;
  const bool made = std::filesystem::create_directories(directory, code);
  if (code) return directory + ": " + text::words_of(code.value());
  if (made) ::chmod(directory.c_str(), 0700);
  file_ = ::open((directory + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file_ < 0) return directory + "/lock: " + text::words_of(errno);
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0)
    return text::both(
        "another control has it, process " + owner(file_) +
            "; end that one (`servogate down`), or give this one a directory of its own (--state)",
        "каталогом владеет другое управление, процесс " + owner(file_) +
            "; завершите его (`servogate down`) или задайте этому другой каталог (--state)");
  const std::string number = std::to_string(::getpid()) + "\n";
  if (::ftruncate(file_, 0) != 0 ||
      ::pwrite(file_, number.data(), number.size(), 0) != static_cast<ssize_t>(number.size()))
    return directory + "/lock: " + text::words_of(errno);
  return {};
}

}  // namespace servogate::machine
