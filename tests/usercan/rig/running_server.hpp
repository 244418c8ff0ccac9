// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/mock/drive/simulated_drive.hpp"
#include "drivers/usercan/server/bus_server.hpp"
#include "drivers/usercan/socketcand_bus.hpp"

namespace servogate::usercan {

/// A bus server on a thread of its own, on a port that the system chose.
class RunningServer {
 public:
  explicit RunningServer(BusServerConfig config = {}, mock::CanMonitor* monitor = nullptr);
  ~RunningServer();

  const Address& address() const { return server_->address(); }
  std::unique_ptr<SocketcandBus> join(const std::string& lockstep = {}, const std::string& bus = "can0");
  /// Waits until lockstep has ended, a minute at most.
  bool ends();
  std::vector<std::string> notices();

 private:
  std::unique_ptr<BusServer> server_;
  std::thread thread_;
  std::atomic<bool> stop_{false}, ended_{false};
  std::mutex lock_;
  std::vector<std::string> notices_;
};

/// A simulated drive that lives on a bus, in the computer's time.
class LivingDrive {
 public:
  LivingDrive(std::unique_ptr<image::CanBus> bus, int node);
  ~LivingDrive();

 private:
  std::unique_ptr<image::CanBus> bus_;
  mock::SimulatedDrive drive_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Waits up to five seconds for a frame.
bool wait_for(image::CanBus& bus, image::CanFrame& frame);
image::CanFrame make(std::uint32_t id, std::initializer_list<std::uint8_t> bytes);
/// A folder for one run of the tests.
std::string scratch(const std::string& name);
/// Runs a shell command; its exit code.
int shell(const std::string& command);
std::string content(const std::string& file);
/// Another program of this folder: "counterparts/NAME".
std::string counterpart(const std::string& name);

}  // namespace servogate::usercan
