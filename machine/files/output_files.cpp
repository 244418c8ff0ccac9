// SPDX-License-Identifier: Apache-2.0
#include "machine/files/output_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "firmware_if/text/system_words.hpp"

namespace servogate::files {

namespace {

namespace fs = std::filesystem;

const text::Entry kSame{"output.same", "{0} and {1} are one file, {2}: the second would overwrite the first",
                        "{0} и {1} указывают на один файл {2}: второй затёр бы первый"};
const text::Entry kInput{"output.is-input", "{0} would overwrite {1}, {2}", "{0} затёр бы {1}, {2}"};
const text::Entry kCannot{"output.cannot-write", "cannot write {0} {1}: {2}",
                          "{0}: не удаётся записать {1}: {2}"};

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

/// One file under two names, existing or not. Devices and pipes may be shared.
bool same_file(const std::string& a, const std::string& b) {
  struct stat sa {
  }, sb{};
  const bool has_a = stat(a.c_str(), &sa) == 0, has_b = stat(b.c_str(), &sb) == 0;
  if (has_a != has_b) return false;
  if (has_a) return S_ISREG(sa.st_mode) && sa.st_dev == sb.st_dev && sa.st_ino == sb.st_ino;
  std::error_code error_a, error_b;
  const fs::path whole_a = fs::weakly_canonical(fs::absolute(a, error_a), error_a),
                 whole_b = fs::weakly_canonical(fs::absolute(b, error_b), error_b);
  return !error_a && !error_b && whole_a == whole_b;
}

/// Why a file cannot be written, in both languages; empty: it can.
std::string why_unwritable(const std::string& path) {
  struct stat seen {};
  if (stat(path.c_str(), &seen) == 0) {
    if (S_ISDIR(seen.st_mode)) return text::words_of(EISDIR);
    return access(path.c_str(), W_OK) == 0 ? "" : text::words_of(errno);
  }
  if (errno != ENOENT) return text::words_of(errno);
  if (lstat(path.c_str(), &seen) == 0) return "";  // a link to a file that is still to come
  const std::string folder = folder_of(path);
  if (stat(folder.c_str(), &seen) != 0)
    return text::both("the folder '" + folder + "' does not exist", "каталога «" + folder + "» нет");
  // Permissions alone do not tell: the file system may be full of names, or read-only.
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) return text::words_of(errno);
  close(fd);
  unlink(path.c_str());
  return "";
}

}  // namespace

std::optional<OutputProblem> problem_of_outputs(const std::vector<NamedPath>& outputs,
                                                const std::vector<NamedPath>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const NamedPath& o = outputs[i];
    if (o.path.empty()) continue;
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].path.empty() && same_file(outputs[j].path, o.path))
        return OutputProblem{&kSame, {outputs[j].name, o.name, o.path}, true};
    for (const NamedPath& input : inputs)
      if (!input.path.empty() && same_file(input.path, o.path))
        return OutputProblem{&kInput, {o.name, input.name, o.path}, true};
  }
  for (const NamedPath& o : outputs)
    if (!o.path.empty())
      if (const std::string why = why_unwritable(o.path); !why.empty())
        return OutputProblem{&kCannot, {o.name, o.path, why}, false};
  return std::nullopt;
}

std::optional<OutputProblem> problem_of_folder(const std::string& path) {
  const auto problem = [&](int error) {
    return OutputProblem{&kCannot, {"--state", path, text::words_of(error)}, false};
  };
  std::error_code error;
  fs::path at = fs::absolute(path, error);
  while (!fs::exists(at, error) && at.has_parent_path() && at != at.parent_path()) at = at.parent_path();
  if (!fs::is_directory(at, error)) return problem(ENOTDIR);
  if (access(at.c_str(), W_OK | X_OK) != 0) return problem(errno);
  // Permissions alone do not tell, as above.
  const std::string probe = (at / (".servogate-" + std::to_string(getpid()))).string();
  if (mkdir(probe.c_str(), 0700) != 0) return problem(errno);
  rmdir(probe.c_str());
  return std::nullopt;
}

std::string nameless_file(const std::string& beside, std::string& error) {
  std::error_code ignored;
  int fd = open(folder_of(beside).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd < 0) fd = open(fs::temp_directory_path(ignored).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd < 0) {
    error = text::words_of(errno);
    return {};
  }
  return "/proc/self/fd/" + std::to_string(fd);
}

}  // namespace servogate::files
