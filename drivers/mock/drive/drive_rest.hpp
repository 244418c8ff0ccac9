// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace servogate::mock {

/// Recognises that a drive stands still: a servo tick that leaves every bit of its state as it was would do
/// so again, and need not be done. The state is given as bytes; what they are is all the same to it.
class DriveRest {
 public:
  using Part = std::span<const std::byte>;
  template <typename T>
  static Part part(const T& object) noexcept {
    return std::as_bytes(std::span(&object, 1));
  }

  /// Memory that outlives it and does not move: all that a tick goes by and changes. Not real-time safe; the
  /// rest is.
  explicit DriveRest(std::vector<Part> parts) : parts_(std::move(parts)) {
    std::size_t all = 0;
    for (const Part& p : parts_) all += p.size();
    kept_.resize(all);
  }

  /// From outside nothing may have come since a tick that changed nothing.
  bool sure() const noexcept { return sure_; }
  /// Something may have come.
  void doubt() noexcept { sure_ = false; }
  /// It moves.
  void forget() noexcept { known_ = proved_ = sure_ = false; }
  /// Before a tick of a drive whose shaft stands. True: it is sure that it would change nothing.
  bool before_tick() noexcept {
    const bool same = known_ && equal();
    sure_ = same && proved_;
    if (!same) keep();
    return sure_;
  }
  /// Behind a tick that was done after all. `else_same`: what is not in the parts has not changed.
  void after_tick(bool else_same) noexcept { sure_ = proved_ = else_same && equal(); }

 private:
  bool equal() const noexcept {
    const std::byte* kept = kept_.data();
    for (const Part& p : parts_) {
      if (std::memcmp(p.data(), kept, p.size()) != 0) return false;
      kept += p.size();
    }
    return true;
  }
  void keep() noexcept {
    std::byte* kept = kept_.data();
    for (const Part& p : parts_) {
      std::memcpy(kept, p.data(), p.size());
      kept += p.size();
    }
    known_ = true;
    proved_ = false;
  }

  std::vector<Part> parts_;
  std::vector<std::byte> kept_;
  bool known_ = false;   ///< `kept_` is a state
  bool proved_ = false;  ///< a tick leaves it as it is
  bool sure_ = false;
};

}  // namespace servogate::mock
