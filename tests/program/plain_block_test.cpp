// SPDX-License-Identifier: Apache-2.0
// The quick reader of plain blocks against the reader of all blocks.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "kernel/program/languages/languages.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/reading/block_parts.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program {
namespace {

std::string words_of(const Block& block) {
  std::string out =
      std::to_string(static_cast<int>(block.kind)) + " N" + std::to_string(block.number) + "@" +
      std::to_string(block.number_column) + " " + std::to_string(block.body) + ".." +
      std::to_string(block.end) + (block.skip ? " skip" : "") + (block.trailing_comment ? " comment" : "") +
      " g" + std::to_string(block.g_count) + " a" + std::to_string(block.argument_count) + " sync" +
      std::to_string(static_cast<int>(block.sync)) + " level" + std::to_string(block.skip_level);
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& w = block.words[i];
    char number[64];
    std::snprintf(number, sizeof number, "%a", w.value.number);
    out += std::string("\n") + w.letter + " " + number + " of " +
           std::to_string(static_cast<int>(w.meaning)) + " axis " + std::to_string(w.axis) + " at " +
           std::to_string(w.column) + ".." + std::to_string(w.end) + ", its number at " +
           std::to_string(w.value.column) + (w.value.negative ? " minus" : "") +
           (w.value.fraction ? " point" : "") + (w.value.bare ? " bare" : "") + " " +
           std::to_string(static_cast<int>(w.value.dimension)) + " p" + std::to_string(w.value.parameter) +
           " e" + std::to_string(w.value.expression) + " n" + std::to_string(w.argument_count) +
           (w.rule != nullptr ? " ruled" : "") + (w.g != nullptr ? " G" + std::to_string(w.g->number) : "");
  }
  return out;
}

/// Those of programs, and the ISO dialect that programs of the SINUMERIK 808D go over to.
std::vector<const Dialect*> languages() {
  std::vector<const Dialect*> out(all_dialects().begin(), all_dialects().end());
  MachineModel machine;
  for (const auto kind : {MachineModel::Kind::milling, MachineModel::Kind::turning}) {
    machine.kind = kind;
    out.push_back(&sinumerik::iso::dialect(machine));
  }
  return out;
}

/// A line of pieces that blocks are made of, most of them plain.
std::string random_line(std::mt19937_64& random) {
  static constexpr const char* kStarts[] = {"",  "",  "",  "N10", "N0",    " ",   "\t",   "N",    "/", "/1 ",
                                            "%", "$", "(", ";",   "\"A\"", "AB:", "N1N2", "N1.5", "*", "#"};
  static constexpr const char* kLetters[] = {"X", "Y", "Z", "X", "Y", "A", "I", "J", "K", "F", "G", "R",
                                             "M", "S", "T", "x", "U", "P", "E", "B", "L", "D", "N", "_"};
  static constexpr const char* kNumbers[] = {"1",
                                             "0",
                                             "-1",
                                             "12.5",
                                             "-.5",
                                             "3.",
                                             "1",
                                             "0.001",
                                             "-0",
                                             "",
                                             "+2",
                                             "1,5",
                                             "100000",
                                             "- 1",
                                             "=1",
                                             "E1",
                                             "1E2",
                                             "90",
                                             "91",
                                             "(1)",
                                             "999999999999",
                                             "1.23456789012345678",
                                             "=R1+2",
                                             "2-1",
                                             "1.2.3"};
  static constexpr const char* kBehind[] = {"",   "",    "",   " ",  "  ", "\t",
                                            ";c", "(c)", " /", "\r", "//", "\xD0\xA5"};
  const auto one_of = [&](const auto& texts) { return texts[random() % std::size(texts)]; };
  std::string line = one_of(kStarts);
  if (random() % 2 == 0) line += random() % 8 == 0 ? "G02 " : random() % 2 == 0 ? "G1" : "G0 ";
  const std::size_t count = random() % 6;
  for (std::size_t i = 0; i < count; ++i) {
    const bool plain = random() % 4 != 0;
    line += plain ? kLetters[random() % 5] : one_of(kLetters);
    line += plain ? kNumbers[random() % 8] : one_of(kNumbers);
    if (random() % 2 == 0) line += plain ? " " : one_of(kBehind);
  }
  return line;
}

TEST(PlainBlock, is_read_as_the_reader_of_all_blocks_reads_it_in_every_language) {
  std::mt19937_64 random(test::property_seed());
  const AxisLetters axes({"X", "Y", "Z", "A"});
  auto quick = std::make_unique<Block>(), slow = std::make_unique<Block>();
  for (const Dialect* dialect : languages()) {
    int plain = 0;
    for (int i = 0; i < 20'000; ++i) {
      const std::string line = random_line(random);
      SCOPED_TRACE(std::string(dialect->name) + ": " + line);
      if (!read_plain_block(*dialect, axes, line, *quick)) continue;
      ++plain;
      ASSERT_NO_THROW(read_any_block(*dialect, axes, line, *slow));
      ASSERT_EQ(words_of(*quick), words_of(*slow));
    }
    EXPECT_GT(plain, 1000) << dialect->name << ": the comparison says nothing";
  }
}

TEST(PlainBlock, is_what_cam_systems_write) {
  const AxisLetters axes({"X", "Y", "Z"});
  auto block = std::make_unique<Block>();
  for (const Dialect* dialect : languages())
    for (const char* line : {"G1 X-12.345 Y.5", "N120 G0 X1 Y2 Z-3.", "X1Y2Z3", "G1X1.5F200\r"})
      EXPECT_TRUE(read_plain_block(*dialect, axes, line, *block)) << dialect->name << ": " << line;
}

}  // namespace
}  // namespace servogate::program
