// SPDX-License-Identifier: Apache-2.0
#include "tests/usercan/rig/running_server.hpp"
#include "tests/comes.hpp"
#include "tests/places/places.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace servogate::usercan {
namespace {

mock::SimulatedDriveConfig drive_config(int node) {
  mock::SimulatedDriveConfig c;
  c.node_id = static_cast<canopen::NodeId>(node);
  return c;
}

image::Nanoseconds monotonic() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

RunningServer::RunningServer(BusServerConfig config, mock::CanMonitor* monitor) {
  if (config.listen.host.empty() && config.listen.path.empty()) config.listen.host = "127.0.0.1";
  drivers::Notice why;
  server_ = BusServer::open(
      std::move(config),
      [this](const drivers::Notice& n) {
        const std::scoped_lock lock(lock_);
        notices_.push_back(n.str(text::Language::english));
      },
      why);
  EXPECT_NE(server_, nullptr) << why.str(text::Language::english);
  server_->set_monitor(0, monitor);
  thread_ = std::thread([this] {
    while (!stop_ && server_->serve(20 * image::kMillisecond)) {
    }
    ended_ = true;
  });
}

RunningServer::~RunningServer() {
  stop_ = true;
  thread_.join();
}

std::unique_ptr<SocketcandBus> RunningServer::join(const std::string& lockstep, const std::string& bus) {
  SocketcandConfig config;
  config.address = address();
  config.lockstep = lockstep;
  config.bus = bus;
  drivers::Notice why;
  auto joined = SocketcandBus::open(config, why);
  EXPECT_NE(joined, nullptr) << why.str(text::Language::english);
  return joined;
}

bool RunningServer::ends() {
  return tests::comes([&] { return ended_.load(); });
}

std::vector<std::string> RunningServer::notices() {
  const std::scoped_lock lock(lock_);
  return notices_;
}

LivingDrive::LivingDrive(std::unique_ptr<image::CanBus> bus, int node)
    : bus_(std::move(bus)), drive_(drive_config(node)) {
  thread_ = std::thread([this] {
    const image::Nanoseconds start = monotonic();
    mock::PolledDrive polled(drive_, *bus_, start);
    while (!stop_) {
      polled.advance_to(monotonic());
      usleep(250);
    }
  });
}

LivingDrive::~LivingDrive() {
  stop_ = true;
  thread_.join();
}

bool wait_for(image::CanBus& bus, image::CanFrame& frame) {
  return tests::comes([&] { return bus.receive(frame); }, std::chrono::milliseconds(1));
}

image::CanFrame make(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  image::CanFrame f;
  f.id = id;
  f.extended = id > 0x7FF;
  for (const std::uint8_t b : bytes) f.data[f.length++] = b;
  return f;
}

namespace {

/// Folders of this process, gone when it ends.
struct Folders {
  ~Folders() {
    std::error_code ignored;
    for (const std::string& folder : all) std::filesystem::remove_all(folder, ignored);
  }
  std::vector<std::string> all;
};

}  // namespace

std::string scratch(const std::string& name) {
  static Folders folders;
  std::string folder = ::testing::TempDir() + "usercan-" + std::to_string(getpid()) + "-XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) ADD_FAILURE() << "no folder " << folder;
  folders.all.push_back(folder);
  return folder + "/" + name;
}

int shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string content(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string counterpart(const std::string& name) {
  return tests::source_dir() + "/tests/usercan/counterparts/" + name;
}

}  // namespace servogate::usercan
