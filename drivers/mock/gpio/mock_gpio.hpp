// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/points/point_stage.hpp"
#include "firmware_if/image/simulated.hpp"

namespace servogate::mock {

/// Real position of a simulated axis in mm or degrees, machine coordinates: where the slide is, not where the
/// control believes it to be. `axis` = index in the machine file's order.
using AxisPosition = std::function<double(int axis)>;

/// Limit switch: active at and beyond `mm`, towards + or -. Active closes the contact; of an inverted input,
/// a normally closed switch, it opens it.
struct LimitSwitch {
  int axis = 0;
  double mm = 0.0;
  bool positive = true;
};
/// Home switch: active in [mm, mm + width].
struct HomeSwitch {
  int axis = 0;
  double mm = 0.0;
  double width_mm = 5.0;
};
/// An input that an operator or a test sets.
struct SetInput {
  bool on = false;
};
/// Counts of an encoder on two lines, which an operator or a test turns.
struct SetCounts {
  std::int32_t counts = 0;
};
using InputSource = std::variant<SetInput, LimitSwitch, HomeSwitch, SetCounts>;

/// Contact bounce: after a change the line flickers for half of `time_ns` to all of it, by the seed.
struct Bounce {
  image::Nanoseconds time_ns = 0;  ///< 0: none
  std::uint64_t seed = 1;
};

/// One input line and its place in packet A.
struct GpioInput {
  std::string name;
  InputSource source;
  image::PointRule rule;  ///< `inverted`: a switch is a normally closed one
  Bounce bounce;
};
/// One output line.
struct GpioOutput {
  std::string name;
  image::PointRule rule;
};

/// A simulated GPIO chip. As Simulated it follows the axes; as CycleDevice it moves lines to and from packet
/// A, and tells each edge with its time.
class MockGpio final : public image::CycleDevice, public image::Simulated {
 public:
  /// `source` = index in image.sources, -1: none. Without `position` switches stay off.
  MockGpio(std::vector<GpioInput> inputs, std::vector<GpioOutput> outputs, AxisPosition position = {},
           int source = -1);

  /// Sets where switches find the axes. Not while the loop runs.
  void follow(AxisPosition position) { position_ = std::move(position); }

  /// real-time safe.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// real-time safe.
  void send(image::ProcessImage& image) noexcept override;
  void advance_to(image::Nanoseconds t) override;

  /// Index of a line by name, -1: none.
  int input_index(std::string_view name) const noexcept;
  int output_index(std::string_view name) const noexcept;
  /// Turns an encoder there; nothing for a line that is none.
  void set_counts(std::size_t n, std::int32_t counts);
  /// Sets an operator's input; false for a switch that follows an axis.
  bool set_input(std::size_t n, bool on);
  /// Holds a line at a level whatever drives it (a stuck contact), and lets it go.
  void force_input(std::size_t n, bool on);
  void release_input(std::size_t n);
  /// From its next change on the contact bounces like this.
  void set_bounce(std::size_t n, const Bounce& bounce);
  /// The contact itself, before inversion, bounce included.
  bool input(std::size_t n) const noexcept { return lines_[n].level; }
  /// When it changed last, bounces included.
  image::Nanoseconds changed_ns(std::size_t n) const noexcept { return lines_[n].changed_ns; }
  /// The physical level of an output, after inversion.
  bool output(std::size_t n) const noexcept { return driven_[n]; }
  /// Changes of a line since the start, bounces included.
  std::uint64_t edges(std::size_t n) const noexcept { return lines_[n].edges; }
  std::uint64_t output_edges(std::size_t n) const noexcept { return output_edges_[n]; }
  /// The chip answers (true) or is unplugged: then its points have their values of loss and its quality is
  /// bad.
  void plug(bool plugged) noexcept { plugged_ = plugged; }
  /// Its edges and their times get lost, levels do not.
  void lose_edges(bool lost) noexcept { edges_lost_ = lost; }

 private:
  struct Line {
    bool contact = false;  ///< as driven
    bool level = false;    ///< as seen, with bounce
    bool started = false;
    double at = 0.0;  ///< where the axis of its switch was at t_ns_
    bool forced = false;
    bool forced_level = false;
    image::Nanoseconds settle_ns = 0;
    image::Nanoseconds next_flip_ns = 0;
    image::Nanoseconds changed_ns = 0;
    std::uint64_t edges = 0;
    /// Seen as driven, and no bounce under way.
    bool settled(bool wanted) const noexcept {
      return started && wanted == contact && level == contact && next_flip_ns >= settle_ns;
    }
  };
  static bool contact(const GpioInput& input, double at);
  double place_of_axis(const GpioInput& input) const;
  image::Nanoseconds crossing(std::size_t n, double at, image::Nanoseconds t) const;
  void move(std::size_t n, bool wanted, image::Nanoseconds t);
  void flip(std::size_t n, bool level, image::Nanoseconds t);

  std::vector<GpioInput> inputs_;
  std::vector<GpioOutput> outputs_;
  AxisPosition position_;
  image::PointStage stage_;  ///< inputs, then outputs
  std::vector<Line> lines_;
  std::vector<std::mt19937_64> random_;  ///< of each line; large, and asked only while it bounces
  std::vector<bool> driven_;
  std::vector<std::uint64_t> output_edges_;
  image::Nanoseconds t_ns_ = 0;
  bool plugged_ = true;
  bool edges_lost_ = false;
};

}  // namespace servogate::mock
