// SPDX-License-Identifier: Apache-2.0
// Captures: what is kept around a trigger, and the files that hold it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "report/capture/capture_recorder.hpp"
#include "report/capture/csv_capture.hpp"
#include "report/capture/mcap_capture.hpp"
#include "report/capture/mcap_reader.hpp"
#include "tests/places/places.hpp"
#include "tests/property_seed.hpp"

namespace servogate::report {
namespace {

/// A folder that goes with the test.
class Scratch {
 public:
  Scratch() : folder_(std::filesystem::temp_directory_path() / "servogate-capture-XXXXXX") {
    std::string name = folder_.string();
    folder_ = mkdtemp(name.data());
  }
  ~Scratch() { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

CaptureLayout layout() {
  CaptureLayout l;
  l.channels = {{"X.command", "mm", "/axis/X", "command"},
                {"X.actual", "mm", "/axis/X", "actual"},
                {"door_open", "", "/places", "door_open"},
                {"Mill.count", "", "/plc", "Mill.count"}};
  l.buses = {"can", "second"};
  l.origin = {{"machine", "mill, the \"old\" one"}};
  return l;
}

/// Everything that a sink is given.
struct Kept final : CaptureSink {
  CaptureLayout layout;
  std::vector<std::pair<image::Nanoseconds, std::vector<double>>> rows;
  std::vector<CaptureFrame> frames;
  std::vector<std::pair<image::Nanoseconds, std::string>> notes;
  bool begun = false, ended = false;
  void begin(const CaptureLayout& l) override {
    layout = l;
    begun = true;
  }
  void row(image::Nanoseconds t, std::span<const double> v) override {
    rows.push_back({t, {v.begin(), v.end()}});
  }
  void frame(const CaptureFrame& f) override { frames.push_back(f); }
  void note(image::Nanoseconds t, const std::string& text) override { notes.emplace_back(t, text); }
  void end() override { ended = true; }
};

/// A sink that outlives the capture which writes into it.
struct Into final : CaptureSink {
  explicit Into(Kept& to) : kept(to) {}
  Kept& kept;
  void begin(const CaptureLayout& l) override { kept.begin(l); }
  void row(image::Nanoseconds t, std::span<const double> v) override { kept.row(t, v); }
  void frame(const CaptureFrame& f) override { kept.frame(f); }
  void note(image::Nanoseconds t, const std::string& text) override { kept.note(t, text); }
  void end() override { kept.end(); }
};

image::Nanoseconds ms(long long n) { return n * image::kMillisecond; }

CaptureFrame frame(image::Nanoseconds t, std::uint32_t id) {
  CaptureFrame f;
  f.t_ns = t;
  f.frame.id = id;
  f.frame.length = 2;
  f.frame.data[0] = 0xAB;
  f.frame.data[1] = 0x01;
  return f;
}

/// Runs `cycles` rows through a capture; X.actual is the number of the row. The files that came of it.
std::vector<Kept> run(CaptureSettings settings, int cycles, const std::function<bool(int)>& open_door) {
  std::vector<Kept> files(16);
  int made = 0;
  Capture capture(layout(), settings, [&](int number) {
    made = number;
    return std::make_unique<Into>(files[static_cast<std::size_t>(number - 1)]);
  });
  for (int n = 0; n < cycles; ++n) {
    capture.frame(frame(ms(n), static_cast<std::uint32_t>(n % 0x7FF)));
    const double row[] = {0.5 * n, 1.0 * n, open_door(n) ? 1.0 : 0.0, -1.0};
    capture.row(ms(n), row);
  }
  capture.end();
  files.resize(static_cast<std::size_t>(made));
  return files;
}

TEST(Trigger, is_read_from_a_condition) {
  const auto t = parse_trigger(" X.error >= 0.05 ");
  ASSERT_TRUE(t);
  EXPECT_EQ(t->channel, "X.error");
  EXPECT_EQ(t->compare, Trigger::Compare::greater_equal);
  EXPECT_EQ(t->value, 0.05);
  EXPECT_EQ(parse_trigger("door=TRUE")->value, 1.0);
  EXPECT_EQ(parse_trigger("SK200!=3")->compare, Trigger::Compare::not_equal);
  EXPECT_EQ(parse_trigger("alarm")->compare, Trigger::Compare::rises);
  for (const char* wrong : {"", "X", "X >", "> 3", "X > three", "X > 3 mm", "X ! 3", "X > nan"})
    EXPECT_FALSE(parse_trigger(wrong)) << wrong;
}

TEST(Capture, without_a_trigger_holds_every_row_and_frame) {
  const auto files = run({}, 3000, [](int) { return false; });
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].rows.size(), 3000u);
  EXPECT_EQ(files[0].frames.size(), 2999u) << "the first one came before the first row";
  EXPECT_TRUE(files[0].ended);
}

TEST(Capture, holds_the_time_before_and_behind_its_trigger_and_nothing_else) {
  const auto files =
      run({parse_trigger("door_open > 0"), 0.1, 0.05, 1}, 3000, [](int n) { return n >= 1000 && n < 1010; });
  ASSERT_EQ(files.size(), 1u);
  const Kept& f = files[0];
  ASSERT_EQ(f.rows.size(), 100u + 1 + 50);
  for (std::size_t n = 0; n < f.rows.size(); ++n) {
    EXPECT_EQ(f.rows[n].first, ms(900 + static_cast<int>(n)));
    EXPECT_EQ(f.rows[n].second[1], 900.0 + static_cast<double>(n)) << "no row is lost, none comes twice";
  }
  ASSERT_EQ(f.notes.size(), 1u);
  EXPECT_EQ(f.notes[0].first, ms(1000));
  EXPECT_EQ(f.notes[0].second, "door_open > 0");
  EXPECT_EQ(f.frames.front().t_ns, ms(900));
  EXPECT_EQ(f.frames.back().t_ns, ms(1051)) << "the frames of the cycle that ends it came before its row";
}

TEST(Capture, of_a_trigger_in_the_first_cycles_begins_with_the_first_cycle) {
  const auto files = run({parse_trigger("door_open > 0"), 1.0, 0.01, 1}, 300, [](int n) { return n == 5; });
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].rows.front().first, 0);
  EXPECT_EQ(files[0].rows.size(), 16u);
}

TEST(Capture, that_fires_again_meanwhile_is_longer_and_later_makes_another_file_up_to_their_number) {
  const auto fires = [](int n) { return n == 1000 || n == 1030 || n == 1500 || n == 2000; };
  const auto files = run({parse_trigger("door_open > 0"), 0.02, 0.05, 2}, 3000, fires);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].rows.front().first, ms(980));
  EXPECT_EQ(files[0].rows.back().first, ms(1080));
  EXPECT_EQ(files[0].notes.size(), 2u);
  EXPECT_EQ(files[1].rows.front().first, ms(1480));
  EXPECT_EQ(files[1].rows.back().first, ms(1550));
}

TEST(Capture, of_a_second_trigger_soon_behind_the_first_file_has_the_frames_of_the_time_before_it) {
  const auto fires = [](int n) { return n == 1000 || n == 1060; };
  const auto files = run({parse_trigger("door_open > 0"), 0.05, 0.05, 2}, 3000, fires);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[1].rows.front().first, ms(1010));
  EXPECT_EQ(files[1].frames.front().t_ns, ms(1010));
}

TEST(Capture, names_its_trigger_however_small_it_is) {
  const auto files =
      run({parse_trigger("door_open > 1e-07"), 0.01, 0.01, 1}, 200, [](int n) { return n == 100; });
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].notes[0].second, "door_open > 1e-07");
}

TEST(Capture, that_stands_at_its_trigger_from_the_begin_fires_once) {
  const auto files = run({parse_trigger("door_open = 1"), 0.02, 0.01, 9}, 500, [](int) { return true; });
  EXPECT_EQ(files.size(), 1u);
}

TEST(Capture, carries_rows_over_to_its_thread_without_loss_and_in_the_order_of_time) {
  Kept kept;
  auto capture = std::make_unique<Capture>(layout(), CaptureSettings{},
                                           [&](int) { return std::make_unique<Into>(kept); });
  CaptureRecorder recorder(std::move(capture), 128);
  constexpr int kRows = 20000;
  for (int n = 0; n < kRows; ++n) {
    recorder.wait_for_room();
    recorder.frame(frame(ms(n), 1));
    const std::span<double> slot = recorder.slot();
    ASSERT_EQ(slot.size(), 4u);
    for (std::size_t c = 0; c < 4; ++c) slot[c] = n + 0.25 * static_cast<double>(c);
    recorder.commit(ms(n));
  }
  EXPECT_EQ(recorder.close(), "");
  EXPECT_EQ(recorder.lost(), 0u);
  ASSERT_EQ(kept.rows.size(), static_cast<std::size_t>(kRows));
  ASSERT_EQ(kept.frames.size(), static_cast<std::size_t>(kRows) - 1);
  for (int n = 0; n < kRows; ++n) {
    const auto& [t, values] = kept.rows[static_cast<std::size_t>(n)];
    ASSERT_EQ(t, ms(n));
    ASSERT_EQ(values[3], n + 0.75);
  }
}

TEST(Capture, whose_queue_is_full_counts_what_it_loses) {
  Kept kept;
  auto capture = std::make_unique<Capture>(layout(), CaptureSettings{},
                                           [&](int) { return std::make_unique<Into>(kept); });
  CaptureRecorder recorder(std::move(capture), 4);
  std::uint64_t refused = 0;
  for (int n = 0; n < 100000; ++n) {
    if (const auto slot = recorder.slot(); slot.empty()) {
      ++refused;
      continue;
    }
    recorder.commit(ms(n));
  }
  recorder.close();
  EXPECT_EQ(recorder.lost(), refused);
  EXPECT_EQ(kept.rows.size() + refused, 100000u);
}

/// Random numbers with everything that numbers can be.
double any_number(std::mt19937_64& random) {
  switch (random() % 5) {
    case 0:
      return static_cast<double>(static_cast<std::int64_t>(random() % 2001)) - 1000.0;
    case 1:
      return std::ldexp(static_cast<double>(random() % 1'000'000'007), -30);
    case 2:
      return std::numeric_limits<double>::quiet_NaN();
    case 3:
      return static_cast<double>(random() % 2);
    default:
      return std::ldexp(1.0 + static_cast<double>(random()) * 5e-20, static_cast<int>(random() % 600) - 300);
  }
}

/// Writes a capture of random values with frames and notes.
void write_random(CaptureSink& sink, std::uint64_t seed, int rows) {
  std::mt19937_64 random(seed);
  sink.begin(layout());
  for (int n = 0; n < rows; ++n) {
    std::vector<double> values(4);
    for (double& v : values) v = any_number(random);
    sink.row(ms(n), values);
    for (unsigned k = static_cast<unsigned>(random() % 3); k > 0; --k) {
      CaptureFrame f = frame(ms(n) + static_cast<image::Nanoseconds>(random() % 1000000), 0);
      f.bus = static_cast<int>(random() % 2);
      f.frame.extended = random() % 2 != 0;
      f.frame.id = static_cast<std::uint32_t>(random() % (f.frame.extended ? 0x20000000 : 0x800));
      f.frame.fd = random() % 4 == 0;
      f.frame.length = static_cast<std::uint8_t>(random() % (f.frame.fd ? 65 : 9));
      for (std::uint8_t& byte : f.frame.data) byte = static_cast<std::uint8_t>(random());
      sink.frame(f);
    }
    if (random() % 100 == 0) sink.note(ms(n), "note \"" + std::to_string(n) + "\", ось X");
  }
  sink.end();
}

TEST(Mcap, is_read_again_as_it_was_written) {
  const std::uint64_t seed = servogate::test::property_seed();
  const Scratch scratch;
  Kept expected;
  write_random(expected, seed, 20000);
  McapCapture out(scratch.path("a.mcap"));
  write_random(out, seed, 20000);
  ASSERT_EQ(out.error(), "");
  EXPECT_GT(std::filesystem::file_size(scratch.path("a.mcap")), std::size_t{3} << 20) << "several chunks";
  Kept read;
  ASSERT_FALSE(read_mcap(scratch.path("a.mcap"), read));
  EXPECT_TRUE(read.ended);
  EXPECT_EQ(read.layout.channels, expected.layout.channels);
  EXPECT_EQ(read.layout.buses, expected.layout.buses);
  EXPECT_EQ(read.layout.origin, expected.layout.origin);
  EXPECT_EQ(read.layout.period_ns, expected.layout.period_ns);
  EXPECT_EQ(read.notes, expected.notes);
  ASSERT_EQ(read.rows.size(), expected.rows.size());
  for (std::size_t n = 0; n < read.rows.size(); ++n) {
    ASSERT_EQ(read.rows[n].first, expected.rows[n].first);
    for (std::size_t c = 0; c < 4; ++c) {
      const double a = read.rows[n].second[c], b = expected.rows[n].second[c];
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << n << ' ' << c << ' ' << a << ' ' << b;
    }
  }
  ASSERT_EQ(read.frames.size(), expected.frames.size());
  for (std::size_t n = 0; n < read.frames.size(); ++n) {
    const CaptureFrame &a = read.frames[n], &b = expected.frames[n];
    ASSERT_TRUE(a.t_ns == b.t_ns && a.bus == b.bus && a.frame.id == b.frame.id &&
                a.frame.extended == b.frame.extended && a.frame.fd == b.frame.fd &&
                a.frame.length == b.frame.length &&
                std::equal(a.frame.data.begin(), a.frame.data.begin() + a.frame.length, b.frame.data.begin()))
        << n;
  }
}

TEST(Mcap, becomes_the_same_csv_as_a_capture_that_was_written_as_csv) {
  const std::uint64_t seed = servogate::test::property_seed();
  const Scratch scratch;
  McapCapture mcap(scratch.path("a.mcap"));
  write_random(mcap, seed, 500);
  CsvCapture csv(scratch.path("a.csv")), from(scratch.path("b.csv"));
  write_random(csv, seed, 500);
  ASSERT_FALSE(read_mcap(scratch.path("a.mcap"), from));
  EXPECT_EQ(csv.error() + from.error() + mcap.error(), "");
  for (const char* suffix : {"", ".frames.csv", ".notes.csv"}) {
    EXPECT_FALSE(content(scratch.path(std::string("a.csv") + suffix)).empty());
    EXPECT_EQ(content(scratch.path(std::string("a.csv") + suffix)),
              content(scratch.path(std::string("b.csv") + suffix)))
        << suffix;
  }
  EXPECT_EQ(content(scratch.path("a.csv")).substr(0, 43), "t,X.command,X.actual,door_open,Mill.count\n0");
}

/// What a reader of this folder, which shares no code, prints of a file.
void read_by(const char* reader, const Scratch& scratch, const char* file, const std::string& more,
             std::istringstream& printed) {
  const std::string command = "/usr/bin/python3 '" + tests::source_dir() + "/tests/report/" + reader + "' '" +
                              scratch.path(file) + "' " + more + " >'" + scratch.path("out") + "' 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << content(scratch.path("out"));
  printed.str(content(scratch.path("out")));
}

TEST(Mcap, is_read_by_its_index_by_a_reader_that_shares_no_code) {
  const Scratch scratch;
  McapCapture out(scratch.path("a.mcap"));
  Kept expected;
  write_random(out, 7, 8000);
  write_random(expected, 7, 8000);
  std::istringstream lines;
  ASSERT_NO_FATAL_FAILURE(read_by("read_mcap.py", scratch, "a.mcap", "/axis/X", lines));
  std::string line;
  std::size_t n = 0;
  for (; std::getline(lines, line); ++n) {
    ASSERT_LT(n, expected.rows.size());
    long long t = 0;
    char value[64] = {};
    ASSERT_EQ(std::sscanf(line.c_str(), "%lld command=%63s", &t, value), 2) << line;
    ASSERT_EQ(t, expected.rows[n].first);
    const double command_ = expected.rows[n].second[0];
    if (std::isnan(command_))
      ASSERT_STREQ(value, "None");
    else
      ASSERT_EQ(std::strtod(value, nullptr), command_);
  }
  EXPECT_EQ(n, expected.rows.size());
}

TEST(Csv, is_read_by_a_reader_that_shares_no_code) {
  const Scratch scratch;
  CsvCapture out(scratch.path("a.csv"));
  Kept expected;
  write_random(out, 11, 3000);
  write_random(expected, 11, 3000);
  std::istringstream rows;
  ASSERT_NO_FATAL_FAILURE(read_by("read_csv.py", scratch, "a.csv", "", rows));
  std::size_t n = 0;
  for (long long t = 0; rows >> t; ++n) {
    ASSERT_LT(n, expected.rows.size());
    ASSERT_EQ(t, expected.rows[n].first - expected.rows[0].first);
    for (std::size_t c = 0; c < 4; ++c) {
      std::string cell;
      rows >> cell;
      const double read = std::strtod(cell.c_str(), nullptr), wrote = expected.rows[n].second[c];
      ASSERT_TRUE(read == wrote || (std::isnan(read) && std::isnan(wrote)))
          << n << ' ' << c << ' ' << cell << ' ' << wrote;
    }
  }
  EXPECT_EQ(n, expected.rows.size());
}

TEST(Mcap, that_was_cut_off_or_changed_is_read_as_far_as_it_is_sound) {
  const std::uint64_t seed = servogate::test::property_seed();
  const Scratch scratch;
  Kept expected;
  write_random(expected, seed, 6000);
  McapCapture out(scratch.path("a.mcap"));
  write_random(out, seed, 6000);
  const std::string whole = content(scratch.path("a.mcap"));
  std::mt19937_64 random(seed);
  int refused = 0;
  for (int k = 0; k < 60; ++k) {
    std::string damaged = whole;
    if (k % 2 == 0)
      damaged.resize(random() % whole.size());
    else
      damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    std::ofstream(scratch.path("b.mcap"), std::ios::binary) << damaged;
    Kept read;
    const auto problem = read_mcap(scratch.path("b.mcap"), read);
    refused += problem ? 1 : 0;
    ASSERT_LE(read.rows.size(), expected.rows.size());
    EXPECT_EQ(read.begun, read.ended);
  }
  EXPECT_GT(refused, 30) << "all that were cut off, and most that were changed";
}

TEST(Mcap, that_is_none_says_so) {
  const Scratch scratch;
  Kept read;
  EXPECT_EQ(read_mcap(scratch.path("absent"), read)->entry->id, "capture.no-file");
  std::ofstream(scratch.path("text")) << "t,X\n0,1\n";
  EXPECT_EQ(read_mcap(scratch.path("text"), read)->entry->id, "capture.not-mcap");
  EXPECT_FALSE(read.begun);
}

TEST(CaptureFile, that_cannot_be_written_says_why) {
  McapCapture mcap("/nowhere/a.mcap");
  write_random(mcap, 1, 10);
  EXPECT_NE(mcap.error(), "");
  CsvCapture csv("/nowhere/a.csv");
  write_random(csv, 1, 10);
  EXPECT_NE(csv.error(), "");
}

}  // namespace
}  // namespace servogate::report
