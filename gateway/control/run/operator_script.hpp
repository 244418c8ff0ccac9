// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::gateway {

/// Whether an alarm stands that is more than a warning.
bool fault_stands(const cycle::AlarmSnapshot& alarms) noexcept;

/// What `servogate run` does in an operator's place, one step after the other, by requests like anybody's:
/// drives on, home what is not homed, AUTO, start, wait for the end, drives off. With `wait_for_start`
/// nothing happens before the start button is pressed: that switches the drives on and homes, the next press
/// starts.
class OperatorScript {
 public:
  enum class Stage { button, power, homing, start, running, power_off, done };
  /// How it went. `waited`: nothing moved any more, and nobody did what the program waited for.
  enum class Outcome { under_way, finished, alarm, stopped, refused, waited };

  struct Wishes {
    bool program = true;  ///< false: only drives on and homing
    double override_ratio = 1.0;
    bool wait_for_start = false;              ///< a person at the machine starts everything
    std::optional<image::Place> start_place;  ///< of that person's button; needed with wait_for_start
    int start_source = -1;                    ///< whose age says whether the button is known, -1: nobody's
    double patience_s = 0.0;           ///< machine time that a program may wait for somebody; 0: for ever
    double homing_patience_s = 300.0;  ///< machine time in which all axes have homed, or never will
    std::vector<std::string> letters;  ///< of the axes that programs move; auxiliary ones are the PLC's
    std::vector<bool> needs_homing;
    std::function<bool()> fault;  ///< fault_stands(); asked only while there is any alarm
  };
  using Post = std::function<bool(const image::Request&)>;

  OperatorScript(Wishes wishes, Post post);

  /// Looks at the image of a cycle and posts what comes next.
  void poll(const image::ProcessImage& image);
  /// An answer of the gate to one of its requests.
  void take(const image::Answer& answer);
  /// Ctrl-C: the first time a controlled stop on the path, then drives off; the second time a quick stop.
  void interrupt();

  bool done() const noexcept { return stage_ == Stage::done; }
  Stage stage() const noexcept { return stage_; }
  /// The stage in which the outcome came about; before that, the present one.
  Stage came_to() const noexcept { return stage_ >= Stage::power_off ? ended_in_ : stage_; }
  Outcome outcome() const noexcept { return outcome_; }
  const image::Answer& refusal() const noexcept { return refusal_; }
  /// What the program waited for when the outcome is `waited`.
  const image::Wait& given_up() const noexcept { return given_up_; }
  /// Axes that never came to what the stage waits for, with the state of their drives, for the message.
  const std::vector<std::string>& waiting_for() const noexcept { return waiting_for_; }

 private:
  void send(image::RequestKind kind, double value = 0.0);
  /// The request in the mode that it needs: both happen, or neither.
  void send_in(image::Mode mode, image::RequestKind kind);
  void enter(Stage stage, const image::ProcessImage& image);
  void stop_where_interrupted();
  bool standing(const image::ProcessImage& image) const;
  /// Something stands in the way that is more than a warning.
  bool failed(const image::ProcessImage& image) const;
  /// Whether an axis is not `good(axis, index)`; those are what is waited for.
  template <class Good>
  bool missing(const image::ProcessImage& image, Good&& good);
  // One stage each.
  void await_button(const image::ProcessImage& image);
  void switch_on(const image::ProcessImage& image);
  void home(const image::ProcessImage& image);
  void start(const image::ProcessImage& image);
  void follow(const image::ProcessImage& image);
  void switch_off(const image::ProcessImage& image);
  void give_up(const image::ProcessImage& image);
  void power_down(Outcome outcome, const image::ProcessImage& image);
  double in_stage(const image::ProcessImage& image) const;

  Wishes wishes_;
  Post post_;
  Stage stage_, ended_in_ = Stage::done;
  Outcome outcome_ = Outcome::under_way;
  image::Answer refusal_;
  image::Answer last_refusal_;  ///< of a request that is asked again
  std::vector<std::string> waiting_for_;
  image::Wait given_up_;
  image::Nanoseconds entered_ns_ = 0;
  std::uint64_t next_id_ = 1;
  bool asked_ = false;
  bool homing_begun_ = false;
  image::Nanoseconds released_ns_ = -1;  ///< since when the start button is known to be released
  int interrupts_ = 0, interrupts_done_ = 0;
};

}  // namespace servogate::gateway
