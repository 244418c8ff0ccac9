// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::testing {

/// What a command left behind.
struct Outcome {
  int exit = -1;
  std::string out, err;
};

/// Waits for a process and gives its exit code; 128 and the number of the signal that ended it.
int ending_of(pid_t pid);

bool contains(const std::string& text, const std::string& part);

/// The alarm of that number in a status; null: it is not there.
nlohmann::json alarm_of(const nlohmann::json& status, int number);
inline bool has_alarm(const nlohmann::json& status, int number) {
  return !alarm_of(status, number).is_null();
}

/// The program in a folder of its own; whatever it started is ended with it. What a test builds on and does
/// not come to be (up(), ready(), an answer) is an exception: it fails that test, and the next one begins.
class Shell {
 public:
  Shell();
  ~Shell();
  Shell(const Shell&) = delete;

  /// Runs `servogate ARGUMENTS` to its end. `language`: value of LANG.
  Outcome run(const std::vector<std::string>& arguments, const std::string& language = "C");
  /// Starts it and goes on.
  pid_t spawn(const std::vector<std::string>& arguments, const std::string& name);
  /// `servogate up` of an example, ready to be asked. More arguments follow the machine file.
  void up(const std::string& machine = "mill",
          const std::vector<std::string>& more = {"--virtual", "--speed", "20"});
  /// The same with a machine file of its own, which has the name of the example mill.
  void up_file(const std::string& machine, const std::vector<std::string>& more);
  /// Ends the control by a signal and gives its exit code.
  int end(int signal);
  /// Waits for the control's own end and gives its exit code.
  int wait();
  pid_t pid() const { return up_; }

  /// One request on the socket, answered; throws where nobody answers.
  nlohmann::json ask(const nlohmann::json& request);
  /// Throws where there is none.
  nlohmann::json status();
  /// Asks for the status until `good` says so, which sees whole ones only; false after two minutes, so that
  /// no computer is too slow for it. Throws when the control has ended.
  bool until(const std::function<bool(const nlohmann::json&)>& good);
  /// Value of a variable or place of the PLC; null: there is none.
  nlohmann::json plc_value(const std::string& name);
  /// Waits until it has this value.
  bool plc_becomes(const std::string& name, const nlohmann::json& wanted);
  /// Switched on and homed.
  void ready();

  std::string socket() const { return (folder_ / "servogate" / name_).string(); }
  std::filesystem::path folder() const { return folder_; }
  std::string text(const std::string& file) const;
  static std::string example(const std::string& path);

 private:
  std::optional<nlohmann::json> answer_to(const nlohmann::json& request);

  std::filesystem::path folder_;
  std::string name_ = "three-axis-mill.sock";
  pid_t up_ = -1;
};

}  // namespace servogate::gateway::testing
