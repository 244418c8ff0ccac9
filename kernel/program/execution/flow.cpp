// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {

/// At the end of a part that EPP runs, or of a subprogram: goes back. False: nothing ends here.
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
    fail(Fault::repeat_without_end, column_at(flow.file, line_number(), -1));
  }
  flow.file = flow.calls.back().file;
  flow.line = flow.calls.back().back;
  flow.calls.pop_back();
  return true;
}

void Execution::jump(std::string_view label, int column) {
  Flow& flow = state_.flow;
  const std::uint32_t target = source().label(label);
  if (target == Source::kNone) fail(Fault::label_missing, column, {std::string(label)});
  const std::size_t depth = flow.calls.size();
  if (flow.part && flow.part->depth == depth && (target < flow.part->first || target > flow.part->last))
    fail(Fault::jump_out_of_part, column, {std::string(label)});
  while (!flow.loops.empty() && flow.loops.back().depth == depth &&
         (target <= flow.loops.back().first || target > flow.loops.back().last))
    flow.loops.pop_back();
  if (target <= line_ && snapshot_used_) want_fresh_ = true;
  flow.line = target;
}

void Execution::repeat(int count) {
  Flow& flow = state_.flow;
  const std::uint32_t last = source().repeat_partner(line_);
  if (last == Source::kNone) fail(Fault::repeat_without_end, operands_.column);
  const std::size_t depth = flow.calls.size();
  const std::size_t below = depth == 0 ? 0 : flow.calls.back().loops;
  if (static_cast<int>(flow.loops.size() - below) >= dialect_->max_repeat_depth)
    fail(Fault::repeat_depth, operands_.column, {std::to_string(dialect_->max_repeat_depth)});
  if (count == 0)
    flow.line = last + 1;
  else
    flow.loops.push_back({depth, line_, last, count});
}

void Execution::end_repeat() {
  Flow& flow = state_.flow;
  if (flow.loops.empty() || flow.loops.back().depth != flow.calls.size() || flow.loops.back().last != line_)
    fail(Fault::end_without_repeat, operands_.column);
  if (--flow.loops.back().left > 0)
    flow.line = flow.loops.back().first + 1;
  else
    flow.loops.pop_back();
}

void Execution::call(std::string_view name, int column) {
  Flow& flow = state_.flow;
  if (static_cast<int>(flow.calls.size()) >= dialect_->max_call_depth)
    fail(Fault::call_depth, column, {std::to_string(dialect_->max_call_depth)});
  const auto known =
      std::find_if(sources_.begin() + 1, sources_.end(), [&](const auto& s) { return s->name() == name; });
  const auto index = static_cast<std::size_t>(known - sources_.begin());
  if (known == sources_.end()) {
    auto loaded = loader_ ? loader_(name) : std::nullopt;
    if (!loaded) fail(Fault::program_missing, column, {std::string(name)});
    sources_.push_back(
        std::make_shared<const Source>(std::string(name), std::move(loaded->text), std::move(loaded->path)));
    files_.emplace_back(name);
  }
  flow.calls.push_back({flow.file, flow.line, flow.loops.size()});
  flow.file = static_cast<int>(index);
  flow.line = 0;
}

void Execution::run_part(std::string_view first, std::string_view last, int column1, int column2) {
  Flow& flow = state_.flow;
  if (flow.part) fail(Fault::part_nested, operands_.column);
  const std::uint32_t from = source().label(first), to = source().label(last);
  if (from == Source::kNone) fail(Fault::label_missing, column1, {std::string(first)});
  if (to == Source::kNone) fail(Fault::label_missing, column2, {std::string(last)});
  if (to < from) fail(Fault::part_reversed, column1, {std::string(first), std::string(last)});
  flow.part = Flow::Part{flow.calls.size(), from, to, flow.line, flow.loops.size()};
  flow.line = from;
}

}  // namespace servogate::program
