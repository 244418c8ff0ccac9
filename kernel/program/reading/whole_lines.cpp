// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/whole_lines.hpp"

namespace servogate::program {

bool WholeLines::next(std::string& lines) {
  const std::size_t to = behind_line();
  lines.assign(view_.substr(from_, to - from_));
  const auto ahead = static_cast<std::size_t>(view_.data() - text_->view().data());
  text_->leave(ahead + from_, ahead + to);
  from_ = to;
  put_line_ends(lines);
  return !lines.empty();
}

/// Behind the last line end of the window, the end of the text where a line is longer than that.
std::size_t WholeLines::behind_line() const noexcept {
  if (view_.size() - from_ <= kPiece) return view_.size();
  const std::string_view window = view_.substr(from_, kPiece);
  if (const std::size_t feed = window.rfind('\n'); feed != std::string_view::npos) return from_ + feed + 1;
  for (std::size_t at = window.size(); at-- > 0;) {
    const char behind = view_[from_ + at + 1];
    if (window[at] == '\r' && behind != '\r' && behind != '\n') return from_ + at + 1;
  }
  return view_.size();
}

void WholeLines::put_line_ends(std::string& lines) {
  for (std::size_t at = lines.find_first_of("\r\n"); at != std::string::npos;
       at = lines.find_first_of("\r\n", at + 1)) {
    const std::size_t next = lines.find_first_not_of('\r', at);
    if (lines[at] == '\r') {
      if (next != std::string::npos && lines[next] == '\n') {
        at = next;
      } else {
        lines[at] = '\n';
        if (lone_return_ == kNone) lone_return_ = line_;
      }
    }
    ++line_;
  }
}

}  // namespace servogate::program
