// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/server/protocol/reply.hpp"
#include "gateway/control/server/resident/work/question.hpp"

namespace servogate::gateway {

/// The road of what takes motion or energy away, and of the dead-men of jogs. Nothing here waits: a request
/// is posted at once, whatever else the control is busy with, and its answer is looked for now and then. For
/// one thread at a time.
class UrgentDesk {
 public:
  /// `speed`: machine seconds in a second of the wall clock; 0: whoever asks steps the machine, and nothing
  /// here looks at the wall clock.
  UrgentDesk(Control& control, RequestDesk& requests, double speed);
  ~UrgentDesk();

  /// A question that is_urgent(), but the end of the control. nullopt: its answer comes by look().
  std::optional<Reply> take(const Question& question, bool ending);
  /// The answers that have come.
  std::vector<std::pair<Ticket, Reply>> look();
  bool waits() const noexcept { return !pending_.empty(); }

  /// A continuous jog was begun for this client.
  void begin(std::uint64_t client, const JogBegun& jog);
  /// And ends at once: its client is gone meanwhile.
  void end(const JogBegun& jog) { stop(jog.axis, jog.hand); }
  /// Now and then, at most 10 ms apart while a client jogs: ends each jog whose client has been silent for
  /// 100 ms of the wall clock. In real time and virtual time at its pace the cycle itself judges by its own
  /// time; where time is scaled the machine's seconds say nothing of a living hand.
  void watch();
  bool jogs() const noexcept { return !jogs_.empty(); }
  /// The client is gone: what only its keep-alive permitted ends now.
  void let_go(std::uint64_t client);

 private:
  struct HeldJog {
    int axis = 0;
    image::Hand hand;                               ///< that holds it
    std::chrono::steady_clock::time_point heard{};  ///< when that client last kept it alive
    std::chrono::steady_clock::time_point told{};   ///< when the cycle was last told so
    bool silent = false;                            ///< it was ended because its client had fallen silent
  };
  struct Pending {
    Ticket ticket;
    std::uint64_t id = 0;
    text::Language language = text::Language::english;
    const text::Entry* said = nullptr;
    std::chrono::steady_clock::time_point asked;
    std::optional<image::Answer> answer;
    std::int64_t answered_in = 0;  ///< cycle of the newest image when the answer came
  };
  /// So much of the wall clock has passed since then, where it counts.
  bool passed(std::chrono::steady_clock::time_point since, std::chrono::milliseconds time) const {
    return speed_ > 0.0 && std::chrono::steady_clock::now() - since >= time;
  }
  static std::optional<image::JogEnd> end_of(const HeldJog& jog, const image::AxisImage& axis);
  Reply keep_alive(const ask::KeepAlive& wanted, const Question& question);
  Reply ended(const HeldJog& jog, image::JogEnd end, bool others, text::Language language) const;
  const text::Entry& said_of_hold(int process) const;
  std::optional<Reply> answer_of(Pending& pending);
  void stop(int axis, const image::Hand& hand);
  const image::ProcessImage& image();

  Control& control_;
  RequestDesk& requests_;
  double speed_;
  std::vector<Pending> pending_;
  std::map<std::uint64_t, std::vector<HeldJog>> jogs_;  ///< by client, one an axis at most
  std::unique_ptr<image::ProcessImage> image_;
};

}  // namespace servogate::gateway
