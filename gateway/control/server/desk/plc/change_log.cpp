// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/plc/change_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware_if/text/system_words.hpp"
#include "report/report.hpp"

namespace servogate::gateway {

using nlohmann::json;

std::string log_change(const std::string& state_path, const plc::LogicChange& change, const PlcLoaded& told,
                       const Caller& who, std::int64_t cycle) {
  if (state_path.empty()) return {};
  char when[32] = "";
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", &utc);
  json files = json::array();
  for (const plc::SourceFile& f : change.files)
    files.push_back({{"path", f.name}, {"sha256", report::sha256(f.text)}});
  const json entry{{"schema", 1},
                   {"when", when},
                   {"user", who.user},
                   {"cycle", cycle},
                   {"online", change.online},
                   {"files", files},
                   {"kept", told.kept},
                   {"fresh", told.fresh},
                   {"given_up", told.given_up},
                   {"set_aside", told.set_aside},
                   {"taken_back", told.taken_back}};
  std::error_code code;
  std::filesystem::create_directories(state_path, code);
  const std::string path = (std::filesystem::path(state_path) / "plc-changes.jsonl").string();
  const std::string line = entry.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  const bool good = fd >= 0 && ::write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
                    ::fsync(fd) == 0;
  const int problem = errno;
  if (fd >= 0) ::close(fd);
  return good ? std::string() : path + ": " + text::words_of(problem);
}

}  // namespace servogate::gateway
