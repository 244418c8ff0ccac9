// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/source.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>

#include "kernel/program/reading/block.hpp"

namespace servogate::program {

namespace {

/// Behind the last character that is more than filling.
std::size_t last_of(std::string_view text) {
  constexpr std::string_view kFilling("\x1A\0 \t\r\n", 6);
  const std::size_t last = text.find_last_not_of(kFilling);
  return last == std::string_view::npos ? 0 : last + 1;
}

}  // namespace

Source::Source(const Dialect& dialect, std::string name, std::string text, std::string path)
    : dialect_(&dialect),
      name_(std::move(name)),
      path_(path.empty() ? name_ : std::move(path)),
      text_(std::move(text)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  // CP/M and its heirs end a text with 1Ah, and may fill the last record up.
  const std::size_t end_mark = text_.find_first_of("\x1A", last_of(text_));
  if (end_mark != std::string::npos) text_.erase(end_mark);
  put_line_ends();
  look_alikes_ = read_look_alikes(dialect.lexis, text_);
  starts_.reserve(text_.size() / 24 + 2);
  starts_.push_back(0);
  const char* const begin = text_.data();
  const char* const end = begin + text_.size();
  for (const char* p = begin; p < end;) {
    const void* found = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    p = found == nullptr ? end : static_cast<const char*>(found) + 1;
    starts_.push_back(static_cast<std::uint32_t>(p - begin));
  }
  if (dialect.lexis.starts_at_tape) start_ = kNone;
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < lines(); ++i) index_line(i, open);
}

/// A CR that no LF follows ends a line as well. Those before an LF (CR CR LF, too) belong to it.
void Source::put_line_ends() {
  if (text_.find('\r') == std::string::npos) return;
  std::uint32_t line = 0;
  for (std::size_t at = text_.find_first_of("\r\n"); at != std::string::npos;
       at = text_.find_first_of("\r\n", at + 1)) {
    const std::size_t next = text_.find_first_not_of('\r', at);
    if (text_[at] == '\r') {
      if (next != std::string::npos && text_[next] == '\n') {
        at = next;
      } else {
        text_[at] = '\n';
        if (lone_return_ == kNone) lone_return_ = line;
      }
    }
    ++line;
  }
}

std::string_view Source::line(std::uint32_t index) const noexcept {
  std::string_view view(text_.data() + starts_[index], starts_[index + 1] - starts_[index]);
  while (!view.empty() && (view.back() == '\n' || view.back() == '\r')) view.remove_suffix(1);
  return view;
}

void Source::index_line(std::uint32_t index, std::vector<std::uint32_t>& open) {
  const std::string_view text = line(index);
  const Lexis& lexis = dialect_->lexis;
  const std::size_t first = skip_spaces(text, 0);
  if (holds_nothing(lexis, text, first)) {
    const bool marks = start_ == kNone && first < text.size() && text[first] == lexis.tape;
    if (marks) start_ = index + 1;
    return;
  }
  ++blocks_;
  std::size_t pos = first;
  if (lexis.label == LabelForm::quoted && (text[first] == '"' || text[first] == lexis.skip)) {
    std::string_view label;
    std::int32_t number = -1;
    pos = skip_prefix(*dialect_, text, number, label);
    if (!label.empty()) {
      const auto [at, fresh] = labels_.emplace(label, index);
      if (!fresh) duplicates_.push_back({index, at->second, label});
    }
  }
  if (dialect_->mark == nullptr) return;
  const LineMark mark = dialect_->mark(text, pos);
  if (mark.kind == LineMark::Kind::definition) {
    definitions_.emplace(index, mark.number);
  } else if (mark.kind == LineMark::Kind::repeat) {
    open.push_back(index);
  } else if (mark.kind == LineMark::Kind::end_of_repeat && !open.empty()) {
    partners_.emplace(index, open.back());
    partners_.emplace(open.back(), index);
    open.pop_back();
  }
}

template <typename Is>
std::uint32_t Source::find_line(std::uint32_t first, std::uint32_t last, Is is) const {
  const bool down = last >= first;
  for (std::uint32_t i = first; i < lines(); down ? ++i : --i) {
    std::int32_t number = -1;
    std::string_view label;
    const std::string_view text = line(i);
    if (!holds_nothing(dialect_->lexis, text, skip_spaces(text, 0))) {
      skip_prefix(*dialect_, text, number, label);
      if (is(number, label)) return i;
    }
    if (i == last) break;
  }
  return kNone;
}

std::uint32_t Source::find_label(std::string_view name, std::uint32_t first, std::uint32_t last) const {
  return find_line(first, last, [this, name](std::int32_t, std::string_view label) {
    return dialect_->lexis.named_words ? in_capitals(label) == in_capitals(name) : label == name;
  });
}

std::uint32_t Source::find_number(std::int32_t wanted, std::uint32_t first, std::uint32_t last) const {
  return find_line(first, last, [wanted](std::int32_t number, std::string_view) { return number == wanted; });
}

std::uint32_t Source::definition(std::int32_t number) const {
  for (const auto& [line, its_number] : definitions_)
    if (its_number == number) return line;
  return kNone;
}

std::pair<std::uint32_t, std::int32_t> Source::definition_at(std::uint32_t line) const {
  const auto next = definitions_.upper_bound(line);
  if (next == definitions_.begin()) return {kNone, 0};
  const auto at = std::prev(next);
  if (start_ != kNone && start_ > at->first && start_ <= line) return {kNone, 0};
  return *at;
}

std::uint32_t Source::behind_definition(std::uint32_t line) const {
  const auto next = definitions_.upper_bound(line);
  std::uint32_t behind = next == definitions_.end() ? lines() : next->first;
  if (start_ != kNone && start_ > line) behind = std::min(behind, start_);
  return behind;
}

std::uint32_t Source::label(std::string_view name) const {
  const auto at = labels_.find(name);
  return at == labels_.end() ? kNone : at->second;
}

std::uint32_t Source::repeat_partner(std::uint32_t line) const {
  const auto at = partners_.find(line);
  return at == partners_.end() ? kNone : at->second;
}

}  // namespace servogate::program
