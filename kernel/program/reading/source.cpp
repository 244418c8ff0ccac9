// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/source.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <memory>

#include "kernel/program/reading/block.hpp"
#include "kernel/program/reading/whole_lines.hpp"

namespace servogate::program {

namespace {

/// Behind the last character that is more than filling.
std::size_t last_of(std::string_view text) {
  constexpr std::string_view kFilling("\x1A\0 \t\r\n", 6);
  const std::size_t last = text.find_last_not_of(kFilling);
  return last == std::string_view::npos ? 0 : last + 1;
}

constexpr std::size_t kWindow = std::size_t{4} << 20;  ///< bytes of a text that stay in memory together

std::string_view without_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

/// The text has Cyrillic letters, or a CR that ends a line alone.
bool needs_rewriting(std::string_view view, const ProgramText& text) {
  const auto ahead = static_cast<std::size_t>(view.data() - text.view().data());
  for (std::size_t from = 0; from < view.size(); from += kWindow) {
    const std::string_view part = view.substr(from, kWindow);
    if (any_cyrillic(part)) return true;
    for (std::size_t at = part.find('\r'); at != std::string_view::npos; at = part.find('\r', at)) {
      at = std::min(part.find_first_not_of('\r', at), part.size());
      const std::size_t next = view.find_first_not_of('\r', from + at);
      if (at < part.size() ? part[at] != '\n' : next == std::string_view::npos || view[next] != '\n')
        return true;
    }
    text.leave(ahead + from, ahead + from + part.size());
  }
  return false;
}

}  // namespace

Source::Source(const Dialect& dialect, std::string name, ProgramText text, std::string path)
    : dialect_(&dialect),
      name_(std::move(name)),
      path_(path.empty() ? name_ : std::move(path)),
      text_(std::move(text)),
      view_(text_.view()) {
  if (view_.starts_with("\xEF\xBB\xBF")) view_.remove_prefix(3);
  // CP/M and its heirs end a text with 1Ah, and may fill the last record up.
  if (const std::size_t end_mark = view_.find_first_of('\x1A', last_of(view_)); end_mark != std::string::npos)
    view_ = view_.substr(0, end_mark);
  if (needs_rewriting(view_, text_)) rewrite();
  if (dialect.lexis.starts_at_tape) start_ = kNone;
  std::vector<std::uint32_t> open;
  marks_.reserve(view_.size() / 24 / kStride + 2);
  const char* const begin = view_.data();
  const char* const end = begin + view_.size();
  for (const char* p = begin; p < end; ++lines_) {
    const auto offset = static_cast<std::size_t>(p - begin);
    if (lines_ % kStride == 0) marks_.push_back(static_cast<std::uint32_t>(offset));
    const void* found = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    const char* const last = found == nullptr ? end : static_cast<const char*>(found);
    index_line(lines_, without_end({p, static_cast<std::size_t>(last - p)}), open);
    pass(offset);
    p = found == nullptr ? end : last + 1;
  }
}

/// Texts of old computers and with look-alike letters are kept as they are read: beside the text itself where
/// that is large, in memory otherwise.
void Source::rewrite() {
  std::string lines;
  LookAlikes labels(dialect_->lexis);
  for (WholeLines all(view_, text_); all.next(lines);) labels.collect_labels(lines);
  for (const ProgramText::Store* store : {text_.store(), static_cast<const ProgramText::Store*>(nullptr)}) {
    WholeLines all(view_, text_);
    LookAlikes letters = labels;
    const auto next = [&] {
      if (all.next(lines)) letters.read(lines);
      return std::move(lines);
    };
    std::shared_ptr<const ProgramText::Store> held;
    std::string whole;
    if (store != nullptr)
      held = store->hold(next);
    else
      for (std::string piece = next(); !piece.empty(); piece = next()) whole += piece;
    if (store != nullptr && held == nullptr) continue;
    lone_return_ = all.lone_return();
    look_alikes_ = letters.told();
    more_look_alikes_ = letters.untold();
    text_ = held != nullptr ? ProgramText(std::move(held)) : ProgramText(std::move(whole));
    view_ = text_.view();
    return;
  }
}

/// What lies two windows behind a place that is read may leave memory.
void Source::pass(std::size_t offset) const noexcept {
  if (text_.store() == nullptr) return;
  const std::size_t window = offset / kWindow, before = window_.exchange(window, std::memory_order_relaxed);
  if (window == before) return;
  const std::size_t ahead = static_cast<std::size_t>(view_.data() - text_.view().data());
  if (before + 1 != window) return text_.leave(ahead + before * kWindow, ahead + (before + 1) * kWindow);
  if (window >= 2) text_.leave(ahead + (window - 2) * kWindow, ahead + (window - 1) * kWindow);
}

std::string_view Source::line(std::uint32_t index) const noexcept {
  const char* const end = view_.data() + view_.size();
  const char* at = view_.data() + marks_[index / kStride];
  const auto line_end = [end](const char* from) {
    const void* found = std::memchr(from, '\n', static_cast<std::size_t>(end - from));
    return found == nullptr ? end : static_cast<const char*>(found);
  };
  for (std::uint32_t n = index % kStride; n > 0; --n) at = line_end(at) + 1;
  pass(static_cast<std::size_t>(at - view_.data()));
  return without_end({at, static_cast<std::size_t>(line_end(at) - at)});
}

void Source::index_line(std::uint32_t index, std::string_view text, std::vector<std::uint32_t>& open) {
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
