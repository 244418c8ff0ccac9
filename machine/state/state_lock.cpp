// SPDX-License-Identifier: Apache-2.0
#include "machine/state/state_lock.hpp"

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

std::string make_state_directory(const std::string& directory) {
  std::error_code code;
  std::string path = directory;
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();  // which would follow a link
  struct stat seen {};
  if (::lstat(path.c_str(), &seen) != 0) {
    const bool made = std::filesystem::create_directories(path, code);
    if (code) return path + ": " + text::words_of(code.value());
    if (made && ::chmod(path.c_str(), 0700) != 0) return path + ": " + text::words_of(errno);
    if (::lstat(path.c_str(), &seen) != 0) return path + ": " + text::words_of(errno);
  }
  if (S_ISLNK(seen.st_mode))
    return text::both(path + " is a link: name the directory itself",
                      path + " — ссылка: укажите сам каталог");
  if (!S_ISDIR(seen.st_mode)) return path + ": " + text::words_of(ENOTDIR);
  if (seen.st_uid != ::geteuid())
    return text::both(path + " belongs to another user", path + " принадлежит другому пользователю");
  return {};
}

StateLock::~StateLock() {
  if (file_ >= 0) ::close(file_);
}

std::string StateLock::take(const std::string& directory) {
  if (std::string problem = make_state_directory(directory); !problem.empty()) return problem;
  file_ = ::open((directory + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
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
