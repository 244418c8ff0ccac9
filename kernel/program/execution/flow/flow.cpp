// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/flow/flow.hpp"

#include <algorithm>
#include <utility>

namespace servogate::program {

int Flow::column_at(int file, int line, int axis) const {
  Block block;
  const Source& text = source(file);
  if (line < 1 || static_cast<std::uint32_t>(line) > text.lines()) return 1;
  try {
    read_block(dialect_, axes_, text.line(static_cast<std::uint32_t>(line) - 1), block);
  } catch (const ProgramError& error) {
    return error.column;
  }
  return column_of(block, axis);
}

bool Flow::leave_part_or_file() {
  if (state_.part && state_.part->depth == state_.calls.size() && state_.line == state_.part->last + 1) {
    state_.line = state_.part->back;
    state_.loops.resize(std::min(state_.loops.size(), state_.part->loops));
    state_.part.reset();
    return true;
  }
  if (!state_.part)
    for (const FlowState::Contour& c : state_.contours)
      if (c.first == state_.line && c.file == state_.file) {
        state_.line = c.last + 1;
        return true;
      }
  if (state_.line < source().lines() || state_.calls.empty()) return false;
  if (state_.loops.size() > state_.calls.back().loops) {
    line_ = state_.loops.back().first;
    fail(Fault::repeat_without_end, column_at(state_.file, line_number(), -1),
         {std::string(dialect_.terms.repeat), std::string(dialect_.terms.repeat_end)});
  }
  return leave_subprogram();
}

bool Flow::leave_subprogram() {
  if (state_.calls.empty()) return false;
  FlowState::Call& call = state_.calls.back();
  state_.loops.resize(std::min(state_.loops.size(), call.loops));
  if (--call.left > 0) {
    state_.line = call.first;
    return true;
  }
  state_.file = call.file;
  state_.line = call.back;
  state_.calls.pop_back();
  return true;
}

double Flow::argument(std::size_t index) const {
  const auto& calls = state_.calls;
  return calls.empty() || index >= calls.back().arguments.size() ? 0.0 : calls.back().arguments[index];
}

std::uint32_t Flow::label_line(std::string_view label, int column) const {
  const std::uint32_t line = source().label(label);
  if (line == Source::kNone) fail(Fault::label_missing, column, {std::string(label)});
  return line;
}

void Flow::jump(std::uint32_t target) {
  const std::size_t depth = state_.calls.size();
  while (!state_.loops.empty() && state_.loops.back().depth == depth &&
         (target <= state_.loops.back().first || target > state_.loops.back().last))
    state_.loops.pop_back();
  if (target <= line_) state_.went_back = true;
  state_.line = target;
}

void Flow::repeat(int count, int column) {
  const std::uint32_t last = source().repeat_partner(line_);
  if (last == Source::kNone)
    fail(Fault::repeat_without_end, column,
         {std::string(dialect_.terms.repeat), std::string(dialect_.terms.repeat_end)});
  const std::size_t depth = state_.calls.size();
  const std::size_t below = depth == 0 ? 0 : state_.calls.back().loops;
  if (static_cast<int>(state_.loops.size() - below) >= dialect_.max_repeat_depth)
    fail(Fault::repeat_depth, column, {std::to_string(dialect_.max_repeat_depth)});
  if (count == 0)
    state_.line = last + 1;
  else
    state_.loops.push_back({depth, line_, last, count});
}

void Flow::end_repeat(int column) {
  if (state_.loops.empty() || state_.loops.back().depth != state_.calls.size() ||
      state_.loops.back().last != line_)
    fail(Fault::end_without_repeat, column,
         {std::string(dialect_.terms.repeat_end), std::string(dialect_.terms.repeat)});
  if (--state_.loops.back().left > 0)
    state_.line = state_.loops.back().first + 1;
  else
    state_.loops.pop_back();
}

void Flow::enter(FlowState::Call call, std::size_t file, std::uint32_t line, int column) {
  if (static_cast<int>(state_.calls.size()) >= dialect_.max_call_depth)
    fail(Fault::call_depth, column, {std::to_string(dialect_.max_call_depth)});
  call.file = state_.file;
  call.back = state_.line;
  call.loops = state_.loops.size();
  call.first = line;
  state_.calls.push_back(std::move(call));
  state_.file = static_cast<int>(file);
  state_.line = line;
}

int Flow::open(std::string_view name) {
  const auto known = std::find_if(files_.sources.begin() + 1, files_.sources.end(),
                                  [&](const auto& s) { return s->name() == name; });
  const auto index = static_cast<int>(known - files_.sources.begin());
  if (known != files_.sources.end()) return index;
  auto loaded = files_.loader ? files_.loader(name) : std::nullopt;
  if (!loaded) return -1;
  files_.sources.push_back(std::make_shared<const Source>(*files_.language, std::string(name),
                                                          std::move(loaded->text), std::move(loaded->path)));
  files_.names.emplace_back(name);
  return index;
}

void Flow::call(std::string_view name, int times, int column) {
  const bool possible = static_cast<int>(state_.calls.size()) < dialect_.max_call_depth;
  const int file = possible ? open(name) : 0;
  if (file < 0) fail(Fault::program_missing, column, {std::string(name)});
  FlowState::Call entered;
  entered.left = times;
  enter(std::move(entered), static_cast<std::size_t>(file), 0, column);
}

void Flow::call(std::uint32_t line, int times, int column, std::vector<double> arguments, int file) {
  FlowState::Call entered;
  entered.left = times;
  entered.arguments = std::move(arguments);
  enter(std::move(entered), static_cast<std::size_t>(file < 0 ? state_.file : file), line, column);
}

void Flow::run_part(std::uint32_t first, std::uint32_t last) {
  state_.part = FlowState::Part{state_.calls.size(), first, last, state_.line, state_.loops.size()};
  state_.line = first;
}

void Flow::pass_over(std::uint32_t first, std::uint32_t last) {
  const auto known = std::find_if(
      state_.contours.begin(), state_.contours.end(),
      [&](const FlowState::Contour& c) { return c.file == state_.file && c.first == first; });
  if (known != state_.contours.end())
    known->last = last;
  else
    state_.contours.push_back({state_.file, first, last});
}

void Flow::enter_text(const std::string& name, std::string_view text) {
  state_ = FlowState{};
  const auto at = std::find(files_.names.begin() + 1, files_.names.end(), name);
  state_.file = static_cast<int>(at - files_.names.begin());
  if (at == files_.names.end()) {
    files_.names.push_back(name);
    files_.sources.emplace_back();
  }
  files_.sources[static_cast<std::size_t>(state_.file)] =
      std::make_shared<const Source>(*files_.language, name, std::string(text));
}

}  // namespace servogate::program
