// SPDX-License-Identifier: Apache-2.0
// Texts that are larger than one wants to hold in memory are read piece by piece, those of old computers,
// too.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "kernel/program/languages/nc110/nc110.hpp"
#include "kernel/program/reading/source.hpp"
#include "kernel/program/reading/whole_lines.hpp"

namespace servogate::program {
namespace {

/// A store that says how it was used.
class Spool final : public ProgramText::Store {
 public:
  struct Use {
    int texts = 0;
    std::size_t largest_piece = 0;
    bool full = false;  ///< of the disk
  };
  Spool(std::string text, Use& use) : text_(std::move(text)), use_(use) {}
  std::string_view content() const noexcept override { return text_; }
  void leave(std::size_t, std::size_t) const noexcept override {}
  std::shared_ptr<const Store> hold(const std::function<std::string()>& next) const override {
    std::string all;
    for (std::string piece = next(); !piece.empty(); piece = next()) {
      use_.largest_piece = std::max(use_.largest_piece, piece.size());
      all += piece;
      if (use_.full) return nullptr;
    }
    ++use_.texts;
    return std::make_shared<Spool>(std::move(all), use_);
  }

 private:
  std::string text_;
  Use& use_;
};

/// Three windows and more of blocks. Every 1000th has a Cyrillic letter for a Latin one; all have a comment
/// in Russian.
std::string long_text(const char* line_end) {
  std::string out = "\"Ж1\"G1 X1 F100";
  for (int n = 0; out.size() < 3 * WholeLines::kPiece + 1000; ++n)
    out += line_end + (n % 1000 == 999 ? std::string("Х") : std::string("X")) + std::to_string(n % 97) +
           " ; деталь";
  return out + line_end + "(BNC,Ж1)" + line_end;
}

void expect_same(const Source& a, const Source& b) {
  ASSERT_EQ(a.lines(), b.lines());
  for (std::uint32_t n = 0; n < a.lines(); ++n) ASSERT_EQ(a.line(n), b.line(n)) << n;
  EXPECT_EQ(a.lone_return(), b.lone_return());
  ASSERT_EQ(a.look_alikes().size(), b.look_alikes().size());
  for (std::size_t n = 0; n < a.look_alikes().size(); ++n) {
    ASSERT_EQ(a.look_alikes()[n].line, b.look_alikes()[n].line);
    ASSERT_EQ(a.look_alikes()[n].column, b.look_alikes()[n].column);
  }
}

TEST(LargeText, is_rewritten_by_the_piece_and_reads_as_the_same_text_in_memory) {
  for (const char* line_end : {"\n", "\r", "\r\n", "\r\r\n"}) {
    Spool::Use use;
    const std::string text = long_text(line_end);
    const Source large(nc110::dialect(), "p", ProgramText(std::make_shared<Spool>(text, use)));
    const Source small(nc110::dialect(), "p", text);
    expect_same(large, small);
    EXPECT_EQ(use.texts, 1);
    EXPECT_LE(use.largest_piece, WholeLines::kPiece);
    EXPECT_EQ(large.label("Ж1"), 0u);
    EXPECT_EQ(large.line(1000), "X29 ; деталь") << "the letter is the Latin one, the comment as it was";
    EXPECT_EQ(large.look_alikes().front().line, 1000u);
    EXPECT_EQ(large.lone_return(), line_end == std::string_view("\r") ? 0u : Source::kNone);
  }
}

TEST(LargeText, is_held_in_memory_where_there_is_no_room_for_another_one) {
  Spool::Use use;
  use.full = true;
  const std::string text = long_text("\r");
  const Source large(nc110::dialect(), "p", ProgramText(std::make_shared<Spool>(text, use)));
  const Source small(nc110::dialect(), "p", text);
  expect_same(large, small);
  EXPECT_EQ(use.texts, 0);
}

TEST(LargeText, is_read_in_its_place_where_nothing_has_to_be_rewritten) {
  Spool::Use use;
  std::string text;
  while (text.size() < 2 * WholeLines::kPiece) text += "G1 X1 F100 ; part\r\n";
  const Source large(nc110::dialect(), "p", ProgramText(std::make_shared<Spool>(text, use)));
  EXPECT_EQ(large.line(7), "G1 X1 F100 ; part");
  EXPECT_EQ(use.texts, 0);
}

TEST(LargeText, of_one_line_that_is_longer_than_a_piece_is_one_piece) {
  const std::string text(WholeLines::kPiece + 10, 'X');
  const ProgramText all(text + "\rG1\r");
  WholeLines pieces(all.view(), all);
  std::string lines;
  ASSERT_TRUE(pieces.next(lines));
  EXPECT_EQ(lines, text + "\nG1\n");
  EXPECT_FALSE(pieces.next(lines));
  EXPECT_EQ(pieces.lone_return(), 0u);
}

}  // namespace
}  // namespace servogate::program
