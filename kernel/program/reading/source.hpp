// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "kernel/program/reading/look_alikes.hpp"
#include "kernel/program/reading/program_text.hpp"

namespace servogate::program {

struct Dialect;

/// The text of one program file, read-only and shared by all copies of an interpreter: its lines, its labels
/// and subprograms, and which repeat ends where. Lines count from 0 inside of this room, from 1 for people.
class Source {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// `path`: where people find the file, for findings; empty: its name.
  Source(const Dialect& dialect, std::string name, ProgramText text, std::string path = {});
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  const std::string& name() const noexcept { return name_; }
  const std::string& path() const noexcept { return path_; }
  std::uint32_t lines() const noexcept { return lines_; }
  /// One line without its line end.
  std::string_view line(std::uint32_t index) const noexcept;
  /// Lines that hold a block (not empty, no comment, no tape mark).
  int blocks() const noexcept { return blocks_; }

  /// Line of a label, kNone when there is none. The first one counts where a label stands twice.
  std::uint32_t label(std::string_view name) const;
  /// The nearest line of `first` to `last` (from `first` on; backwards where `last` stands before it) that
  /// has a label, or a block number. kNone: there is none.
  std::uint32_t find_label(std::string_view name, std::uint32_t first, std::uint32_t last) const;
  std::uint32_t find_number(std::int32_t number, std::uint32_t first, std::uint32_t last) const;
  /// Line of the end that belongs to the repeat of a line and the reverse, kNone where the partner is
  /// missing.
  std::uint32_t repeat_partner(std::uint32_t line) const;
  /// Line that begins a subprogram of this file, kNone: there is none. `behind`: behind the last line of what
  /// follows up to the next such line or the main program.
  std::uint32_t definition(std::int32_t number) const;
  std::uint32_t behind_definition(std::uint32_t line) const;
  /// The subprogram in whose lines a line stands: where it begins, and its number. kNone: in none.
  std::pair<std::uint32_t, std::int32_t> definition_at(std::uint32_t line) const;
  /// First line of the main program; kNone where the language wants a mark in front of it and there is none.
  std::uint32_t start() const noexcept { return start_; }

  /// A label that stands a second time; `label` points into its line.
  struct Duplicate {
    std::uint32_t line;
    std::uint32_t first;
    std::string_view label;
  };
  const std::vector<Duplicate>& duplicates() const noexcept { return duplicates_; }
  /// Cyrillic letters that were read as Latin ones; the lines have the Latin ones.
  const std::vector<LookAlike>& look_alikes() const noexcept { return look_alikes_; }
  /// How many there are beside.
  long long more_look_alikes() const noexcept { return more_look_alikes_; }
  /// First line (from 0) that a CR alone ends, as tapes and old computers wrote them; kNone: there is none.
  std::uint32_t lone_return() const noexcept { return lone_return_; }

 private:
  static constexpr std::uint32_t kStride = 2;
  void rewrite();
  void index_line(std::uint32_t index, std::string_view text, std::vector<std::uint32_t>& open);
  void pass(std::size_t offset) const noexcept;
  template <typename Is>
  std::uint32_t find_line(std::uint32_t first, std::uint32_t last, Is is) const;

  const Dialect* dialect_;
  std::string name_;
  std::string path_;
  ProgramText text_;
  std::string_view view_;             ///< of it, what counts
  std::vector<std::uint32_t> marks_;  ///< offset of every kStride-th line
  std::uint32_t lines_ = 0;
  mutable std::atomic<std::size_t> window_{0};  ///< of the text that was looked at last
  std::unordered_map<std::string_view, std::uint32_t> labels_;
  std::unordered_map<std::uint32_t, std::uint32_t> partners_;
  std::map<std::uint32_t, std::int32_t> definitions_;  ///< line to number
  std::uint32_t start_ = 0;
  std::vector<Duplicate> duplicates_;
  std::vector<LookAlike> look_alikes_;
  long long more_look_alikes_ = 0;
  std::uint32_t lone_return_ = kNone;
  int blocks_ = 0;
};

}  // namespace servogate::program
