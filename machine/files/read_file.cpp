// SPDX-License-Identifier: Apache-2.0
#include "machine/files/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <string_view>

#include "firmware_if/text/system_words.hpp"

namespace servogate::files {

const text::Entry kCannotRead{"cli.cannot-read", "cannot read the file: {0}", "файл не читается: {0}"};

namespace {

constexpr struct {
  mode_t kind;
  std::string_view english, russian;
} kKinds[] = {{S_IFDIR, "a folder", "каталог"},
              {S_IFIFO, "a pipe", "канал"},
              {S_IFCHR, "a device", "устройство"},
              {S_IFBLK, "a device", "устройство"},
              {S_IFSOCK, "a socket", "сокет"}};

std::string not_regular(mode_t mode) {
  std::string english = "not a regular file", russian = "не обычный файл";
  for (const auto& row : kKinds)
    if ((mode & S_IFMT) == row.kind) {
      english += " but " + std::string(row.english);
      russian += ", а " + std::string(row.russian);
    }
  return text::both(english, russian);
}

std::string size_words(std::int64_t bytes) { return text::number(static_cast<double>(bytes) / (1 << 20), 1); }

/// An open file that closes itself; why it is not open otherwise.
class Opened {
 public:
  explicit Opened(const std::string& path) {
    // Without O_NONBLOCK a pipe that nobody writes to would be waited for here.
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    struct stat seen {};
    if (fd_ < 0 || ::fstat(fd_, &seen) != 0)
      problem_ = text::words_of(errno);
    else if (!S_ISREG(seen.st_mode))
      problem_ = not_regular(seen.st_mode);
    size_ = seen.st_size;
  }
  ~Opened() {
    if (fd_ >= 0) ::close(fd_);
  }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  int fd() const { return fd_; }
  std::int64_t size() const { return size_; }
  const std::string& problem() const { return problem_; }

 private:
  int fd_ = -1;
  std::int64_t size_ = 0;
  std::string problem_;
};

}  // namespace

std::string too_large(std::int64_t most) {
  return text::both("larger than " + size_words(most) + " MiB", "больше " + size_words(most) + " МиБ");
}

std::optional<std::string> read_file(const std::string& path, std::int64_t most, std::string& error) {
  const Opened file(path);
  error = file.problem();
  if (error.empty() && file.size() > most) error = too_large(most);
  if (!error.empty()) return std::nullopt;
  // The size is a hint only: files of /proc have none, others grow while they are read.
  std::string content(static_cast<std::size_t>(std::min(file.size(), most)) + 1, '\0');
  std::size_t filled = 0;
  for (;;) {
    const ssize_t got = ::read(file.fd(), content.data() + filled, content.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      error = text::words_of(errno);
      return std::nullopt;
    }
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
    if (filled > static_cast<std::size_t>(most)) {
      error = too_large(most);
      return std::nullopt;
    }
    if (filled == content.size())
      content.resize(std::min<std::size_t>(content.size() * 2 + 4096, static_cast<std::size_t>(most) + 1));
  }
  content.resize(filled);
  return content;
}

std::string why_unreadable(const std::string& path) { return Opened(path).problem(); }

}  // namespace servogate::files
