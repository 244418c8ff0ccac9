// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/capture/machine_capture.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <limits>
#include <vector>

#include "report/capture/csv_capture.hpp"
#include "report/capture/mcap_capture.hpp"
#include "report/report.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kNoChannel{
    "capture.no-channel",
    "--channels: {0}: this machine has no such value. Groups are {1}; values are, for example, {2}, points, "
    "words "
    "of the interface, addresses and variables of the PLC",
    "--channels: {0}: у этого станка нет такой величины. Группы: {1}; величины — например, {2}, точки, слова "
    "интерфейса, адреса и переменные ПЛК"};
const text::Entry kNothing{"capture.nothing",
                           "--channels: {0} is nothing on this machine: name values that it has",
                           "--channels: {0} — на этом станке пусто: назовите величины, которые у него есть"};
const text::Entry kGroup{"capture.group", "--trigger: {0} is a group: name one value",
                         "--trigger: {0} — группа: назовите одну величину"};
const text::Entry kMemory{
    "capture.memory",
    "--before {0} s of {1} values needs {2} MB: fewer channels or a shorter time; at most {3} MB",
    "--before {0} с для величин: {1} — это {2} МБ: возьмите меньше величин или времени; не больше {3} МБ"};
const text::Entry kNoTrigger{"capture.no-trigger",
                             "--trigger: {0} is no condition: write NAME, one of < <= > >= = !=, and a "
                             "number (the number of alarms is alarms), or alarm alone",
                             "--trigger: {0} — не условие: напишите ИМЯ, один из знаков < <= > >= = != и "
                             "число (число аварий — alarms), или одно слово alarm"};
const text::Entry kNoFormat{"capture.no-format", "--capture: {0} ends neither with .csv nor with .mcap",
                            "--capture: {0} не кончается ни на .csv, ни на .mcap"};
const text::Entry kNeedsFile{"capture.no-file-named", "--channels and --trigger need --capture FILE",
                             "--channels и --trigger требуют --capture ФАЙЛ"};
const text::Entry kLost{"capture.lost", "{0} values or frames are missing: the computer was too slow",
                        "не хватает величин или кадров: {0}; компьютер не успевал"};

constexpr double kMostMemory = 2000.0;  // MB

std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  std::string name;
  for (const char c : list + ',') {
    if (c == ' ') continue;
    if (c != ',') {
      name += c;
      continue;
    }
    if (!name.empty()) names.push_back(std::move(name));
    name.clear();
  }
  return names;
}

std::unique_ptr<report::CaptureSink> sink_of(const std::string& path) {
  if (path.ends_with(".mcap")) return std::make_unique<report::McapCapture>(path);
  return std::make_unique<report::CsvCapture>(path);
}

/// 20261126-140322, of this computer's clock.
std::string date_and_time() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", &local);
  return text;
}

/// Leaves room for one more file; the names begin with the date.
void drop_oldest(const std::filesystem::path& folder, std::size_t most) {
  std::error_code ignored;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (std::size_t n = 0; n + most <= files.size(); ++n) std::filesystem::remove(files[n], ignored);
}

}  // namespace

MachineCapture::MachineCapture(Control& control, MachineChannels channels, std::string path)
    : control_(control), channels_(std::move(channels)), path_(std::move(path)) {}

MachineCapture::~MachineCapture() { close(); }

std::unique_ptr<MachineCapture> MachineCapture::open(Control& control, const CaptureRequest& request,
                                                     drivers::Notice& why) {
  if (request.file.empty()) {
    why = {&kNeedsFile, {}};
    return nullptr;
  }
  if (!request.file.ends_with(".csv") && !request.file.ends_with(".mcap")) {
    why = {&kNoFormat, {request.file}};
    return nullptr;
  }
  report::CaptureSettings settings;
  settings.before_s = request.before_s;
  settings.after_s = request.after_s;
  MachineChannels channels;
  const auto add = [&](const std::string& name) {
    if (channels.add(control, name)) return true;
    const std::string axis = control.machine().axes.empty() ? "X" : control.machine().axes.front().letter;
    why = {&kNoChannel,
           {name, std::string(MachineChannels::kGroups), axis + ".error, " + axis + ".drive.torque, feed"}};
    return false;
  };
  for (const std::string& name :
       names_in(request.channels.empty() ? "axes,spindles,processes,points" : request.channels))
    if (!add(name)) return nullptr;
  if (!request.trigger.empty()) {
    settings.trigger = report::parse_trigger(request.trigger);
    if (!settings.trigger) {
      why = {&kNoTrigger, {request.trigger}};
      return nullptr;
    }
    const std::string& name = settings.trigger->channel;
    if (name == "alarm") {
      why = {&kNoTrigger, {request.trigger}};
      return nullptr;
    }
    if (MachineChannels::is_group(name)) {
      why = {&kGroup, {name}};
      return nullptr;
    }
    if (!add(name)) return nullptr;
  }
  if (channels.channels().empty()) {
    why = {&kNothing, {request.channels}};
    return nullptr;
  }
  const double rows =
      settings.trigger ? request.before_s * 1e9 / static_cast<double>(control.machine().cycle_ns()) : 0.0;
  const double megabytes = rows * static_cast<double>(sizeof(double) * channels.channels().size()) / 1e6;
  if (megabytes > kMostMemory) {
    why = {&kMemory,
           {text::number(request.before_s), std::to_string(channels.channels().size()),
            text::number(megabytes, 0), text::number(kMostMemory, 0)}};
    return nullptr;
  }
  std::unique_ptr<MachineCapture> capture(new MachineCapture(control, std::move(channels), request.file));
  capture->start(std::move(settings), [path = request.file](int) { return sink_of(path); });
  return capture;
}

std::unique_ptr<MachineCapture> MachineCapture::black_box(Control& control, const std::string& folder) {
  MachineChannels channels;
  for (const char* group : {"alarms", "processes", "axes", "spindles", "points"})
    channels.add(control, group);
  report::CaptureSettings settings;
  settings.trigger = report::parse_trigger("alarm");
  settings.before_s = kBlackBox_s;
  settings.most = std::numeric_limits<int>::max();
  std::unique_ptr<MachineCapture> capture(new MachineCapture(control, std::move(channels), folder));
  capture->start(std::move(settings), [folder](int number) {
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    drop_oldest(folder, kBlackBoxes);
    char count[16];
    std::snprintf(count, sizeof count, "-%03d", number);
    return std::make_unique<report::McapCapture>(folder + '/' + date_and_time() + count + ".mcap");
  });
  return capture;
}

void MachineCapture::start(report::CaptureSettings settings, report::Capture::Open open) {
  report::CaptureLayout layout;
  layout.period_ns = control_.machine().cycle_ns();
  layout.channels = channels_.channels();
  for (const machine::BusConfig& bus : control_.machine().buses) layout.buses.push_back(bus.name);
  const auto identity = report::build_identity();
  layout.origin = {{"machine", control_.machine().name},
                   {"version", std::string(identity.version)},
                   {"commit", std::string(identity.commit)}};
  recorder_ = std::make_unique<report::CaptureRecorder>(
      std::make_unique<report::Capture>(std::move(layout), std::move(settings), std::move(open)));
  for (const auto& tap : control_.taps()) tap->attach(*this);
}

void MachineCapture::after_cycle() noexcept {
  const std::span<double> slot = recorder_->slot();
  if (slot.empty()) return;
  channels_.read(control_, slot);
  recorder_->commit(control_.cycle().image().now.t_ns);
}

void MachineCapture::passed(int bus, const image::CanFrame& frame, bool sent) noexcept {
  const image::Nanoseconds now = control_.cycle().image().now.t_ns;
  image::Nanoseconds at = now;
  if (!sent) {  // when its end was on the wire, in machine time
    const auto due = control_.due_ns();
    at = std::min(now, due ? frame.timestamp_ns - (*due - now) : frame.timestamp_ns);
  }
  recorder_->frame({at, bus, frame});
}

std::string MachineCapture::close() {
  for (const auto& tap : control_.taps()) tap->detach(*this);
  std::string error = recorder_->close();
  if (error.empty() && recorder_->lost() > 0)
    error = text::render(kLost, std::vector<std::string>{std::to_string(recorder_->lost())},
                         text::user_language());
  return error;
}

}  // namespace servogate::gateway
