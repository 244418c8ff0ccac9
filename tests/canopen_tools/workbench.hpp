// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/shell/line.hpp"
#include "tests/usercan/rig/process.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::canopen_tools {

using nlohmann::json;
using shell::Ended;

/// A bus in a process of its own, simulated drives on it in others, and a folder in which tools are called.
class Workbench : public ::testing::Test {
 protected:
  Workbench();
  /// A process with simulated drives; returns once they live.
  usercan::Process& drives(const std::string& nodes, const std::vector<std::string>& options = {});
  /// `servogate WORDS`, with $BUS for the bus.
  Ended tool(const std::string& words, const std::string& language = "C") const;
  /// The same with --json, its facts; the exit code must be `code`.
  json facts(const std::string& words, int code = 0) const;
  /// A participant of the bus in this process.
  std::unique_ptr<usercan::SocketcandBus> join() const;
  /// A file of this folder.
  std::string path(const std::string& name) const { return desk_.path(name); }
  const std::string& bus() const noexcept { return url_; }

  shell::Desk desk_;

 private:
  std::string socket_, url_;
  std::unique_ptr<usercan::Process> bus_;
  std::vector<std::unique_ptr<usercan::Process>> drives_;
};

}  // namespace servogate::canopen_tools
