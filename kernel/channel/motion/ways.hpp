// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "kernel/path/planner.hpp"

namespace servogate::channel {

/// What the cycle wants of a way along the path of a held program.
struct WayOrder {
  std::uint32_t number = 0;  ///< rises with each
  bool forward = false;      ///< to where the program was held
  bool on_way = false;  ///< it stands on the way before; else where the program was held, and a way begins
  path::Tag tag;        ///< where it stands: of the element, and the path length to the end of that
  double to_go = 0.0;
  double distance = 0.0;     ///< back by so much path, mm (degrees where only rotary axes move), or
  std::uint32_t blocks = 0;  ///< to the begin of so many blocks, the one that it stands in included
  double feed = 0.0;         ///< mm/s (degrees/s), no faster than that; 0: as programmed, rapids as rapids
};

/// Ways from the feeder to the cycle, one at a time.
struct WayLink {
  explicit WayLink(const path::Config& config) : track(small(config)) {}
  path::Track track;

  struct Begin {
    path::Track::Begin track;
    double from = 0.0, to = 0.0;  ///< path back to where the program was held, at begin and end
    bool home = false;            ///< it ends there
  };
  /// Feeder: written before the first entry of the way is published.
  void begin(std::uint32_t number, const Begin& at) noexcept {
    begins[number % begins.size()] = at;
    begun.store(number, std::memory_order_release);
  }
  /// Cycle: nullptr while the feeder has not begun this way. real-time safe.
  const Begin* begin_of(std::uint32_t number) const noexcept {
    return begun.load(std::memory_order_acquire) == number ? &begins[number % begins.size()] : nullptr;
  }
  static path::Config small(path::Config config) {
    config.piece_capacity = 0;
    return config;
  }
  std::array<Begin, 4> begins{};
  std::atomic<std::uint32_t> begun{0};
};

/// The elements of a run as the path was given them, and ways along them: back from where the program is
/// held, and forward again. A way is a path of its own, with the programmed shapes, feeds and tolerances. It
/// does not go back over a tool, spindle, M or H function. Memory is bounded. Outside the cycle; not
/// real-time safe.
class Ways {
 public:
  /// Elements that are kept, those that are planned ahead included.
  static constexpr std::size_t kKept = 16'384;

  Ways(const path::Config& config, WayLink& link);

  /// A run begins.
  void restart();
  /// The path goes on with an element from `from`.
  void add(const path::Element& element, const path::Vector& from);
  /// No way leads back over this place.
  void bar() noexcept { barred_ = true; }
  /// Plans a way from `at` and begins it in the link; one that has nowhere to go ends where it begins.
  void plan(const WayOrder& order, const path::Vector& at);
  /// Publishes what has room. Bounded.
  void work() { planner_.work(); }
  /// Something waits for room.
  bool waits() const { return planner_.waits(); }

 private:
  struct Driven {
    path::Element element;
    path::Vector from{};
    double length = 0.0;
    bool barred = false;  ///< at its begin
  };
  /// `s` along the element of that number.
  struct Place {
    std::uint64_t element = 0;
    double s = 0.0;
  };
  struct Part {
    std::uint64_t element;
    double begin, end;
  };

  const Driven& driven(std::uint64_t number) const { return driven_[number - first_]; }
  path::Piece piece(const Driven& d) const { return path::shape(config_, d.from, d.element).piece; }
  std::optional<Place> find(const path::Tag& tag, double to_go, const path::Vector& at) const;
  std::optional<Place> on_way(const path::Tag& tag, double to_go, const path::Vector& at) const;
  Place back(double distance, std::uint32_t blocks);
  Place forward();
  double behind_home(const Place& place) const;
  void put(const Part& part, bool last, const path::Vector& at, double feed);
  void join(const path::Element& like, const path::Vector& to, std::uint64_t tag);

  path::Config config_;
  WayLink& link_;
  path::Planner planner_;
  std::deque<Driven> driven_;
  std::uint64_t first_ = 0;  ///< number of the first that is kept
  bool barred_ = false;
  std::vector<Part> parts_;  ///< of the way in force
  Place here_, home_;
  path::Vector home_at_{};
  bool known_ = false;  ///< home_ is
};

}  // namespace servogate::channel
