// SPDX-License-Identifier: Apache-2.0
#include "machine/state/state.hpp"
#include "machine/load.hpp"
#include "machine/state/state_lock.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>

#include "machine/state/state_text.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

constexpr StatePart kParts[] = {StatePart::origins,  StatePart::tools, StatePart::homing,
                                StatePart::counters, StatePart::gains, StatePart::records,
                                StatePart::retained};

bool same(const MachineState& a, const MachineState& b) {
  return a.tables == b.tables && a.homing == b.homing && a.counters == b.counters && a.gains == b.gains &&
         a.tool_in_spindle == b.tool_in_spindle && a.retained == b.retained;
}

MachineState sample() {
  MachineState s;
  s.tables.origins = {
      {0, {{"X", 0.0}, {"Y", -0.1}}}, {1, {{"X", 100.123456789012}, {"Z", 1.0 / 3.0}}}, {12, {}}};
  s.tables.correctors[1] = {"face \"mill\"", {{"Z", 120.5}}, {{"Z", -0.02}}, 10.0, 0.01, {}, 0.0, 0};
  s.tables.correctors[99] = {"", {{"X", -3.25}, {"Z", 1e-9}}, {}, 0.4, 0.0, {}, 0.0, 3};
  s.tables.record_files["PTS"] = {
      {{image::Format::ch, 4}, {image::Format::lr}, {image::Format::in}},
      20,
      {{1, {{0.0, "X\xFF\"\n"}, {1.0 / 3.0, ""}, {-7.0, ""}}}, {20, {{0.0, ""}, {1e-300, ""}, {0.0, ""}}}}};
  s.homing["X"] = {true, -123456789012345, 3.25};
  s.homing["Z"] = {};
  s.counters = {{"power_on_s", 86400}, {"X.distance_mm", 9007199254740993}, {"parts", 0}};
  s.gains = {{"X.position_gain", 33.5}};
  s.tool_in_spindle = 7;
  s.retained = {{"Mill.count", "DINT", "-5"}, {"Mill.text", "STRING", "\"a\\\"b\\\\ Ж\x01\""}};
  return s;
}

MachineState random_state(std::mt19937_64& random) {
  const auto number = [&] {
    double value = 0.0;
    do {
      const std::uint64_t bits = random();
      std::memcpy(&value, &bits, sizeof value);
    } while (!std::isfinite(value));
    return value;
  };
  const auto name = [&] {
    std::string out;
    for (std::size_t i = random() % 8 + 1; i > 0; --i) out += static_cast<char>(1 + random() % 126);
    return out;
  };
  MachineState s;
  for (std::size_t i = random() % 4; i > 0; --i)
    s.tables.origins[static_cast<int>(random() % 100)][name()] = number();
  for (std::size_t i = random() % 4; i > 0; --i)
    s.tables.correctors[static_cast<int>(random() % 300)] = {
        name(),   {{name(), number()}}, {{name(), number()}}, std::abs(number()),
        number(), {{name(), number()}}, std::abs(number()),   static_cast<int>(random() % 10)};
  for (std::size_t i = random() % 4; i > 0; --i) {
    program::RecordFile& file = s.tables.record_files[name()];
    file = {{{image::Format::ch, 8}, {image::Format::re}}, 30, {}};
    for (std::size_t n = random() % 4; n > 0; --n)
      file.records[1 + static_cast<int>(random() % 30)] = {{0.0, name()}, {number(), ""}};
  }
  for (std::size_t i = random() % 4; i > 0; --i)
    s.homing[name()] = {random() % 2 == 0, static_cast<std::int64_t>(random()), number()};
  for (std::size_t i = random() % 4; i > 0; --i) s.counters[name()] = static_cast<std::int64_t>(random());
  for (std::size_t i = random() % 4; i > 0; --i) s.gains[name()] = number();
  s.tool_in_spindle = static_cast<std::int32_t>(random() % 1000);
  for (std::size_t i = random() % 4; i > 0; --i) s.retained.push_back({name(), name(), name()});
  return s;
}

TEST(StateDirectory, gives_back_what_was_saved) {
  const StateDirectory directory(test::scratch("round") + "/state");
  std::string error;
  ASSERT_TRUE(directory.save_all(sample(), error)) << error;
  ASSERT_TRUE(directory.save(sample(), StatePart::retained, error)) << error;
  const StateDirectory::Loaded loaded = directory.load();
  EXPECT_TRUE(loaded.findings.empty()) << test::lines_of(loaded.findings, text::Language::english);
  EXPECT_TRUE(same(loaded.state, sample()));
}

TEST(StateDirectory, gives_back_any_state_bit_for_bit) {
  std::mt19937_64 random(20240612);
  for (int i = 0; i < 300; ++i) {
    const MachineState saved = random_state(random);
    MachineState read;
    for (const StatePart part : kParts) {
      const auto findings = read_part(write_part(saved, part), "s.toml", part, read);
      ASSERT_TRUE(findings.empty()) << i << test::lines_of(findings, text::Language::english)
                                    << write_part(saved, part);
    }
    ASSERT_TRUE(same(saved, read)) << i;
  }
}

TEST(StateDirectory, an_empty_or_missing_one_is_no_finding) {
  const StateDirectory::Loaded loaded = StateDirectory(test::scratch("empty") + "/none").load();
  EXPECT_TRUE(loaded.findings.empty());
  EXPECT_TRUE(same(loaded.state, MachineState{}));
}

TEST(StateDirectory, belongs_to_its_owner_only) {
  const std::string path = test::scratch("owner") + "/state";
  const StateDirectory directory(path);
  std::string error;
  ASSERT_TRUE(directory.save(sample(), StatePart::tools, error)) << error;
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0700u);
  ASSERT_EQ(::stat(directory.file(StatePart::tools).c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600u);
}

TEST(StateDirectory, files_are_readable_by_people) {
  const auto body = [](StatePart part) {
    const std::string text = write_part(sample(), part);
    return text.substr(text.find('\n') + 1);
  };
  EXPECT_EQ(body(StatePart::tools),
            "schema = 1\npart = \"tools\"\n"
            "# Lengths by axis, radius and wear in mm; wear is added. Edit it while the control is down.\n"
            "tool_in_spindle = 7\n\n"
            "[[tool]]\nnumber = 1\nname = \"face \\\"mill\\\"\"\nlength = { Z = 120.5 }\nradius = 10.0\n"
            "wear = { Z = -0.02 }\nradius_wear = 0.01\n\n"
            "[[tool]]\nnumber = 99\nlength = { X = -3.25, Z = 1e-09 }\nradius = 0.4\nquadrant = 3\n# end\n");
  EXPECT_NE(
      body(StatePart::origins).find("[origins]\n0 = { X = 0.0, Y = -0.1 }\n1 = { X = 100.123456789012, "),
      std::string::npos)
      << body(StatePart::origins);
}

/// Cut at every byte, alone in its folder: an error with its place and an empty part, never half a table.
TEST(StateDirectory, a_file_cut_at_any_byte_is_an_error_without_a_generation_before) {
  for (const StatePart part : kParts) {
    const std::string whole = write_part(sample(), part);
    // Without its last line feed alone a table is whole.
    const std::size_t most = whole.size() - (edited_by_people(part) ? 1 : 0);
    for (std::size_t n = 0; n < most; ++n) {
      MachineState state;
      const auto findings = read_part(whole.substr(0, n), "s.toml", part, state);
      ASSERT_FALSE(findings.empty()) << part_name(part) << " " << n;
      ASSERT_EQ(findings[0].severity, text::Severity::error) << n;
      ASSERT_GE(findings[0].line, 1);
      ASSERT_TRUE(same(state, MachineState{})) << n;
    }
  }
}

TEST(StateDirectory, any_flipped_bit_is_found) {
  std::mt19937_64 random(20240613);
  for (const StatePart part : kParts) {
    const std::string whole = write_part(sample(), part);
    for (int i = 0; i < 400; ++i) {
      std::string text = whole;
      text[random() % text.size()] ^= static_cast<char>(1u << (random() % 8));
      MachineState state;
      const auto findings = read_part(text, "s.toml", part, state);
      ASSERT_FALSE(findings.empty()) << text;
      // Of origins and tools it may be an edit, which is said.
      if (edited_by_people(part) && findings[0].severity == text::Severity::warning) continue;
      ASSERT_EQ(findings[0].severity, text::Severity::error) << text;
      ASSERT_TRUE(same(state, MachineState{}));
    }
  }
}

TEST(StateDirectory, takes_the_generation_before_when_the_newest_is_cut_anywhere) {
  const StateDirectory directory(test::scratch("generation"));
  MachineState old = sample(), fresh = sample();
  fresh.homing["X"].offset_counts = 55;
  std::string error;
  ASSERT_TRUE(directory.save(old, StatePart::homing, error)) << error;
  ASSERT_TRUE(directory.save(fresh, StatePart::homing, error)) << error;
  const std::string whole = test::read_text(directory.file(StatePart::homing));
  for (std::size_t n = 0; n <= whole.size(); ++n) {
    test::write_text(directory.file(StatePart::homing), whole.substr(0, n));
    const StateDirectory::Loaded loaded = directory.load();
    ASSERT_TRUE(loaded.ok()) << n;
    const MachineState& expected = n == whole.size() ? fresh : old;
    ASSERT_EQ(loaded.state.homing, expected.homing) << n;
    ASSERT_EQ(loaded.findings.empty(), n == whole.size()) << n;
  }
}

/// The steps of a save one by one, as a power cut leaves them.
TEST(StateDirectory, a_save_broken_off_between_its_steps_leaves_a_whole_generation) {
  MachineState old = sample(), fresh = sample();
  fresh.counters["parts"] = 1;
  const std::string before = write_part(old, StatePart::counters),
                    after = write_part(fresh, StatePart::counters);
  for (int step = 0; step < 4; ++step) {
    const StateDirectory directory(test::scratch("step"));
    const std::string file = directory.file(StatePart::counters);
    const std::string previous = file.substr(0, file.size() - 5) + ".previous.toml";
    test::write_text(file, before);
    if (step != 1) test::write_text(previous, before);  // 1: the old link is gone, the new one not yet made
    if (step <= 1) test::write_text(file + ".new", after.substr(0, after.size() / 2));  // not yet whole
    if (step == 2) test::write_text(file + ".new", after);  // whole, not yet renamed
    if (step == 3) test::write_text(file, after);           // renamed
    const StateDirectory::Loaded loaded = directory.load();
    EXPECT_TRUE(loaded.findings.empty()) << step;
    EXPECT_EQ(loaded.state.counters, step == 3 ? fresh.counters : old.counters) << step;
  }
}

TEST(StateDirectory, with_no_whole_generation_of_a_part_says_what_is_lost_and_what_to_do) {
  const std::string folder = test::scratch("lost-parts");
  const StateDirectory directory(folder);
  const struct {
    StatePart part;
    const char *lost, *remedy, *russian;
  } parts[] = {
      {StatePart::homing, "the references of the axes", "home all axes again", "выведите все оси в ноль"},
      {StatePart::counters, "the counters are lost", "they begin at 0", "счётчики утрачены"},
      {StatePart::gains, "gains that were found are lost", "tune again", "настройте заново"}};
  for (const auto& p : parts) {
    const std::string file = directory.file(p.part),
                      previous = file.substr(0, file.size() - 5) + ".previous.toml";
    std::string error;
    ASSERT_TRUE(directory.save(sample(), p.part, error) && directory.save(sample(), p.part, error)) << error;
    const std::string whole = test::read_text(file);
    const auto last = [&] { return directory.load().findings.back(); };
    test::write_text(file, whole.substr(0, whole.size() / 2));
    EXPECT_TRUE(directory.load().ok()) << "the previous generation is used";
    test::write_text(previous, whole.substr(0, whole.size() / 3));
    // Without the gains that were found, those of the machine file hold.
    const bool gains = p.part == StatePart::gains;
    ASSERT_EQ(directory.load().ok(), gains);
    EXPECT_EQ(directory.load().fell_back(), gains);
    EXPECT_EQ(last().entry->id, "state.part_lost");
    const std::string both = last().str(text::Language::english);
    for (const std::string& said :
         {file + (gains ? ":1:1: warning: " : ":1:1: error: ") + "both this file and " + previous,
          std::string(p.lost), std::string("move both away, and ") + p.remedy})
      EXPECT_NE(both.find(said), std::string::npos) << both;
    EXPECT_NE(last().str(text::Language::russian).find(p.russian), std::string::npos);
    std::filesystem::remove(previous);
    EXPECT_NE(last().str(text::Language::english).find("there is no other generation (" + previous),
              std::string::npos);
    std::filesystem::rename(file, previous);
    EXPECT_EQ(last().file, previous);
    std::filesystem::remove(previous);
    EXPECT_TRUE(directory.load().findings.empty());
  }
}

TEST(StateDirectory, leaves_damaged_gains_as_they_are_when_it_saves_all_parts) {
  const StateDirectory directory(test::scratch("damaged-gains"));
  std::string error;
  ASSERT_TRUE(directory.save_all(sample(), error)) << error;
  const std::string damaged = "checksum = \"none\"\nX.position_gain = 3o\n";
  test::write_text(directory.file(StatePart::gains), damaged);
  const StateDirectory::Loaded loaded = directory.load();
  ASSERT_TRUE(loaded.ok()) << "a run goes on";
  EXPECT_TRUE(loaded.state.gains.empty());
  EXPECT_EQ(loaded.state.counters, sample().counters);
  ASSERT_TRUE(directory.save_all(loaded.state, error)) << error;
  EXPECT_EQ(test::read_text(directory.file(StatePart::gains)), damaged);
}

/// A machine that counts: what generation n of the retained variables holds.
MachineState counted(std::int64_t generation) {
  MachineState s;
  s.retained_generation = generation;
  for (const char* name : {"Mill.parts", "Mill.magazine[1]", "Mill.magazine[2]"})
    s.retained.push_back({name, "DINT", std::to_string(1000 + generation)});
  return s;
}

struct Copies {
  StateDirectory directory;
  std::string older, newer;  ///< files of generations 7 and 8
};

Copies two_copies(const std::string& name) {
  StateDirectory directory(test::scratch(name));
  std::string error;
  for (const std::int64_t generation : {7, 8})
    EXPECT_TRUE(directory.save(counted(generation), StatePart::retained, error)) << error;
  return {directory, directory.retained_file(7), directory.retained_file(8)};
}

TEST(RetainedCopies, take_turns_and_the_newer_one_counts) {
  const Copies c = two_copies("turns");
  ASSERT_NE(c.older, c.newer);
  StateDirectory::Loaded loaded = c.directory.load();
  EXPECT_TRUE(loaded.findings.empty());
  EXPECT_EQ(loaded.state.retained, counted(8).retained);
  std::string error;
  ASSERT_TRUE(c.directory.save(counted(9), StatePart::retained, error)) << error;
  loaded = c.directory.load();
  EXPECT_EQ(loaded.state.retained_generation, 9);
  EXPECT_EQ(loaded.state.retained, counted(9).retained);
  EXPECT_EQ(test::read_text(c.newer), write_part(counted(8), StatePart::retained)) << "it was not touched";
}

/// What a power cut in a file system without order may leave of the copy under the pen.
TEST(RetainedCopies, cut_at_every_byte_give_the_newest_whole_one_and_never_a_mixture) {
  const Copies c = two_copies("cut");
  const std::string whole = test::read_text(c.newer);
  for (std::size_t n = 0; n <= whole.size(); ++n) {
    test::write_text(c.newer, whole.substr(0, n));
    const StateDirectory::Loaded loaded = c.directory.load();
    ASSERT_TRUE(loaded.ok()) << n;
    const std::int64_t expected = n == whole.size() ? 8 : 7;
    ASSERT_EQ(loaded.state.retained, counted(expected).retained) << n;
    ASSERT_EQ(loaded.state.retained_generation, expected) << n;
    ASSERT_EQ(loaded.findings.empty(), n == whole.size()) << n;
  }
}

TEST(RetainedCopies, over_which_older_bytes_show_through_are_damaged_and_not_mixed) {
  const Copies c = two_copies("torn");
  const std::string before = write_part(counted(6), StatePart::retained), whole = test::read_text(c.newer);
  ASSERT_EQ(before.size(), whole.size());
  for (std::size_t n = 0; n <= whole.size(); ++n) {  // n bytes of generation 8 over those of generation 6
    const std::string torn = whole.substr(0, n) + before.substr(n);
    test::write_text(c.newer, torn);
    const StateDirectory::Loaded loaded = c.directory.load();
    ASSERT_TRUE(loaded.ok()) << n;
    const bool sound = torn == whole || torn == before;
    ASSERT_EQ(loaded.state.retained, counted(torn == whole ? 8 : 7).retained) << n;
    ASSERT_EQ(loaded.findings.empty(), sound) << n;
  }
}

TEST(RetainedCopies, with_any_bit_flipped_give_the_other_one) {
  const Copies c = two_copies("flip");
  for (const std::string& file : {c.older, c.newer}) {
    const std::string whole = test::read_text(file);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      std::string flipped = whole;
      flipped[n] ^= static_cast<char>(1u << (n % 8));
      test::write_text(file, flipped);
      const StateDirectory::Loaded loaded = c.directory.load();
      ASSERT_TRUE(loaded.ok()) << n;
      ASSERT_EQ(loaded.state.retained, counted(file == c.newer ? 7 : 8).retained) << n;
      ASSERT_FALSE(loaded.findings.empty()) << n;
      ASSERT_EQ(loaded.findings.back().entry->id, "state.other_copy_taken");
    }
    test::write_text(file, whole);
  }
}

TEST(RetainedCopies, both_damaged_are_said_to_be_lost_wherever_they_are_cut) {
  const Copies c = two_copies("lost");
  const std::string whole = test::read_text(c.newer), old = test::read_text(c.older);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    test::write_text(c.newer, whole.substr(0, n));
    test::write_text(c.older, old.substr(0, old.size() - 1 - n % old.size()));
    const StateDirectory::Loaded loaded = c.directory.load();
    ASSERT_FALSE(loaded.ok()) << n;
    ASSERT_EQ(loaded.findings.back().entry->id, "state.retained_lost") << n;
    ASSERT_TRUE(loaded.state.retained.empty()) << n;
  }
}

TEST(RetainedCopies, a_write_broken_off_before_its_rename_leaves_both_copies_whole) {
  const Copies c = two_copies("rename");
  test::write_text(c.older + ".new", "checksum = \"crc32:");
  const StateDirectory::Loaded loaded = c.directory.load();
  EXPECT_TRUE(loaded.findings.empty());
  EXPECT_EQ(loaded.state.retained_generation, 8);
}

TEST(StateDirectory, a_file_edited_by_hand_says_so_and_is_taken) {
  std::string text = write_part(sample(), StatePart::gains);
  text = "checksum = \"none\"\n" + text.substr(text.find('\n') + 1) + "\"Y.position_gain\" = 20\n";
  MachineState state;
  const auto findings = read_part(text, "gains.toml", StatePart::gains, state);
  EXPECT_EQ(test::lines_of(findings, text::Language::english),
            "gains.toml:1:1: warning: edited by hand (checksum = \"none\"); used as it is [state.edited]\n");
  EXPECT_EQ(state.gains.at("Y.position_gain"), 20.0);
}

TEST(StateDirectory, an_edited_table_is_taken_and_its_edit_is_said) {
  const StateDirectory directory(test::scratch("edited"), {"X", "Y", "Z"});
  std::string error;
  ASSERT_TRUE(directory.save(sample(), StatePart::tools, error)) << error;
  std::string text = test::read_text(directory.file(StatePart::tools));
  text.replace(text.find("120.5"), 5, "121");
  text += "\n[[tool]]\nnumber = 5\nlength = { Z = 80 }\n";
  test::write_text(directory.file(StatePart::tools), text);
  const StateDirectory::Loaded loaded = directory.load();
  EXPECT_EQ(
      test::lines_of(loaded.findings, text::Language::english),
      "tools.toml:1:1: warning: edited since the control wrote it; used as it is [state.table_edited]\n");
  EXPECT_EQ(loaded.state.tables.correctors.at(1).length_of("Z"), 121.0 - 0.02);
  EXPECT_EQ(loaded.state.tables.correctors.at(5).length_of("Z"), 80.0);
}

TEST(StateDirectory, a_wrong_edit_is_refused_with_its_place_and_nothing_is_thrown_away) {
  const StateDirectory directory(test::scratch("wrong-edit"), {"X", "Z"});
  std::string error;
  for (int n = 0; n < 2; ++n) ASSERT_TRUE(directory.save(sample(), StatePart::origins, error)) << error;
  const std::string file = directory.file(StatePart::origins);
  const std::string wrong =
      "schema = 1\n[origins]\n1 = { X = 10, Q = 2 }\nfive = { X = 1 }\n2 = { X = \"3\" }\n";
  test::write_text(file, wrong);
  const StateDirectory::Loaded loaded = directory.load();
  EXPECT_FALSE(loaded.ok());
  const std::string lines = test::lines_of(loaded.findings, text::Language::english);
  for (const char* said :
       {"origins.toml:3:15: error: the machine has no axis Q; it has X, Z [state.table_axis]",
        "origins.toml:4:1: error: `five`: a number of an origin is expected [state.value]",
        "origins.toml:5:11: error: `2.X`: a finite number is expected [state.value]",
        "origins.toml:1:1: error: this file is not used, and nothing in it was changed: mend it, or go back "
        "to what "
        "the control wrote before: ",
        "origins.previous.toml [state.table_refused]"})
    EXPECT_NE(lines.find(said), std::string::npos) << said << "\n" << lines;
  EXPECT_EQ(test::read_text(file), wrong);
}

TEST(StateDirectory, wrong_values_of_a_table_are_named_with_their_place) {
  MachineState state;
  const auto findings = read_part(
      "schema = 1\ntool_in_spindle = 1.5\n[[tool]]\nnumber = 1\nlength = 3\nradius = nan\nlenght = 2\n"
      "[[tool]]\nnumber = 1\n[[tool]]\nquadrant = 12\n",
      "tools.toml", StatePart::tools, state);
  const std::string lines = test::lines_of(findings, text::Language::english);
  for (const char* said :
       {"tools.toml:2:19: error: `tool_in_spindle`: a whole number, 0..2147483647 is expected",
        "tools.toml:5:10: error: `length`: { axis = mm } is expected",
        "tools.toml:6:10: error: `radius`: a number of 0 or more is expected",
        "tools.toml:7:1: error: unknown key `lenght`; known here: number, name, length",
        "tools.toml:9:10: error: tool 1 stands in the file twice",
        "error: `number`: a tool's number is expected"})
    EXPECT_NE(lines.find(said), std::string::npos) << said << "\n" << lines;
}

TEST(StateDirectory, another_schema_or_part_is_refused) {
  MachineState state;
  const auto schema = read_part("checksum = \"none\"\nschema = 2\npart = \"gains\"\n[gains]\n", "g.toml",
                                StatePart::gains, state);
  EXPECT_EQ(schema.back().entry->id, "state.schema");
  const auto part = read_part(write_part(sample(), StatePart::tools), "g.toml", StatePart::gains, state);
  EXPECT_EQ(part.back().str(text::Language::english),
            "g.toml:3:1: error: this file holds `tools`, not `gains` [state.part]");
}

TEST(StateDirectory, a_folder_that_cannot_be_written_is_said_in_words) {
  const std::string folder = test::scratch("blocked");
  test::write_text(folder + "/state", "a file in the way");
  std::string error;
  EXPECT_FALSE(StateDirectory(folder + "/state").save(sample(), StatePart::tools, error));
  EXPECT_NE(error.find(folder + "/state"), std::string::npos) << error;
}

TEST(StateDirectory, that_is_there_already_keeps_its_mode) {
  const std::string path = test::scratch("mode") + "/state";
  std::filesystem::create_directory(path);
  ASSERT_EQ(::chmod(path.c_str(), 0750), 0);
  std::string error;
  ASSERT_TRUE(StateDirectory(path).save(sample(), StatePart::tools, error)) << error;
  StateLock lock;
  EXPECT_EQ(lock.take(path), "");
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0750u);
}

TEST(StateDirectory, follows_no_link_out_of_itself) {
  const std::string folder = test::scratch("links");
  std::filesystem::create_directory(folder + "/real");
  std::filesystem::create_directory_symlink("real", folder + "/link");
  std::string error;
  for (const char* link : {"/link", "/link/"}) {
    EXPECT_FALSE(StateDirectory(folder + link).save(sample(), StatePart::tools, error));
    EXPECT_NE(error.find("is a link"), std::string::npos) << error;
    EXPECT_NE(StateLock().take(folder + link).find("is a link"), std::string::npos);
  }
  const StateDirectory directory(folder + "/real");
  test::write_text(folder + "/elsewhere", "not ours");
  std::filesystem::create_symlink("../elsewhere", directory.file(StatePart::tools) + ".new");
  std::filesystem::create_symlink("../elsewhere", folder + "/real/lock");
  EXPECT_TRUE(directory.save(sample(), StatePart::tools, error)) << error;
  EXPECT_NE(StateLock().take(folder + "/real"), "");
  EXPECT_EQ(test::read_text(folder + "/elsewhere"), "not ours");
}

TEST(StateDirectory, of_another_user_is_not_written_into) {
  const std::string path = test::scratch("foreign") + "/state";
  std::filesystem::create_directory(path);
  if (::chown(path.c_str(), 65534, 65534) != 0) GTEST_SKIP() << "only root can give a folder away";
  std::string error;
  EXPECT_FALSE(StateDirectory(path).save(sample(), StatePart::tools, error));
  EXPECT_NE(error.find("belongs to another user"), std::string::npos) << error;
}

TEST(Toml, a_key_of_thousands_of_parts_is_an_error_with_its_place) {
  std::string key = "a";
  for (int n = 0; n < 20'000; ++n) key += ".a";
  MachineState state;
  for (const std::string& text : {key + " = 1\n", "[" + key + "]\n", "x = {" + key + " = 1}\n"}) {
    const auto findings =
        read_part("checksum = \"none\"\nschema = 1\n" + text, "s.toml", StatePart::gains, state);
    EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), [](const text::Finding& f) {
      return f.line == 3 && f.severity == text::Severity::error &&
             f.str(text::Language::english).find("a key has at most 16 parts") != std::string::npos;
    })) << test::lines_of(findings, text::Language::english);
  }
  const std::string path = test::scratch("deep") + "/machine.toml";
  test::write_text(path, key + " = 1\n");
  EXPECT_FALSE(load(path).findings.empty());
}

TEST(Toml, points_in_values_strings_and_comments_are_no_parts_of_keys) {
  const std::string dots(40, '.');
  MachineState state;
  const auto findings =
      read_part("checksum = \"none\"\n# " + dots + "\nschema = 1 # " + dots + "\nx = \"" + dots + "\\\"" +
                    dots + "\"\ny = '''\n" + dots + "\n'''\nz = [1.5, 2.5, 3.5]\n",
                "s.toml", StatePart::gains, state);
  for (const text::Finding& f : findings)
    EXPECT_EQ(f.str(text::Language::english).find("parts"), std::string::npos) << f.str();
}

TEST(Checksum, is_the_crc_of_ieee_802_3) { EXPECT_EQ(crc32("123456789"), 0xCBF43926u); }

}  // namespace
}  // namespace servogate::machine
