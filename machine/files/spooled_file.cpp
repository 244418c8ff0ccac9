// SPDX-License-Identifier: Apache-2.0
#include "machine/files/spooled_file.hpp"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <vector>

#include "firmware_if/text/system_words.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::files {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

SpooledFile::~SpooledFile() {
  if (at_ != nullptr) ::munmap(at_, size_);
}

std::string SpooledFile::open(const std::string& path, std::int64_t most) {
  if (std::string problem = why_unreadable(path); !problem.empty()) return problem;
  const File from(std::fopen(path.c_str(), "rb"));
  if (from == nullptr) return text::words_of(errno);
  std::vector<char> piece(kPiece);
  const std::string problem = take(
      [&] { return std::string_view(piece.data(), std::fread(piece.data(), 1, piece.size(), from.get())); },
      most);
  return problem.empty() && std::ferror(from.get()) != 0 ? text::words_of(errno) : problem;
}

std::string SpooledFile::hold(const std::function<std::string()>& next, std::int64_t most) {
  std::string piece;
  return take([&] { return std::string_view(piece = next()); }, most);
}

std::string SpooledFile::take(const std::function<std::string_view()>& next, std::int64_t most) {
  const File copy(std::tmpfile());
  if (copy == nullptr) return text::words_of(errno);
  std::int64_t size = 0;
  for (std::string_view piece = next(); !piece.empty(); piece = next()) {
    size += static_cast<std::int64_t>(piece.size());
    if (size > most) return too_large(most);
    if (std::fwrite(piece.data(), 1, piece.size(), copy.get()) != piece.size()) return text::words_of(errno);
  }
  if (std::fflush(copy.get()) != 0) return text::words_of(errno);
  if (size == 0) return {};
  void* const at =
      ::mmap(nullptr, static_cast<std::size_t>(size), PROT_READ, MAP_SHARED, ::fileno(copy.get()), 0);
  if (at == MAP_FAILED) return text::words_of(errno);
  at_ = at;
  size_ = static_cast<std::size_t>(size);
  return {};
}

void SpooledFile::leave(std::size_t from, std::size_t to) const noexcept {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  from -= from % page;
  to = std::min(to, size_);
  to -= to == size_ ? 0 : to % page;
  if (from < to) ::madvise(static_cast<char*>(at_) + from, to - from, MADV_DONTNEED);
}

std::int64_t size_of(const std::string& path) {
  struct stat seen {};
  return ::stat(path.c_str(), &seen) == 0 ? static_cast<std::int64_t>(seen.st_size) : -1;
}

}  // namespace servogate::files
