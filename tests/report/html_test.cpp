// SPDX-License-Identifier: Apache-2.0
#include "gateway/report/html.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/places/places.hpp"
#include "tests/report/demo_run.hpp"

namespace servogate::report {
namespace {

using Json = nlohmann::json;

HtmlOptions options_of(const DemoRun& demo) {
  return {"Example mill", "bracket.nc", demo.program, text::Language::english};
}

Json data_of(const std::string& html) {
  const std::string start = "<script type=\"application/json\" id=\"data\">";
  const std::size_t at = html.find(start) + start.size();
  return Json::parse(html.substr(at, html.find("</script>", at) - at));
}

std::vector<float> floats(const std::string& base64) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : base64) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((count += 6) >= 8) bytes.push_back(static_cast<unsigned char>(bits >> (count -= 8)));
  }
  std::vector<float> out(bytes.size() / 4);
  std::memcpy(out.data(), bytes.data(), 4 * out.size());
  return out;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("servogate-html-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

TEST(Html, needs_nothing_from_outside_itself) {
  const DemoRun demo = demo_run(5.0);
  const std::string html = to_html(demo_report(demo, 1), recorded(demo), options_of(demo));
  for (const char* outside :
       {"http:", "https:", "src=", "href=", "@import", "url(", "fetch(", "XMLHttpRequest", "import("})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(html.ends_with("</html>\n"));
}

TEST(Html, carries_the_run_the_report_and_the_program) {
  const DemoRun demo = demo_run(5.0);
  RunRecorderOptions all;
  all.max_buckets = demo.rows.size();
  const RecordedRun run = recorded(demo, all);
  const Json data = data_of(to_html(demo_report(demo, 1), run, options_of(demo)));
  EXPECT_EQ(data["program"]["lines"].size(), 16u);
  EXPECT_EQ(data["program"]["lines"][4], "N50 X160");
  EXPECT_EQ(data["report"]["schema"], 1);
  EXPECT_EQ(data["report"]["alarms"][0]["number"], 3101);
  EXPECT_EQ(data["report"]["forces"], (Json{{{"name", "door_closed"}, {"value", "TRUE"}}}));
  EXPECT_EQ(data["run"]["view"], Json({"X", "Y", "Z"}));
  ASSERT_EQ(data["run"]["series"][0]["name"], "X.position");
  const std::vector<float> x = floats(data["run"]["series"][0]["low"]);
  ASSERT_EQ(x.size(), demo.rows.size());
  for (std::size_t n = 0; n < x.size(); ++n)
    ASSERT_EQ(x[n], static_cast<float>(demo.rows[n].axes[0].command));
  EXPECT_EQ(floats(data["run"]["path"]["x"]), run.path.x);
  EXPECT_EQ(data["run"]["signals"][1]["name"], "S.run");
}

TEST(Html, names_texts_and_programs_cannot_break_out_of_it) {
  const DemoRun demo = demo_run(1.0);
  Report report = demo_report(demo, 1);
  const std::string evil = "</script><script>alert(1)</script><!-- \xff\xfe &amp; \"'";
  report.alarms[0].text = report.provenance.dialect = evil;
  HtmlOptions options = options_of(demo);
  options.title = options.program_name = options.program_text = evil;
  const std::string plain = to_html(demo_report(demo, 1), recorded(demo), options_of(demo));
  const std::string html = to_html(report, recorded(demo), options);
  EXPECT_EQ(count(html, "<script"), count(plain, "<script"));
  EXPECT_EQ(count(html, "</script"), count(plain, "</script"));
  EXPECT_EQ(count(html, "<!--"), 0u);
  EXPECT_EQ(html.find('\xff'), std::string::npos);
  EXPECT_TRUE(
      data_of(html)["program"]["lines"][0].get<std::string>().starts_with("</script><script>alert(1)"));
}

TEST(Html, a_hundred_seconds_of_eight_axes_at_a_kilohertz_stay_below_five_megabytes) {
  DemoRun demo = demo_run(100.0);
  for (TraceRow& row : demo.rows)
    for (std::size_t a = 3; a < 8; ++a) row.axes[a] = row.axes[a - 3];
  demo.layout.axes = {"X", "Y", "Z", "A", "B", "C", "U", "V"};
  const RecordedRun run = recorded(demo);
  const std::string html = to_html(demo_report(demo), run, options_of(demo));
  std::cout << html.size() << " bytes for " << demo.rows.size() << " cycles of 8 axes\n";
  EXPECT_LT(html.size(), 5'000'000u);
  const Json data = data_of(html);
  RunStatistics truth(demo.layout);
  for (const TraceRow& row : demo.rows) truth.add(row);
  for (const Json& s : data["run"]["series"]) {
    if (s["name"] != "X.jerk") continue;
    float most = 0;
    for (const char* edge : {"low", "high"})
      for (const float v : floats(s[edge])) most = std::max(most, std::fabs(v));
    EXPECT_EQ(most, static_cast<float>(truth.axes()[0].max_jerk())) << "thinning may not hide an extreme";
  }
}

TEST(Html, cuts_a_listing_that_nobody_would_scroll_through_and_shows_that_it_did) {
  HtmlOptions options;
  for (int n = 1; n <= 20'500; ++n) options.program_text += "N" + std::to_string(n) + "\r\n";
  const Json lines = data_of(to_html({}, {}, options))["program"]["lines"];
  ASSERT_EQ(lines.size(), 20'001u);
  EXPECT_EQ(lines[19'999], "N20000");
  EXPECT_EQ(lines[20'000], "…");
}

TEST(Html, an_empty_run_is_still_a_page) {
  const std::string html = to_html({}, {}, {});
  EXPECT_EQ(data_of(html)["program"]["lines"].size(), 0u);
  EXPECT_NE(html.find("<title>servogate</title>"), std::string::npos);
}

Json expectations(const DemoRun& demo, const RecordedRun& run) {
  Json out{{"tolerance", 0.2},
           {"start", 0.0},
           {"card", "39.6"},
           {"samples", Json::array()},
           {"peaks", Json::object()}};
  for (std::size_t n = 300; n < demo.rows.size(); n += 1117) {
    const TraceRow& row = demo.rows[n];
    Json signals = Json::array();
    for (std::size_t s = 0; s < demo.layout.signals.size(); ++s) signals.push_back(row.signal(s));
    out["samples"].push_back({{"t", static_cast<double>(row.t_ns) * 1e-9 + 1e-4},
                              {"place", {row.axes[0].command, row.axes[1].command, row.axes[2].command}},
                              {"line", row.line},
                              {"signals", signals}});
  }
  for (const Series& s : run.series) {
    float most = 0;
    for (std::size_t n = 0; n < s.low.size(); ++n)
      most = std::max({most, std::fabs(s.low[n]), std::fabs(s.high[n])});
    out["peaks"][s.name] = most;
  }
  out["shown"] = {"door_closed = TRUE",
                  "Path speed",
                  "Velocity",
                  "Acceleration",
                  "Jerk",
                  "Following error",
                  "Spindle",
                  "S.at_speed",
                  "coolant",
                  "door_open",
                  "N120 G03",
                  "examples/mill/machine.toml",
                  "too large an error",
                  "interpolate"};
  return out;
}

TEST(Html, its_script_runs_and_reads_back_the_run_that_was_put_in) {
  if (std::system("node --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "no node here; install nodejs to run the page's script in this test";
  const Folder folder;
  const DemoRun demo = demo_run(20.0);
  RunRecorderOptions all;
  all.max_buckets = demo.rows.size();
  const RecordedRun run = recorded(demo, all);
  ASSERT_EQ(write_file(folder / "page.html", to_html(demo_report(demo, 2), run, options_of(demo))), "");
  ASSERT_EQ(write_file(folder / "expected.json", expectations(demo, run).dump()), "");
  const std::string smoke = "node " + tests::source_dir() + "/tests/report/page_smoke.js ";
  EXPECT_EQ(std::system((smoke + (folder / "page.html") + " " + (folder / "expected.json")).c_str()), 0);

  const Json nothing{{"tolerance", 0},          {"start", 0},
                     {"card", "0 s"},           {"samples", Json::array()},
                     {"peaks", Json::object()}, {"shown", Json::array()}};
  RunRecorder recorder;
  recorder.begin({});
  recorder.row({});
  recorder.end(0);
  ASSERT_EQ(write_file(folder / "page.html", to_html({}, recorder.run(), {})), "");
  ASSERT_EQ(write_file(folder / "expected.json", nothing.dump()), "");
  EXPECT_EQ(std::system((smoke + (folder / "page.html") + " " + (folder / "expected.json")).c_str()), 0)
      << "a run of one cycle without axes, signals and program";
}

TEST(WriteFile, leaves_no_half_file_behind) {
  const Folder folder;
  EXPECT_EQ(write_file(folder / "a.html", "content"), "");
  EXPECT_TRUE(std::filesystem::exists(folder / "a.html"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.html.part"));
  const std::string said = write_file("/nowhere/a.html", "x");
  EXPECT_EQ(text::in_language(said, text::Language::english),
            "/nowhere/a.html: cannot create: No such file or directory");
  EXPECT_EQ(text::in_language(said, text::Language::russian),
            "/nowhere/a.html: не создаётся: нет такого файла или каталога");
}

TEST(WriteFile, makes_the_file_that_a_link_leads_to_and_keeps_the_link) {
  const Folder folder;
  std::filesystem::create_symlink("behind.html", folder / "link.html");
  for (const char* content : {"first", "second"}) {
    EXPECT_EQ(write_file(folder / "link.html", content), "");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.html"));
    std::ifstream file(folder / "behind.html");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), content);
  }
}

}  // namespace
}  // namespace servogate::report
