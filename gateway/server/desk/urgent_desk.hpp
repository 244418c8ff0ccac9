// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "gateway/compose/control.hpp"
#include "gateway/server/desk/request_desk.hpp"
#include "gateway/server/request/caller.hpp"
#include "gateway/server/socket/line.hpp"

namespace servogate::gateway {

/// The road of what takes motion or energy away, and of the dead-men of jogs: on the socket's own thread,
/// which waits for nothing. A request is posted at once, whatever else the control is busy with, and its
/// answer is looked for now and then. For that one thread.
class UrgentDesk {
 public:
  using Give = std::function<void(const Ticket&, Reply)>;

  /// `speed`: machine seconds in a second of the wall clock.
  UrgentDesk(Control& control, RequestDesk& requests, double speed);
  ~UrgentDesk();

  /// A request that is_urgent(). nullopt: the answer comes by look(); until then the connection's
  /// `urgent_line` is this one.
  std::optional<Reply> take(const nlohmann::json& request, const Caller& caller, Connection& connection,
                            const Ticket& ticket, bool ending);
  /// Gives the answers that have come.
  void look(const Give& give);
  bool waits() const noexcept { return !pending_.empty(); }

  /// A continuous jog was begun for this connection. Without one (the client is gone meanwhile) it ends.
  void begin(const HeldJog& jog, Connection* connection);
  /// Now and then, at most kLookAtJogs_ms apart while a client jogs: ends each jog whose client has been
  /// silent for 100 ms of the wall clock. In real time and virtual time at its pace the cycle itself judges
  /// by its own time; where time is scaled the machine's seconds say nothing of a living hand.
  void watch(Connection& connection);
  /// The client is gone: what only its keep-alive permitted ends now.
  void let_go(Connection& connection);
  static constexpr int kLookAtJogs_ms = 10;

 private:
  struct Pending {
    Ticket ticket;
    std::uint64_t id = 0;
    Caller caller;
    const text::Entry* said = nullptr;
    std::chrono::steady_clock::time_point asked;
    std::optional<image::Answer> answer;
    std::int64_t answered_in = 0;  ///< cycle of the newest image when the answer came
  };
  Reply keep_alive(const nlohmann::json& request, const Caller& caller, Connection& connection);
  Reply ended(const HeldJog& jog, image::JogEnd end, bool others, text::Language language) const;
  const text::Entry& said_of_hold() const;
  std::optional<Reply> answer_of(Pending& pending);
  void stop(const HeldJog& jog);
  const image::ProcessImage& image();

  Control& control_;
  RequestDesk& requests_;
  double speed_;
  std::vector<Pending> pending_;
  std::unique_ptr<image::ProcessImage> image_;
};

}  // namespace servogate::gateway
