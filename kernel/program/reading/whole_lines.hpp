// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "kernel/program/reading/program_text.hpp"

namespace servogate::program {

/// A text in pieces of whole lines. A CR that no LF follows ends a line as well, as tapes and old computers
/// wrote them: it becomes an LF. Those before an LF (CR CR LF, too) belong to it.
class WholeLines {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  static constexpr std::size_t kPiece = std::size_t{1} << 20;  ///< bytes

  /// `view`: a part of `text`, which is told what is not looked at any more.
  WholeLines(std::string_view view, const ProgramText& text) : view_(view), text_(&text) {}

  /// The next lines, about a piece of them; false: there are none left.
  bool next(std::string& lines);
  /// First line so far (from 0) that a CR alone ends; kNone: there is none.
  std::uint32_t lone_return() const noexcept { return lone_return_; }

 private:
  std::size_t behind_line() const noexcept;
  void put_line_ends(std::string& lines);

  std::string_view view_;
  const ProgramText* text_;
  std::size_t from_ = 0;
  std::uint32_t line_ = 0;
  std::uint32_t lone_return_ = kNone;
};

}  // namespace servogate::program
