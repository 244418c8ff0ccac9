// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "firmware_if/image/time.hpp"
#include "firmware_if/pendant/display.hpp"
#include "firmware_if/pendant/report.hpp"

namespace servogate::pendant {

/// What a pendant may do at this machine.
struct Rules {
  std::string axes;       ///< letters of those that it may move
  double max_step = 0.1;  ///< mm or degrees a count; a longer step of the pendant is shortened to it
  int dead_man = -1;      ///< button without which nothing begins to move; -1: there is none
};

/// An axis as the pendant's client sees it now.
struct AxisView {
  bool jogs = false;     ///< its process is in manual mode, or its program is held
  bool moves = false;    ///< by this pendant's jog
  bool stopped = false;  ///< its last jog, which was this pendant's, was ended by a request
  double to_go = 0.0;    ///< of that jog, with its sign
  double room = 0.0;     ///< braking way and 50 ms at jogging speed: more it may not have to go by counts
  double work = 0.0, machine = 0.0;
};

/// The machine as the pendant's client sees it now. Axes by their index in Layout::axes.
struct View {
  std::array<AxisView, kMostAxes> axes;
  bool current = false;  ///< it is newer than the last answer
  bool released = true;  ///< the dead-man that is wired, where there is one, is held
  bool running = false;  ///< a program
  bool held = false;     ///< it is held
  bool by_path = false;  ///< the wheel drives the program along its path
  bool powered = false;  ///< any axis
  bool alarm = false;    ///< one stands
  double override_percent = 100.0;
};

enum class RequestKind : std::uint8_t {
  jog,         ///< axis, value = way
  jog_on,      ///< axis, value = +1 or -1; from then on kept alive
  keep_alive,  ///< axis
  jog_stop,    ///< axis
  stop,
  hold,
  start,
  resume,
  reset,
  power,          ///< value 1 or 0
  home,           ///< all
  zero,           ///< axis
  override_feed,  ///< value = per cent
  mdi,            ///< text
  path_wheel,     ///< value 1: the wheel drives the program along its path, 0: no more
  path_turned,    ///< value = counts, for that
};
/// What is asked of the control. Axes by their index in Layout::axes.
struct Request {
  RequestKind kind = RequestKind::stop;
  int axis = -1;
  double value = 0.0;
  const std::string* text = nullptr;  ///< of Layout::bindings
};

/// The hands at one pendant: reports in, requests out. Layout and rules outlive it. What must not wait (an
/// end of a jog, a stop) comes before everything else; one other request at a time is under way. Nothing
/// moves by what a pendant says first: a button that is pressed, a wheel that has turned and a ring that is
/// held when it is plugged in do nothing until the hand lets go of them, and are no dead-man. What begins
/// motion is asked for only while its button and the dead-man are held. real-time safe.
class Hands {
 public:
  Hands(const Layout& layout, const Rules& rules) noexcept : layout_(&layout), rules_(&rules) {}

  /// The machine now; before each next().
  void see(const View& view) noexcept;
  void take(const Reading& reading) noexcept;
  /// Unplugged, or what it says cannot be trusted: what it jogs ends.
  void lost() noexcept;

  /// The next request; false: there is none now. A request that is_urgent() has no answered().
  bool next(Request& request, image::Nanoseconds now) noexcept;
  void answered(const Request& request, bool accepted) noexcept;
  /// Takes motion or energy away.
  static bool is_urgent(const Request& r) noexcept {
    return r.kind == RequestKind::jog_stop || r.kind == RequestKind::stop || r.kind == RequestKind::hold ||
           (r.kind == RequestKind::power && r.value == 0.0);
  }

  int selected() const noexcept { return selected_; }
  int step() const noexcept { return step_; }
  bool machine_coordinates() const noexcept { return machine_coordinates_; }
  /// Counts that moved nothing: not permitted then, or more than the axis could follow.
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  static constexpr int kQueue = 8;
  static constexpr image::Nanoseconds kKeepAlive = 30 * image::kMillisecond;
  bool pressed(int button) const noexcept { return button >= 0 && (now_.buttons >> button & 1u) != 0; }
  const Binding* binding_of(int button) const noexcept;
  bool shifted() const noexcept;
  bool held() const noexcept;
  bool permitted(int axis) const noexcept;
  bool is_mine(int axis) const noexcept;
  double step_length() const noexcept;
  void press(const Binding& binding) noexcept;
  void select() noexcept;
  void drop(int counts) noexcept { dropped_ += static_cast<std::uint64_t>(counts < 0 ? -counts : counts); }
  void drop_pending() noexcept;
  void turn(int counts, bool same) noexcept;
  void begin_end(int axis) noexcept;
  void queue(const Request& request) noexcept;
  void stop(bool& which) noexcept;
  void ring() noexcept;
  bool next_jog(Request& request) noexcept;

  const Layout* layout_;
  const Rules* rules_;
  View view_;
  Reading now_;
  bool known_ = false;  ///< a report has come since it was plugged in
  int chosen_ = -1;     ///< by `select`
  int selected_ = -1, step_ = -1;
  bool machine_coordinates_ = false;
  int pending_ = 0;      ///< counts that were not asked for yet
  int path_turned_ = 0;  ///< the same, along the path
  int wheel_axis_ = -1;  ///< that the wheel has moved last, and may still move
  int blocked_ = -1;     ///< axis that somebody has stopped: it is to be selected anew
  int ring_axis_ = -1;   ///< that the ring jogs
  int ring_sign_ = 0;
  bool ring_armed_ = false;  ///< it was seen at rest
  image::Nanoseconds kept_alive_ = 0;
  bool under_way_ = false;  ///< a request that is not urgent
  bool stop_ = false, hold_ = false,
       power_off_ = false;   ///< asked for before everything else; a lost pendant keeps them
  std::uint32_t stuck_ = 0;  ///< buttons that were pressed when it came, and have not been released since
  int pressed_now_ = -1;     ///< button whose meaning is carried out
  std::uint32_t ends_ = 0;   ///< axes whose jog is to end, as bits
  struct Queued {
    Request request;
    int button = -1;
  };
  std::array<Queued, kQueue> queue_;
  int queued_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace servogate::pendant
