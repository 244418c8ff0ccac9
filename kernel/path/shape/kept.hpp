// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

namespace servogate::path {

/// A growing sequence of which only the end is kept: numbers of places stay what they were when the beginning
/// is forgotten, and lie in memory one behind the other. Not real-time safe.
template <class T>
class Kept {
 public:
  void clear() {
    items_.clear();
    base_ = begin_ = 0;
  }
  void push_back(const T& item) { items_.push_back(item); }
  /// Number of the first that is kept, and of the next one to come.
  std::size_t begin() const { return begin_; }
  std::size_t end() const { return base_ + items_.size(); }
  bool empty() const { return begin_ == end(); }
  T& operator[](std::size_t n) { return items_[n - base_]; }
  const T& operator[](std::size_t n) const { return items_[n - base_]; }
  T& back() { return items_.back(); }
  const T& back() const { return items_.back(); }
  /// All before number `n` may go.
  void forget_before(std::size_t n) {
    if (n > end()) n = end();
    if (n > begin_) begin_ = n;
    if (begin_ - base_ < 64 || begin_ - base_ < items_.size() / 2) return;
    items_.erase(items_.begin(), items_.begin() + static_cast<std::ptrdiff_t>(begin_ - base_));
    base_ = begin_;
  }

 private:
  std::vector<T> items_;
  std::size_t base_ = 0, begin_ = 0;
};

}  // namespace servogate::path
