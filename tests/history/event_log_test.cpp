// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/history/event_log.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "gateway/control/history/request_words.hpp"
#include "gateway/control/history/texts.hpp"

namespace servogate::gateway::history {
namespace {

namespace fs = std::filesystem;

class History : public ::testing::Test {
 protected:
  History() {
    std::string name = fs::temp_directory_path() / "servogate-history-XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~History() override { fs::remove_all(folder_); }
  EventLog::Places here() const { return {folder_.string(), false}; }
  std::vector<nlohmann::json> lines() const {
    std::vector<nlohmann::json> all;
    std::ifstream in(folder_ / "events.jsonl");
    for (std::string line; std::getline(in, line);)
      all.push_back(nlohmann::json::parse(line, nullptr, false));
    return all;
  }
  fs::path folder_;
};

Event homed(const std::string& axis) { return event("axis", says::kHomed, {axis}, 1.5); }

TEST_F(History, keeps_an_event_as_a_line_with_its_time_and_both_languages) {
  EventLog(here()).note(homed("X"));
  ASSERT_EQ(lines().size(), 1u);
  const nlohmann::json line = lines()[0];
  EXPECT_TRUE(std::regex_match(line["time"].get<std::string>(),
                               std::regex(R"(20\d\d-\d\d-\d\dT\d\d:\d\d:\d\d\.\d\d\dZ)")))
      << line;
  EXPECT_EQ(line["machine_s"], 1.5);
  EXPECT_EQ(line["id"], "history.homed");
  EXPECT_EQ(line["text"]["en"], "X has its reference");
  EXPECT_EQ(line["text"]["ru"], "X: нулевая точка найдена");
}

TEST_F(History, is_there_again_when_the_control_comes_up_anew) {
  EventLog(here()).note(homed("X"));
  EventLog(here()).note(homed("Y"));
  const EventLog third(here());
  const std::vector<Event> all = third.last(100);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].english, "X has its reference");
  EXPECT_EQ(all[1].english, "Y has its reference");
  EXPECT_EQ(all[1].machine_s, 1.5);
  EXPECT_EQ(third.last(1)[0].english, "Y has its reference");
  EXPECT_TRUE(third.last(0).empty());
}

TEST_F(History, reads_over_lines_that_are_damaged_or_of_a_later_version) {
  EventLog(here()).note(homed("X"));
  std::ofstream(folder_ / "events.jsonl", std::ios::app) << "{\"schema\":1,\"time\":\"2026-\n"
                                                         << std::string(3, '\0') << "\n[]\n{\"schema\":2}\n"
                                                         << "{\"schema\":1,\"time\":7}\n\n";
  EventLog(here()).note(homed("Y"));
  const EventLog again(here());
  ASSERT_EQ(again.last(100).size(), 2u);
  EXPECT_EQ(again.last(100)[1].english, "Y has its reference");
}

TEST_F(History, is_bounded_on_the_disk_and_in_memory) {
  {
    EventLog log(here());
    Event e = homed("X");
    e.english = std::string(4000, 'x');
    for (int i = 0; i < 2500; ++i) log.note(e);
    EXPECT_EQ(log.last(100'000).size(), EventLog::kRemembered);
  }
  EXPECT_TRUE(fs::exists(folder_ / "events.1.jsonl"));
  EXPECT_TRUE(fs::exists(folder_ / "events.2.jsonl"));
  EXPECT_FALSE(fs::exists(folder_ / "events.3.jsonl"));
  for (const auto& file : fs::directory_iterator(folder_)) EXPECT_LT(file.file_size(), 2'100'000u) << file;
}

TEST_F(History, that_cannot_be_written_says_so_and_goes_on_in_memory) {
  std::ofstream(folder_ / "file") << "no folder";
  EventLog log({(folder_ / "file" / "state").string(), false});
  log.note(homed("X"));
  EXPECT_NE(log.problem(), "");
  EXPECT_EQ(log.last(10).size(), 1u);
}

TEST_F(History, of_many_threads_has_whole_lines) {
  {
    EventLog log(here());
    std::vector<std::thread> threads;
    for (const char* axis : {"X", "Y", "Z", "A"})
      threads.emplace_back([&log, axis] {
        for (int i = 0; i < 200; ++i) log.note(homed(axis));
      });
    for (std::thread& t : threads) t.join();
  }
  EXPECT_EQ(lines().size(), 800u);
  for (const nlohmann::json& line : lines()) EXPECT_TRUE(line.is_object());
}

TEST(RequestWords, keep_what_people_ask_for_and_neither_keep_alives_nor_the_drudgery_of_a_plc) {
  using image::RequestKind;
  for (const RequestKind kind : {RequestKind::power, RequestKind::start, RequestKind::quick_stop,
                                 RequestKind::force, RequestKind::jog_continuous, RequestKind::reset,
                                 RequestKind::set_place, RequestKind::assign, RequestKind::tables})
    EXPECT_TRUE(kept(kind));
  for (const RequestKind kind :
       {RequestKind::none, RequestKind::keep_alive, RequestKind::move_absolute, RequestKind::torque})
    EXPECT_FALSE(kept(kind));
}

TEST(RequestWords, say_who_asked_for_what_and_why_it_was_refused) {
  machine::MachineConfig machine;
  machine.axes.resize(1);
  machine.axes[0].letter = "X";
  image::Request request;
  request.asker = image::Asker::pendant;
  request.kind = image::RequestKind::jog_increment;
  request.axis = 0;
  request.value = -0.25;
  const Event done = request_event(request, {}, machine, 2.0);
  EXPECT_EQ(done.kind, "request");
  EXPECT_EQ(done.english, "the pendant: jog X by -0.25");
  image::Answer refused;
  refused.refusal = 1;
  const Event not_done = request_event(request, refused, machine, 2.0);
  EXPECT_EQ(not_done.kind, "refused");
  EXPECT_TRUE(not_done.english.starts_with("the pendant: jog X by -0.25: refused: ")) << not_done.english;
}

}  // namespace
}  // namespace servogate::gateway::history
