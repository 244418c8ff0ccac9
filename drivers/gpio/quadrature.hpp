// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware_if/image/time.hpp"

namespace servogate::gpio {

/// Counts the edges of an encoder with two tracks, four for each of its periods: up while A leads B, that is
/// while A rises with B low. real-time safe.
class Quadrature {
 public:
  /// Takes the levels without counting: the first ones.
  void seat(bool a, bool b) noexcept {
    a_ = a;
    b_ = b;
  }
  /// A track has changed to `level`. Where it had that level already, an edge is missing: counted as an
  /// error, and nothing moves.
  void edge(bool track_b, bool level) noexcept {
    bool& track = track_b ? b_ : a_;
    if (track == level) {
      ++errors_;
      return;
    }
    track = level;
    count_ += static_cast<std::uint32_t>((a_ != b_) != track_b ? 1 : -1);
  }
  /// The levels as they are read after edges were lost. One track that differs is a step; both are an error,
  /// since their way round is not known.
  void settle(bool a, bool b) noexcept {
    if (a != a_ && b != b_) {
      ++errors_;
      seat(a, b);
    } else if (a != a_) {
      edge(false, a);
    } else if (b != b_) {
      edge(true, b);
    }
  }
  /// Goes round the ends of its 32 bits.
  std::int32_t count() const noexcept { return static_cast<std::int32_t>(count_); }
  /// Transitions that no turning encoder makes, since the start.
  std::uint32_t errors() const noexcept { return errors_; }

 private:
  bool a_ = false, b_ = false;
  std::uint32_t count_ = 0, errors_ = 0;
};

/// The same from edges whose tracks overtake each other: the kernel serves each line in a thread of its own,
/// and only the times of the interrupts tell which was first. real-time safe.
class OrderedQuadrature {
 public:
  /// So many edges another one may have overtaken.
  static constexpr std::size_t kWindow = 8;

  void seat(bool a, bool b) noexcept { now_.seat(a, b), before_ = now_; }
  void edge(bool track_b, bool level, image::Nanoseconds t) noexcept {
    if (count_ == kWindow) {
      before_.edge(edges_[0].track_b, edges_[0].level);
      for (std::size_t n = 1; n < kWindow; ++n) edges_[n - 1] = edges_[n];
      --count_;
    }
    std::size_t at = count_++;
    for (; at > 0 && edges_[at - 1].t > t; --at) edges_[at] = edges_[at - 1];
    edges_[at] = {t, track_b, level};
    if (at + 1 == count_) return now_.edge(track_b, level);
    now_ = before_;
    for (std::size_t n = 0; n < count_; ++n) now_.edge(edges_[n].track_b, edges_[n].level);
  }
  void settle(bool a, bool b) noexcept {
    now_.settle(a, b);
    before_ = now_;
    count_ = 0;
  }
  std::int32_t count() const noexcept { return now_.count(); }
  std::uint32_t errors() const noexcept { return now_.errors(); }

 private:
  struct Edge {
    image::Nanoseconds t = 0;
    bool track_b = false, level = false;
  };
  Quadrature before_, now_;  ///< without the edges of the window, and with them
  std::array<Edge, kWindow> edges_{};
  std::size_t count_ = 0;
};

}  // namespace servogate::gpio
