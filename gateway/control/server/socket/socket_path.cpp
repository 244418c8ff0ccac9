// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/socket/socket_path.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>

#include "firmware_if/text/system_words.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway {

namespace fs = std::filesystem;

std::string socket_folder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return std::string(runtime) + "/servogate";
  return "/tmp/servogate-" + std::to_string(getuid());
}

bool own_socket_folder() {
  struct stat seen {};
  if (lstat(socket_folder().c_str(), &seen) != 0) return true;
  return S_ISDIR(seen.st_mode) && seen.st_uid == getuid() && (seen.st_mode & 022) == 0;
}

namespace {

constexpr const char* kOfControl = ".sock";
constexpr const char* kOfRun = ".run";

/// Letters, digits and dashes of a machine's name.
std::string file_name(const std::string& machine_name) {
  std::string name;
  for (const char c : machine_name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!name.empty() && name.back() != '-')
      name += '-';
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "control" : name;
}

std::vector<std::string> known(const char* extension) {
  std::vector<std::string> found;
  if (!own_socket_folder()) return found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(socket_folder(), error)) {
    const std::string path = entry.path().string();
    if (entry.path().extension() != extension || !entry.is_socket(error)) continue;
    SocketClient probe;
    if (probe.connect(path).empty())
      found.push_back(path);
    else
      unlink(path.c_str());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

std::string default_socket(const std::string& machine_name) {
  return socket_folder() + "/" + file_name(machine_name) + kOfControl;
}

std::string run_socket(const std::string& machine_name) {
  return socket_folder() + "/" + file_name(machine_name) + "-" + std::to_string(getpid()) + kOfRun;
}

std::vector<std::string> known_sockets() { return known(kOfControl); }

std::vector<std::string> known_runs() { return known(kOfRun); }

std::string clear_way(const std::string& path, text::Language language) {
  const auto say = [&](const text::Entry& entry, std::vector<std::string> arguments = {}) {
    return text::render(entry, arguments, language);
  };
  std::error_code error;
  const fs::path folder = fs::path(path).parent_path();
  const bool own = folder == fs::path(socket_folder());
  if (own && fs::create_directories(folder, error)) chmod(folder.c_str(), 0700);
  if (error) return text::words_of(error.value());
  if (!own && !folder.empty() && !fs::is_directory(folder, error))
    return say(says::kNoFolder, {folder.string()});
  struct stat seen {};
  if (own && lstat(folder.c_str(), &seen) == 0) {
    if (seen.st_uid != getuid() || !S_ISDIR(seen.st_mode))
      return say(says::kForeignFolder, {folder.string()});
    if ((seen.st_mode & 077) != 0) chmod(folder.c_str(), 0700);
  }
  if (lstat(path.c_str(), &seen) != 0) return {};
  if (!S_ISSOCK(seen.st_mode)) return say(says::kNoSocketFile);
  if (SocketClient probe; probe.connect(path).empty()) return say(says::kAnotherListens);
  unlink(path.c_str());
  return {};
}

}  // namespace servogate::gateway
