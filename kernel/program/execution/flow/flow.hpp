// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kernel/program/execution/state/state.hpp"
#include "kernel/program/reading/block.hpp"
#include "kernel/program/reading/loader.hpp"
#include "kernel/program/reading/source.hpp"

namespace servogate::program {

/// The files met so far, the main program first; their numbers are those of Command::file.
struct ProgramFiles {
  ProgramLoader loader;
  const Dialect* language = nullptr;  ///< in which all of them are looked through
  std::vector<std::shared_ptr<const Source>> sources;
  std::vector<std::string> names;
};

/// Where a program goes on: jumps, repeats, calls. `line`: of the block that is executed, from 0.
class Flow {
 public:
  Flow(const Dialect& dialect, const AxisLetters& axes, ProgramFiles& files, FlowState& state,
       std::uint32_t& line)
      : dialect_(dialect), axes_(axes), files_(files), state_(state), line_(line) {}

  const Source& main_source() const noexcept { return *files_.sources.front(); }
  const Source& source() const { return source(state_.file); }
  const Source& source(int file) const { return *files_.sources[static_cast<std::size_t>(file)]; }
  const std::string& path(int file) const { return source(file).path(); }
  const std::vector<std::string>& names() const noexcept { return files_.names; }
  const ProgramLoader& loader() const noexcept { return files_.loader; }
  int file() const noexcept { return state_.file; }
  std::uint32_t line() const noexcept { return line_; }
  int line_number() const noexcept { return static_cast<int>(line_) + 1; }  ///< the same for people
  /// Column of what moves an axis (-1: none in particular) in a line for people, or where its block begins.
  int column_at(int file, int line, int axis) const;

  /// Line of a label of this file. Throws where there is none.
  std::uint32_t label_line(std::string_view label, int column) const;
  void jump(std::uint32_t line);
  /// The lines from this one's on up to the end of the repeat, so often.
  void repeat(int count, int column);
  void end_repeat(int column);
  /// Another program, so often.
  void call(std::string_view name, int times, int column);
  /// A subprogram of this file, or of another one, that begins at a line; `arguments` are what it can ask for
  /// by number.
  void call(std::uint32_t line, int times, int column, std::vector<double> arguments = {}, int file = -1);
  /// Number of a file that the loader knows by its name, which is read where it has not been; -1: there is
  /// none.
  int open(std::string_view name);
  /// Back from the subprogram; false: none has been called.
  bool leave_subprogram();
  /// Argument of the innermost call; 0 where it is missing.
  double argument(std::size_t index) const;
  void run_part(std::uint32_t first, std::uint32_t last);
  /// These lines of this file belong to a cycle: from now on only `run_part` executes them.
  void pass_over(std::uint32_t first, std::uint32_t last);
  /// At the end of a part that is run, or of a subprogram's file: goes back; at a contour that is passed over:
  /// behind it. False: the program goes on with the next line.
  bool leave_part_or_file();
  /// A text of its own, from its beginning, in place of the program.
  void enter_text(const std::string& name, std::string_view text);

 private:
  void enter(FlowState::Call call, std::size_t file, std::uint32_t line, int column);

  const Dialect& dialect_;
  const AxisLetters& axes_;
  ProgramFiles& files_;
  FlowState& state_;
  std::uint32_t& line_;
};

}  // namespace servogate::program
