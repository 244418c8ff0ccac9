// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/can_log.hpp"

#include <readerwriterqueue/readerwriterqueue.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <numeric>

#include "drivers/candump/candump_line.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::gateway {

namespace {

// The longest cycle has some hundreds of frames: a segment of 1 Mbit/s carries 21 in a millisecond.
constexpr std::size_t kQueued = 8192, kRoom = 4096;

const text::Entry kFramesLost{"can-log.lost", "{0} frames of {1} are missing: the computer was too slow",
                              "не хватает кадров: {0} ({1}); компьютер не успевал"};

std::string file_of(const std::string& folder, const std::string& bus) { return folder + "/" + bus + ".log"; }

}  // namespace

/// One bus: the cycle puts frames in, the writer takes them out.
class CanLog::Wire final : public mock::CanMonitor {
 public:
  Wire(mock::CanSegment& segment, std::string name, const std::string& path)
      : segment_(segment), name_(std::move(name)), file_(std::fopen(path.c_str(), "wb")) {
    if (file_ == nullptr)
      error_ = path + ": " + text::words_of(errno);
    else
      segment_.set_monitor(this);
  }
  ~Wire() override {
    segment_.set_monitor(nullptr);
    if (file_ != nullptr) std::fclose(file_);
  }

  void on_wire(const mock::CanFrame& frame, int, image::Nanoseconds, image::Nanoseconds end,
               Outcome outcome) noexcept override {
    if (outcome == Outcome::error) return;
    mock::CanFrame copy = frame;
    copy.timestamp_ns = end;
    if (!queue_.try_enqueue(copy)) lost_.fetch_add(1, std::memory_order_relaxed);
  }

  bool has_room() const { return file_ == nullptr || queue_.size_approx() < kQueued - kRoom; }
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }
  const std::string& name() const noexcept { return name_; }
  void write_queued() {
    mock::CanFrame frame;
    while (queue_.try_dequeue(frame)) {
      const std::string line = candump::format(frame, frame.timestamp_ns, name_) + '\n';
      if (std::fwrite(line.data(), 1, line.size(), file_) != line.size() && error_.empty())
        error_ = name_ + ": " + text::words_of(errno);
    }
  }
  std::string close() {
    segment_.set_monitor(nullptr);
    if (file_ != nullptr && std::fclose(file_) != 0 && error_.empty())
      error_ = name_ + ": " + text::words_of(errno);
    file_ = nullptr;
    return error_;
  }

 private:
  mock::CanSegment& segment_;
  std::string name_;
  std::FILE* file_;
  std::string error_;
  std::atomic<std::uint64_t> lost_{0};
  moodycamel::ReaderWriterQueue<mock::CanFrame> queue_{kQueued};
};

std::vector<files::NamedPath> CanLog::files_of(const std::string& folder,
                                               const machine::MachineConfig& machine) {
  std::vector<files::NamedPath> files;
  for (const machine::BusConfig& bus : machine.buses)
    if (bus.mock()) files.push_back({"--can-log", file_of(folder, bus.name)});
  return files;
}

CanLog::CanLog(const std::string& folder, Control& control) : control_(control) {
  const std::vector<machine::BusConfig>& buses = control_.machine().buses;
  for (std::size_t i = 0; i < buses.size(); ++i)
    if (mock::CanSegment* segment = control_.world().wire(i); segment != nullptr)
      wires_.push_back(std::make_unique<Wire>(*segment, buses[i].name, file_of(folder, buses[i].name)));
  thread_ = std::thread([this] { drain(); });
}

CanLog::~CanLog() { close(); }

void CanLog::drain() {
  for (bool last = false; !last;) {
    last = stop_.load();
    for (const auto& wire : wires_) wire->write_queued();
    if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void CanLog::wait_for_room() const {
  const auto room = [](const auto& wire) { return wire->has_room(); };
  while (!std::all_of(wires_.begin(), wires_.end(), room)) std::this_thread::yield();
}

std::uint64_t CanLog::lost() const noexcept {
  return std::accumulate(wires_.begin(), wires_.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& wire) { return sum + wire->lost(); });
}

std::string CanLog::close() {
  if (!thread_.joinable()) return {};
  stop_ = true;
  thread_.join();
  std::string error;
  for (const auto& wire : wires_) {
    const std::string problem = wire->close();
    if (error.empty()) error = problem;
    if (error.empty() && wire->lost() > 0)
      error = text::render(kFramesLost, std::vector<std::string>{std::to_string(wire->lost()), wire->name()},
                           text::user_language());
  }
  return error;
}

}  // namespace servogate::gateway
