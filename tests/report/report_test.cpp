// SPDX-License-Identifier: Apache-2.0
#include "report/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/report/demo_run.hpp"

namespace servogate::report {
namespace {

using Json = nlohmann::json;

TEST(Sha256, agrees_with_the_examples_of_the_standard) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, of_a_file_is_that_of_its_bytes_and_a_missing_file_has_none) {
  const auto path = std::filesystem::temp_directory_path() / ("servogate-hash-" + std::to_string(::getpid()));
  const std::string bytes(50'001, '\0');
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_EQ(sha256_of_file(path.string()), sha256(bytes));
  std::filesystem::remove(path);
  EXPECT_EQ(sha256_of_file(path.string()), std::nullopt);
  EXPECT_EQ(identify("/nowhere").sha256, "");
  EXPECT_EQ(sha256_of_file("/"), std::nullopt);
}

TEST(Report, carries_every_field_of_the_contract) {
  const DemoRun demo = demo_run(1.0);
  const Json j = Json::parse(to_json(demo_report(demo, 2)));
  EXPECT_EQ(j["schema"], 1);
  EXPECT_EQ(j["finished"], false);
  EXPECT_EQ(j["cycles"], demo.rows.size());
  EXPECT_NEAR(j["time_s"].get<double>(), static_cast<double>(demo.rows.size()) * 0.001, 1e-9);
  for (const char* key : {"overruns", "starved", "blocks"}) EXPECT_TRUE(j[key].is_number_integer()) << key;
  for (const char* letter : {"X", "Y", "Z"})
    for (const char* key : {"max_velocity", "max_acceleration", "max_jerk", "max_following_error"})
      EXPECT_GT(j["axes"][letter][key].get<double>(), 0.0) << letter << key;
  EXPECT_EQ(j["axes"]["X"]["limits"]["travel_min"], -300.0);
  EXPECT_EQ(j["axes"]["X"]["limits"]["travel_max"], 300.0);
  for (const char* key : {"p50", "p99", "p999", "max"}) EXPECT_GT(j["cycle_us"][key].get<double>(), 2.0);
  EXPECT_GT(j["virtual_speed"].get<double>(), 0.0);
  EXPECT_EQ(j["segments"][0]["name"], "can");
  EXPECT_EQ(j["segments"][0]["sync_late_us"]["max"], 200.0);
  EXPECT_EQ(j["sync_skew_us"]["max"], 200.0);
  const auto& bands = j["segments"][0]["sync_late_histogram"];
  ASSERT_EQ(bands.size(), 9u) << "0-1 us, then doublings up to that of 200 us";
  EXPECT_EQ(bands[0]["count"], 1);
  EXPECT_EQ(bands[2]["from_us"], 2.0);
  EXPECT_EQ(bands[2]["count"], 1);
  EXPECT_EQ(bands[7]["to_us"], 128.0);
  EXPECT_EQ(bands[7]["count"], 3);
  EXPECT_EQ(bands[8]["count"], 1);
  EXPECT_EQ(j["phases_us"]["logic"]["max"], 0.7);
  EXPECT_FALSE(j.contains("lateness_us"));
}

TEST(Report, says_where_it_comes_from) {
  const Json p = Json::parse(to_json(demo_report(demo_run(1.0))))["provenance"];
  EXPECT_FALSE(p["version"].get<std::string>().empty());
  EXPECT_TRUE(p.contains("commit"));
  EXPECT_EQ(p["machine"]["sha256"].get<std::string>().size(), 64u);
  EXPECT_EQ(p["program"]["path"], "examples/mill/bracket.nc");
  EXPECT_EQ(p["plc"].size(), 1u);
  EXPECT_EQ(p["dialect"], "nc110");
  EXPECT_EQ(p["seed"], 42);
  EXPECT_EQ(p["clock"], "virtual");
  EXPECT_EQ(p["buses"][0]["kind"], "mock");
  EXPECT_NE(p["kernel"].get<std::string>().find("Linux"), std::string::npos);
  EXPECT_FALSE(p["processor"].get<std::string>().empty());
  EXPECT_EQ(p["nodes"][0]["vendor"], "0x00001234");
  EXPECT_EQ(p["command_line"][1], "run");
}

TEST(Report, an_alarm_names_its_place_and_leaves_out_what_it_does_not_know) {
  const Json alarms = Json::parse(to_json(demo_report(demo_run(1.0), 2)))["alarms"];
  ASSERT_EQ(alarms.size(), 2u);
  EXPECT_EQ(alarms[0]["reaction"], "stop_on_path");
  EXPECT_EQ(alarms[0]["axis"], "X");
  EXPECT_EQ(alarms[0]["line"], 8);
  EXPECT_EQ(alarms[0]["t"], 9.0);
  EXPECT_EQ(alarms[0]["value"], 2.013);
  EXPECT_EQ(alarms[1]["first_fault"], 1);
  EXPECT_FALSE(alarms[0].contains("object"));
  EXPECT_FALSE(alarms[0].contains("statusword"));
}

TEST(Report, is_valid_json_whatever_numbers_and_bytes_it_is_given) {
  Report r;
  r.time_s = std::nan("");
  r.virtual_speed = INFINITY;
  r.provenance.command_line = {"\xff\xfe bad bytes \"quoted\" \n"};
  const Json j = Json::parse(to_json(r));
  EXPECT_TRUE(j["time_s"].is_null());
  EXPECT_TRUE(j["virtual_speed"].is_null());
  EXPECT_NE(j["provenance"]["command_line"][0].get<std::string>().find("quoted"), std::string::npos);
}

TEST(Report, quantiles_are_microseconds) {
  Histogram h;
  for (int n = 1; n <= 1000; ++n) h.add(n * 1000);
  const Quantiles q = quantiles_us(h);
  EXPECT_NEAR(q.p50, 500.0, 500.0 / 64 + 1);
  EXPECT_NEAR(q.p99, 990.0, 990.0 / 64 + 1);
  EXPECT_EQ(q.max, 1000.0);
}

}  // namespace
}  // namespace servogate::report
