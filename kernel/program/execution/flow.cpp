// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {

/// Where the main program begins.
void Execution::begin_flow() { state_.flow.line = main_source().start(); }

/// At the end of a part that is run, or of a subprogram's file: goes back. False: nothing ends here.
bool Execution::leave_part_or_file() {
  Flow& flow = state_.flow;
  if (flow.part && flow.part->depth == flow.calls.size() && flow.line == flow.part->last + 1) {
    flow.line = flow.part->back;
    flow.loops.resize(std::min(flow.loops.size(), flow.part->loops));
    flow.part.reset();
    return true;
  }
  if (flow.line < source().lines() || flow.calls.empty()) return false;
  if (flow.loops.size() > flow.calls.back().loops) {
    line_ = flow.loops.back().first;
    fail(Fault::repeat_without_end, column_at(flow.file, line_number(), -1),
         {std::string(dialect_->terms.repeat), std::string(dialect_->terms.repeat_end)});
  }
  return leave_subprogram();
}

bool Execution::leave_subprogram() {
  Flow& flow = state_.flow;
  if (flow.calls.empty()) return false;
  Flow::Call& call = flow.calls.back();
  flow.loops.resize(std::min(flow.loops.size(), call.loops));
  if (--call.left > 0) {
    flow.line = call.first;
    return true;
  }
  flow.file = call.file;
  flow.line = call.back;
  flow.calls.pop_back();
  return true;
}

double Execution::argument(std::size_t index) const {
  const std::vector<Flow::Call>& calls = state_.flow.calls;
  return calls.empty() || index >= calls.back().arguments.size() ? 0.0 : calls.back().arguments[index];
}

std::uint32_t Execution::label_line(std::string_view label, int column) const {
  const std::uint32_t line = source().label(label);
  if (line == Source::kNone) fail(Fault::label_missing, column, {std::string(label)});
  return line;
}

void Execution::jump(std::uint32_t target) {
  Flow& flow = state_.flow;
  const std::size_t depth = flow.calls.size();
  while (!flow.loops.empty() && flow.loops.back().depth == depth &&
         (target <= flow.loops.back().first || target > flow.loops.back().last))
    flow.loops.pop_back();
  if (target <= line_ && snapshot_used_) want_fresh_ = true;
  flow.line = target;
}

void Execution::repeat(int count, int column) {
  Flow& flow = state_.flow;
  const std::uint32_t last = source().repeat_partner(line_);
  if (last == Source::kNone)
    fail(Fault::repeat_without_end, column,
         {std::string(dialect_->terms.repeat), std::string(dialect_->terms.repeat_end)});
  const std::size_t depth = flow.calls.size();
  const std::size_t below = depth == 0 ? 0 : flow.calls.back().loops;
  if (static_cast<int>(flow.loops.size() - below) >= dialect_->max_repeat_depth)
    fail(Fault::repeat_depth, column, {std::to_string(dialect_->max_repeat_depth)});
  if (count == 0)
    flow.line = last + 1;
  else
    flow.loops.push_back({depth, line_, last, count});
}

void Execution::end_repeat(int column) {
  Flow& flow = state_.flow;
  if (flow.loops.empty() || flow.loops.back().depth != flow.calls.size() || flow.loops.back().last != line_)
    fail(Fault::end_without_repeat, column,
         {std::string(dialect_->terms.repeat_end), std::string(dialect_->terms.repeat)});
  if (--flow.loops.back().left > 0)
    flow.line = flow.loops.back().first + 1;
  else
    flow.loops.pop_back();
}

void Execution::enter(Flow::Call call, std::size_t file, std::uint32_t line, int column) {
  Flow& flow = state_.flow;
  if (static_cast<int>(flow.calls.size()) >= dialect_->max_call_depth)
    fail(Fault::call_depth, column, {std::to_string(dialect_->max_call_depth)});
  call.file = flow.file;
  call.back = flow.line;
  call.loops = flow.loops.size();
  call.first = line;
  flow.calls.push_back(std::move(call));
  flow.file = static_cast<int>(file);
  flow.line = line;
}

void Execution::call(std::string_view name, int times, int column) {
  const auto known =
      std::find_if(sources_.begin() + 1, sources_.end(), [&](const auto& s) { return s->name() == name; });
  const auto index = static_cast<std::size_t>(known - sources_.begin());
  if (static_cast<int>(state_.flow.calls.size()) < dialect_->max_call_depth && known == sources_.end()) {
    auto loaded = loader_ ? loader_(name) : std::nullopt;
    if (!loaded) fail(Fault::program_missing, column, {std::string(name)});
    sources_.push_back(std::make_shared<const Source>(*dialect_, std::string(name), std::move(loaded->text),
                                                      std::move(loaded->path)));
    files_.emplace_back(name);
  }
  Flow::Call entered;
  entered.left = times;
  enter(std::move(entered), index, 0, column);
}

void Execution::call(std::uint32_t line, int times, int column, std::vector<double> arguments) {
  Flow::Call entered;
  entered.left = times;
  entered.arguments = std::move(arguments);
  enter(std::move(entered), static_cast<std::size_t>(state_.flow.file), line, column);
}

void Execution::run_part(std::uint32_t first, std::uint32_t last) {
  Flow& flow = state_.flow;
  flow.part = Flow::Part{flow.calls.size(), first, last, flow.line, flow.loops.size()};
  flow.line = first;
}

}  // namespace servogate::program
