// SPDX-License-Identifier: Apache-2.0
#include "report/html.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

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

std::string bytes_of(const std::string& base64) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string packed, out(1 << 24, '\0');
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : base64) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((count += 6) >= 8) packed += static_cast<char>(bits >> (count -= 8));
  }
  z_stream stream{};
  inflateInit2(&stream, -MAX_WBITS);
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

/// A column as it was before it was packed.
std::vector<double> numbers(const Json& column) {
  const std::string bytes = bytes_of(column["d"]);
  const int order = column["o"];
  std::vector<double> out;
  std::int64_t sums[3] = {};
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint64_t bits = 0;
    int shift = 0;
    do {
      bits |= std::uint64_t{static_cast<unsigned char>(bytes[at]) & 0x7Fu} << shift;
      shift += 7;
    } while (static_cast<unsigned char>(bytes[at++]) & 0x80u);
    std::int64_t value = static_cast<std::int64_t>(bits >> 1) ^ -static_cast<std::int64_t>(bits & 1);
    for (int k = order - 1; k >= 0; --k) value = sums[k] += value;
    out.push_back(static_cast<double>(value) * column["q"].get<double>());
  }
  EXPECT_EQ(out.size(), column["n"].get<std::size_t>());
  return out;
}

std::vector<std::string> lines_of(const Json& data) {
  std::istringstream text(bytes_of(data["program"]["text"]));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// The page without what others wrote.
std::string own_part(std::string html) {
  const std::size_t from = html.find("<script id=\"libraries\">"), to = html.find("</script>", from);
  return html.erase(from, to - from);
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
    EXPECT_EQ(own_part(html).find(outside), std::string::npos) << outside;
  // What others wrote asks for nothing either, and a browser would refuse it.
  EXPECT_NE(html.find("content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                      "img-src data: blob:\""),
            std::string::npos);
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(html.ends_with("</html>\n"));
}

TEST(Html, libraries_are_the_files_whose_hashes_stand_beside_them_and_their_licences_are_in_the_page) {
  const std::string folder = tests::source_dir() + "/report/page/vendor/";
  std::ifstream sums(folder + "SHA256SUMS");
  int files = 0;
  for (std::string hash, name; sums >> hash >> name; ++files)
    EXPECT_EQ(sha256_of_file(folder + name), hash) << name << ": ./renew writes both";
  EXPECT_EQ(files, 3);
  const std::string html = to_html({}, {}, {});
  for (const char* part :
       {"three.js authors", "Leon Sorokin", "Permission is hereby granted, free of charge"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

TEST(Html, carries_the_run_the_report_and_the_program) {
  const DemoRun demo = demo_run(5.0);
  RunRecorderOptions all;
  all.max_buckets = demo.rows.size();
  const RecordedRun run = recorded(demo, all);
  const Json data = data_of(to_html(demo_report(demo, 1), run, options_of(demo)));
  ASSERT_EQ(lines_of(data).size(), 16u);
  EXPECT_EQ(lines_of(data)[4], "N50 X160");
  EXPECT_EQ(data["report"]["en"]["schema"], 1);
  EXPECT_EQ(data["report"]["ru"]["alarms"][0]["number"], 3101);
  EXPECT_EQ(data["report"]["en"]["forces"], (Json{{{"name", "door_closed"}, {"value", "TRUE"}}}));
  EXPECT_EQ(data["run"]["view"], Json({"X", "Y", "Z"}));
  ASSERT_EQ(data["run"]["series"][0]["name"], "X.position");
  const std::vector<double> x = numbers(data["run"]["series"][0]["low"]);
  ASSERT_EQ(x.size(), demo.rows.size());
  for (std::size_t n = 0; n < x.size(); ++n) ASSERT_NEAR(x[n], demo.rows[n].axes[0].command, 2e-4);
  const std::vector<double> along = numbers(data["run"]["path"]["x"]);
  ASSERT_EQ(along.size(), run.path.x.size());
  for (std::size_t n = 0; n < along.size(); ++n) ASSERT_NEAR(along[n], run.path.x[n], 1e-5);
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
  EXPECT_TRUE(lines_of(data_of(html)).at(0).starts_with("</script><script>alert(1)"));
}

TEST(Html, a_hundred_seconds_of_eight_axes_at_a_kilohertz_stay_below_six_megabytes) {
  DemoRun demo = demo_run(100.0);
  for (TraceRow& row : demo.rows)
    for (std::size_t a = 3; a < 8; ++a) row.axes[a] = row.axes[a - 3];
  demo.layout.axes = {"X", "Y", "Z", "A", "B", "C", "U", "V"};
  const RecordedRun run = recorded(demo);
  const std::string html = to_html(demo_report(demo), run, options_of(demo));
  std::cout << html.size() << " bytes for " << demo.rows.size() << " cycles of 8 axes\n";
  EXPECT_LT(html.size(), 6'000'000u);
  const Json data = data_of(html);
  RunStatistics truth(demo.layout);
  for (const TraceRow& row : demo.rows) truth.add(row);
  for (const Json& s : data["run"]["series"]) {
    if (s["name"] != "X.jerk") continue;
    double most = 0;
    for (const char* edge : {"low", "high"})
      for (const double v : numbers(s[edge])) most = std::max(most, std::fabs(v));
    EXPECT_NEAR(most, truth.axes()[0].max_jerk(), 2e-6 * most) << "thinning may not hide an extreme";
  }
}

TEST(Html, cuts_a_listing_that_nobody_would_scroll_through_and_shows_that_it_did) {
  HtmlOptions options;
  for (int n = 1; n <= 200'500; ++n) options.program_text += "N" + std::to_string(n) + "\r\n";
  const std::vector<std::string> lines = lines_of(data_of(to_html({}, {}, options)));
  ASSERT_EQ(lines.size(), 200'001u);
  EXPECT_EQ(lines[199'999], "N200000\r");
  EXPECT_EQ(lines[200'000], "…");
}

TEST(Html, an_empty_run_is_still_a_page) {
  const std::string html = to_html({}, {}, {});
  EXPECT_EQ(lines_of(data_of(html)).size(), 0u);
  EXPECT_NE(html.find("<title>servogate</title>"), std::string::npos);
}

/// Single cycles, by differences of what was put in, and bands of 256 ms, a whole number of the parts that a
/// page keeps.
void cycles_expected(Json& out, const DemoRun& demo) {
  out["cycles"] = Json::array();
  for (const std::size_t n : {600u, 3300u, 8192u, 8193u, 9001u, 17'000u}) {
    const auto x = [&](std::size_t back) { return demo.rows[n - back].axes[0].command; };
    const double t = demo.layout.period_ns * 1e-9;
    out["cycles"].push_back({{"t", static_cast<double>(demo.rows[n].t_ns) * 1e-9},
                             {"values",
                              {{"X.position", x(0)},
                               {"X.velocity", (x(0) - x(1)) / t},
                               {"X.acceleration", (x(0) - 2 * x(1) + x(2)) / t / t},
                               {"X.jerk", (x(0) - 3 * x(1) + 3 * x(2) - x(3)) / t / t / t},
                               {"Y.error", demo.rows[n].axes[1].following_error},
                               {"path.speed", demo.rows[n].feed_mm_s},
                               {"spindle.act", demo.rows[n].spindles[0].actual_rpm}}}});
  }
  Json low = Json::array(), high = Json::array();
  for (std::size_t n = 0; n + 256 <= demo.rows.size(); n += 256) {
    const auto [least, most] =
        std::minmax_element(demo.rows.begin() + static_cast<std::ptrdiff_t>(n),
                            demo.rows.begin() + static_cast<std::ptrdiff_t>(n + 256),
                            [](const TraceRow& a, const TraceRow& b) { return a.feed_mm_s < b.feed_mm_s; });
    low.push_back(least->feed_mm_s);
    high.push_back(most->feed_mm_s);
  }
  out["band"] = {{"name", "path.speed"}, {"low", low}, {"high", high}, {"size", 500}};
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
  double deviation = 0.0;
  for (std::size_t n = 0; n < run.path.x.size(); ++n)
    if (run.path.rapid[n] == 0) deviation = std::max(deviation, double{run.path.deviation[n]});
  out["deviation"] = deviation;
  out["tools"] = {1, 2};
  out["russian"] = {"2,6 мкм",          "1,5001 мм",    "со слишком большой ошибкой",
                    "не зажата ли ось", "интерполяция", "логика (ПЛК)"};
  out["english"] = {"too large an error", "a blocked axis", "interpolate"};
  out["shown"] = {"door_closed = TRUE",
                  "−20.0000 mm",
                  "2.6 µm",
                  "1.3 µm",
                  "1.5001 mm",
                  "594 … 606 rpm",
                  "−2.3 … 4.1 µm",
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
  const DemoRun second = demo_run(12.0);
  ASSERT_EQ(
      write_file(folder / "other.html", to_html(demo_report(second), recorded(second), options_of(second))),
      "");
  const std::string smoke = "node " + tests::source_dir() + "/tests/report/page_smoke.js ";
  EXPECT_EQ(std::system((smoke + (folder / "page.html") + " " + (folder / "expected.json") + " " +
                         (folder / "other.html"))
                            .c_str()),
            0);

  // In a page of usual size charts begin with bands, and single cycles come when somebody zooms in.
  Json close{{"tolerance", 0},         {"start", 0},
             {"card", "39.6"},         {"samples", Json::array()},
             {"shown", Json::array()}, {"peaks", Json::object()}};
  cycles_expected(close, demo);
  ASSERT_EQ(write_file(folder / "page.html", to_html(demo_report(demo, 2), recorded(demo), options_of(demo))),
            "");
  ASSERT_EQ(write_file(folder / "expected.json", close.dump()), "");
  EXPECT_EQ(std::system((smoke + (folder / "page.html") + " " + (folder / "expected.json")).c_str()), 0);

  // A lathe: Z to the right, X up; people read diameters.
  RunRecorderOptions lathe;
  lathe.view_axes = {2, 0, -1};
  Report turned = demo_report(demo);
  turned.axes[0].diameter = true;
  const Json diameters{{"tolerance", 0},          {"start", 0},
                       {"card", "No alarms"},     {"samples", Json::array()},
                       {"peaks", Json::object()}, {"shown", {"X⌀ 0 … 320 mm", "X is a diameter"}}};
  ASSERT_EQ(write_file(folder / "page.html", to_html(turned, recorded(demo, lathe), options_of(demo))), "");
  ASSERT_EQ(write_file(folder / "expected.json", diameters.dump()), "");
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
