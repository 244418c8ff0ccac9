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
  /// Where a text lies that is larger than one wants to hold in memory.
  class Store {
   public:
    virtual ~Store() = default;
    virtual std::string_view content() const noexcept = 0;
    /// Bytes `from` to `to` are not looked at for a while; they have to read the same whenever they are.
    virtual void leave(std::size_t from, std::size_t to) const noexcept = 0;
    /// Another one of the pieces that `next` gives, up to the first empty one; nullptr: there is no room.
    virtual std::shared_ptr<const Store> hold(const std::function<std::string()>& next) const = 0;
  };

  ProgramText() = default;
  ProgramText(std::string text) {
    auto owned = std::make_shared<const std::string>(std::move(text));
    view_ = *owned;
    owner_ = std::move(owned);
  }
  ProgramText(const char* text) : ProgramText(std::string(text)) {}
  explicit ProgramText(std::shared_ptr<const Store> store)
      : view_(store->content()), store_(std::move(store)) {}

  std::string_view view() const noexcept { return view_; }
  /// Not nullptr: the text is in memory only where it is looked at.
  const Store* store() const noexcept { return store_.get(); }
  void leave(std::size_t from, std::size_t to) const noexcept {
    if (store_ != nullptr) store_->leave(from, to);
  }
  friend bool operator==(const ProgramText& a, const ProgramText& b) { return a.view_ == b.view_; }

 private:
  std::shared_ptr<const void> owner_;
  std::string_view view_;
  std::shared_ptr<const Store> store_;
};

}  // namespace servogate::program
