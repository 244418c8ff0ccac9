// SPDX-License-Identifier: Apache-2.0
#include "machine/files/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "firmware_if/text/system_words.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::files {

MappedFile::~MappedFile() {
  if (at_ != nullptr) ::munmap(at_, size_);
}

std::string MappedFile::open(const std::string& path) {
  if (std::string problem = why_unreadable(path); !problem.empty()) return problem;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0) return text::words_of(errno);
  struct stat seen {};
  std::string problem;
  void* at = MAP_FAILED;
  if (::fstat(fd, &seen) != 0)
    problem = text::words_of(errno);
  else if (seen.st_size > 0)
    at = ::mmap(nullptr, static_cast<std::size_t>(seen.st_size), PROT_READ, MAP_PRIVATE, fd, 0);
  if (problem.empty() && seen.st_size > 0 && at == MAP_FAILED) problem = text::words_of(errno);
  ::close(fd);
  if (at == MAP_FAILED) return problem;
  at_ = at;
  size_ = static_cast<std::size_t>(seen.st_size);
  return {};
}

}  // namespace servogate::files
