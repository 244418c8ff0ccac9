// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/run_record.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "firmware_if/canopen/master/events/bus_event.hpp"
#include "firmware_if/text/hex.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/command/bench/run_page.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {
namespace {

const text::Entry kThere{"bench.there", "{0} is there already: a run makes its own directory",
                         "каталог {0} уже есть: каждый прогон создаёт свой"};
const text::Entry kTravel{"bench.trip-travel",
                          "the travel would be left: {0} rev, allowed up to {1} rev (--travel)",
                          "выход за ход: {0} об., допустимо до {1} об. (--travel)"};
const text::Entry kSpeed{"bench.trip-speed", "the speed is too high: {0} rev/s, allowed {1} rev/s (--speed)",
                         "скорость слишком велика: {0} об/с, допустимо {1} об/с (--speed)"};
const text::Entry kTorque{"bench.trip-torque", "the torque is too high: {0} N m, allowed {1} N m (--torque)",
                          "момент слишком велик: {0} Н·м, допустимо {1} Н·м (--torque)"};
const text::Entry kTime{"bench.trip-time", "the time with power is over: {0} s, allowed {1} s (--time)",
                        "время под током истекло: {0} с, допустимо {1} с (--time)"};
const text::Entry kFollowing{"bench.trip-following",
                             "the drive does not follow: {0} rev behind, allowed {1} rev (--following)",
                             "привод не успевает: отставание {0} об., допустимо {1} об. (--following)"};
const text::Entry kFault{"bench.trip-fault", "the drive reports a fault, error code {0}h (603Fh): {1}",
                         "привод сообщает о неисправности, код {0}h (603Fh): {1}"};
const text::Entry kOffline{"bench.trip-offline", "the process data of the drive do not come any more",
                           "данные процесса от привода больше не приходят"};
const text::Entry kNotEnabled{"bench.trip-not-enabled",
                              "the drive did not reach Operation enabled: statusword {0}h",
                              "привод не дошёл до Operation enabled: слово состояния {0}h"};
const text::Entry kEnded{"bench.trip-ended", "ended by the operator", "завершено оператором"};
const text::Entry kGone{"bench.trip-gone", "the bus is gone", "шина исчезла"};

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr const char* kLoops[] = {"position", "velocity", "torque"};

/// Names of the recorded objects as columns.
std::string heads(const ObjectRecorder& recorder) {
  std::string out;
  for (const RecordedObject& o : recorder.objects()) out += ",\"" + o.name + "\"";
  return out;
}

std::string cells(const ObjectRecorder& recorder, std::size_t row) {
  std::string out;
  for (const double value : recorder.row(row)) {
    char cell[32];
    std::snprintf(cell, sizeof cell, ",%.15g", value);
    out += cell;
  }
  return out;
}

bool write_files(const std::string& path, const std::vector<std::pair<std::string, std::string>>& files,
                 const nlohmann::json& meta) {
  auto all = files;
  all.emplace_back("meta.json", meta.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  for (const auto& [name, content] : all)
    if (const std::string why = report::write_file(path + "/" + name, content); !why.empty()) {
      complain(kCannotWrite, {path + "/" + name, why});
      return false;
    }
  return true;
}

}  // namespace

bool make_run_directory(const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    complain(kThere, {path});
    return false;
  }
  if (std::filesystem::create_directories(path, error)) return true;
  complain(kCannotWrite, {path, error.message()});
  return false;
}

bool write_run(const std::string& path, const bench::Guard& guard, const ObjectRecorder& recorder,
               const nlohmann::json& meta) {
  std::string csv = "time_s,stage,loop,set_point,position_rev,torque_nm,statusword" + heads(recorder) + "\n";
  // The recorder has the cycles before the guard, too.
  const std::size_t before = recorder.rows() - std::min(recorder.rows(), guard.samples().size());
  for (std::size_t n = 0; n < guard.samples().size(); ++n) {
    const bench::Sample& s = guard.samples()[n];
    const double unit = s.loop == bench::Loop::torque ? 1.0 : kTurn;
    char line[160];
    std::snprintf(line, sizeof line, "%.6f,%s,%s,%.9g,%.9g,%.6g,0x%04X", s.time_s,
                  guard.stages()[s.stage].c_str(), kLoops[static_cast<int>(s.loop)], s.set_point / unit,
                  s.position_rad / kTurn, s.torque_nm, s.statusword);
    csv += line;
    if (recorder.rows() > 0) csv += cells(recorder, before + n);
    csv += '\n';
  }
  return write_files(path, {{"samples.csv", csv}, {"report.html", run_page(guard, meta)}}, meta);
}

bool write_objects(const std::string& path, const ObjectRecorder& recorder, std::size_t first, double period,
                   const nlohmann::json& meta) {
  std::string csv = "time_s" + heads(recorder) + "\n";
  for (std::size_t n = first; n < recorder.rows(); ++n) {
    char time[32];
    std::snprintf(time, sizeof time, "%.6f", static_cast<double>(n - first) * period);
    csv += time + cells(recorder, n) + "\n";
  }
  return write_files(path, {{"samples.csv", csv}}, meta);
}

const char* trip_name(bench::Trip trip) noexcept {
  constexpr const char* kNames[] = {"none",  "travel",  "speed",       "torque", "time", "following",
                                    "fault", "offline", "not enabled", "ended",  "gone"};
  return kNames[static_cast<int>(trip)];
}

std::string trip_words(const bench::Guard& guard) {
  const auto say = [&](const text::Entry& entry, double unit) {
    return text::render(entry,
                        std::vector<std::string>{text::number(guard.trip_value() / unit, 4),
                                                 text::number(guard.trip_limit() / unit, 4)},
                        text::user_language());
  };
  const auto with_code = [&](const text::Entry& entry) {
    const auto code = static_cast<std::uint16_t>(guard.trip_value());
    return text::render(
        entry,
        std::vector<std::string>{text::hex_number(code, 4),
                                 canopen::describe_error_code(code, nullptr, text::user_language())},
        text::user_language());
  };
  switch (guard.trip()) {
    case bench::Trip::none:
      return {};
    case bench::Trip::travel:
      return say(kTravel, kTurn);
    case bench::Trip::speed:
      return say(kSpeed, kTurn);
    case bench::Trip::torque:
      return say(kTorque, 1.0);
    case bench::Trip::time:
      return say(kTime, 1.0);
    case bench::Trip::following:
      return say(kFollowing, kTurn);
    case bench::Trip::fault:
      return with_code(kFault);
    case bench::Trip::not_enabled:
      return with_code(kNotEnabled);
    case bench::Trip::offline:
      return say(kOffline, 1.0);
    case bench::Trip::ended:
      return say(kEnded, 1.0);
    case bench::Trip::gone:
      return say(kGone, 1.0);
  }
  return {};
}

}  // namespace servogate::gateway::command
