// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/source.hpp"

#include <cstring>

#include "kernel/program/reading/number.hpp"

namespace servogate::program {

namespace {

/// Behind the last character that is more than filling.
std::size_t last_of(std::string_view text) {
  constexpr std::string_view kFilling("\x1A\0 \t\r\n", 6);
  const std::size_t last = text.find_last_not_of(kFilling);
  return last == std::string_view::npos ? 0 : last + 1;
}

}  // namespace

Source::Source(std::string name, std::string text, std::string path)
    : name_(std::move(name)), path_(path.empty() ? name_ : std::move(path)), text_(std::move(text)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  // CP/M and its heirs end a text with 1Ah, and may fill the last record up.
  const std::size_t end_mark = text_.find_first_of("\x1A", last_of(text_));
  if (end_mark != std::string::npos) text_.erase(end_mark);
  put_line_ends();
  starts_.reserve(text_.size() / 24 + 2);
  starts_.push_back(0);
  const char* const begin = text_.data();
  const char* const end = begin + text_.size();
  for (const char* p = begin; p < end;) {
    const void* found = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    p = found == nullptr ? end : static_cast<const char*>(found) + 1;
    starts_.push_back(static_cast<std::uint32_t>(p - begin));
  }
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < lines(); ++i) index_line(i, open);
}

/// A CR that no LF follows ends a line as well. Those before an LF (CR CR LF, too) belong to it.
void Source::put_line_ends() {
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
  std::size_t i = 0;
  while (i < text.size() && is_space(text[i])) ++i;
  if (i == text.size() || text[i] == ';' || text[i] == '%') return;
  ++blocks_;
  if (text[i] == '/')
    for (++i; i < text.size() && is_space(text[i]);) ++i;
  if (i < text.size() && text[i] == '"') {
    const std::size_t close = text.find('"', i + 1);
    if (close != std::string_view::npos) {
      const std::string_view label = text.substr(i + 1, close - i - 1);
      const auto [at, fresh] = labels_.emplace(label, index);
      if (!fresh) duplicates_.push_back({index, at->second, label});
      i = close + 1;
    }
  }
  const std::size_t bracket = text.find('(', i);
  if (bracket == std::string_view::npos) return;
  std::size_t word = bracket + 1;
  while (word < text.size() && is_space(text[word])) ++word;
  const std::string_view code = text.substr(word, 3);
  if (code == "RPT") {
    open.push_back(index);
  } else if (code == "ERP" && !open.empty()) {
    partners_.emplace(index, open.back());
    partners_.emplace(open.back(), index);
    open.pop_back();
  }
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
