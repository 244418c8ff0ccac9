// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/history/event_log.hpp"

#include <spdlog/async.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

namespace servogate::gateway::history {

namespace {

using nlohmann::json;

constexpr int kSchema = 1;
constexpr std::size_t kGeneration_bytes = 2'000'000, kOlderGenerations = 2, kWaiting = 8192;

std::string utc_now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  const std::time_t seconds = ms / 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[40];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  return std::string(text, length) + fmt::format(".{:03}Z", ms % 1000);
}

std::string line_of(const Event& e) {
  const json line{{"schema", kSchema},
                  {"time", e.time},
                  {"machine_s", e.machine_s},
                  {"kind", e.kind},
                  {"id", e.id},
                  {"number", e.number},
                  {"who", e.who},
                  {"text", {{"en", e.english}, {"ru", e.russian}}}};
  return line.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// False: no event of this schema; a line that a full disk has cut, or of a later version, is read over.
bool read_line(const std::string& text, Event& e) {
  const json line = json::parse(text, nullptr, false);
  if (!line.is_object()) return false;
  try {
    if (line.at("schema") != kSchema) return false;
    line.at("time").get_to(e.time);
    line.at("machine_s").get_to(e.machine_s);
    line.at("kind").get_to(e.kind);
    line.at("id").get_to(e.id);
    line.at("number").get_to(e.number);
    line.at("who").get_to(e.who);
    line.at("text").at("en").get_to(e.english);
    line.at("text").at("ru").get_to(e.russian);
  } catch (const json::exception&) {
    return false;
  }
  return true;
}

}  // namespace

Event event(std::string kind, const text::Entry& entry, const std::vector<std::string>& arguments,
            double machine_s) {
  Event e;
  e.machine_s = machine_s;
  e.kind = std::move(kind);
  e.id = std::string(entry.id);
  e.english = text::render(entry, arguments, text::Language::english);
  e.russian = text::render(entry, arguments, text::Language::russian);
  return e;
}

EventLog::EventLog(const Places& places)
    : pool_(std::make_shared<spdlog::details::thread_pool>(kWaiting, 1)) {
  const auto complain = [this](const std::string& why) {
    const std::scoped_lock lock(mutex_);
    problem_ = why;
  };
  const auto logger = [&](spdlog::sink_ptr sink) {
    sink->set_pattern("%v");
    auto made = std::make_shared<spdlog::async_logger>("history", std::move(sink), pool_,
                                                       spdlog::async_overflow_policy::overrun_oldest);
    made->flush_on(spdlog::level::info);
    made->set_error_handler(complain);
    return made;
  };
  if (places.console) console_ = logger(std::make_shared<spdlog::sinks::stderr_sink_mt>());
  if (places.folder.empty()) return;
  const std::string stem = places.folder + "/events";
  read_generation(stem + ".1.jsonl");
  read_generation(stem + ".jsonl");
  try {
    file_ = logger(std::make_shared<spdlog::sinks::rotating_file_sink_mt>(stem + ".jsonl", kGeneration_bytes,
                                                                          kOlderGenerations));
  } catch (const spdlog::spdlog_ex& e) {
    complain(e.what());
  }
}

EventLog::~EventLog() = default;

void EventLog::read_generation(const std::string& path) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (Event e; read_line(line, e)) remember(std::move(e));
}

void EventLog::remember(Event event) {
  events_.push_back(std::move(event));
  if (events_.size() > kRemembered) events_.pop_front();
}

void EventLog::note(Event event) {
  if (event.time.empty()) event.time = utc_now();
  if (file_) file_->log(spdlog::level::info, spdlog::string_view_t(line_of(event)));
  if (console_)
    console_->log(spdlog::level::info,
                  spdlog::string_view_t(text::visible(event.text(text::user_language()))));
  const std::scoped_lock lock(mutex_);
  remember(std::move(event));
}

std::vector<Event> EventLog::last(std::size_t count) const {
  const std::scoped_lock lock(mutex_);
  const std::size_t some = std::min(count, events_.size());
  return {events_.end() - static_cast<std::ptrdiff_t>(some), events_.end()};
}

std::string EventLog::problem() const {
  const std::scoped_lock lock(mutex_);
  return problem_;
}

}  // namespace servogate::gateway::history
