// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace servogate::program {

/// The text of a part program, read-only and shared by all copies. Not real-time safe.
class ProgramText {
 public:
  /// Tells that bytes `from` to `to` are not looked at for a while; they have to read the same whenever they
  /// are.
  using Leave = std::function<void(std::size_t from, std::size_t to)>;

  ProgramText() = default;
  ProgramText(std::string text) {
    auto owned = std::make_shared<const std::string>(std::move(text));
    view_ = *owned;
    owner_ = std::move(owned);
  }
  ProgramText(const char* text) : ProgramText(std::string(text)) {}
  /// What `owner` keeps alive, of a file that is larger than one wants to hold in memory.
  ProgramText(std::shared_ptr<const void> owner, std::string_view view, Leave leave)
      : owner_(std::move(owner)), view_(view), leave_(std::make_shared<const Leave>(std::move(leave))) {}

  std::string_view view() const noexcept { return view_; }
  /// The text is in memory only where it is looked at.
  bool spooled() const noexcept { return leave_ != nullptr; }
  void leave(std::size_t from, std::size_t to) const {
    if (leave_ != nullptr) (*leave_)(from, to);
  }
  friend bool operator==(const ProgramText& a, const ProgramText& b) { return a.view_ == b.view_; }

 private:
  std::shared_ptr<const void> owner_;
  std::string_view view_;
  std::shared_ptr<const Leave> leave_;
};

}  // namespace servogate::program
