// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/pendant_port.hpp"
#include "firmware_if/pendant/hands.hpp"
#include "gateway/control/run/announce.hpp"
#include "gateway/control/server/protocol/command.hpp"
#include "gateway/control/server/protocol/reply.hpp"
#include "machine/load.hpp"

namespace servogate::gateway {

/// Asks the control for a pendant.
struct PendantAsks {
  std::function<std::uint64_t(ask::Command)> question;        ///< its number
  std::function<std::optional<Reply>(std::uint64_t)> answer;  ///< once; nullopt: it has not come
  image::Hand hand;                                           ///< whose jogs are the pendant's
};

/// A pendant at work. For one thread; not from a cycle. `loaded` and `port` outlive it.
class PendantSession {
 public:
  PendantSession(const machine::LoadResult& loaded, const machine::PendantConfig& pendant,
                 drivers::PendantPort& port, PendantAsks asks, Announce announce);
  PendantSession(const PendantSession&) = delete;

  /// Takes what has come from the pendant and asks for what follows, without waiting; at most 10 ms apart.
  /// `image`: the newest whole one; `now`: of the clock by which hands live.
  void step(const image::ProcessImage& image, image::Nanoseconds now);

 private:
  struct Axis {
    int index = -1;  ///< of the machine, -1: it has no such axis
    double room = 0.0, slow_room = 0.0;
  };
  struct Question {
    std::uint64_t number = 0;
    pendant::Request request;
  };
  void take_news(image::Nanoseconds now);
  void take_report(const pendant::ReportWriter::Bytes& report, image::Nanoseconds now);
  void tell_of_wheel();
  void observe(const image::ProcessImage& image, image::Nanoseconds now);
  void take_answers(image::Nanoseconds now);
  void told_refusal(const Reply& reply, image::Nanoseconds now);
  void show(const StatusReport& status);
  ask::Command command_of(const pendant::Request& request) const;
  const machine::AxisConfig& axis_config(int axis) const;
  void tell(const text::Entry& entry, std::vector<std::string> arguments) const;

  const machine::LoadResult& loaded_;
  const machine::PendantConfig& config_;
  drivers::PendantPort& port_;
  PendantAsks asks_;
  Announce announce_;
  const pendant::Layout layout_;
  const pendant::Rules rules_;
  pendant::ReportReader reader_{layout_};
  pendant::Hands hands_{layout_, rules_};
  std::vector<Axis> axes_;  ///< by Layout::axes
  int process_ = -1;        ///< whose programs it starts, from 0
  int path_process_ = -1;   ///< whose programs its wheel drives along their path, -1: none
  std::optional<image::Place> dead_man_;
  pendant::View view_;
  double feed_mm_s_ = 0.0;
  bool plugged_ = false;
  bool slept_ = false;  ///< the next report belongs to its being switched off
  std::optional<Question> question_;
  std::vector<Question> urgent_;    ///< whose answers are only said where they refuse
  std::int64_t seen_ = -1;          ///< cycle of the newest image
  image::Nanoseconds seen_at_ = 0;  ///< when it came
  int pictures_ = 0;                ///< of the machine since the last answer
  std::optional<std::uint64_t> status_;
  image::Nanoseconds shown_at_ = 0, garbage_told_at_ = 0, refusal_told_at_ = 0;
  std::string refusal_;
  std::uint64_t garbage_ = 0;
};

}  // namespace servogate::gateway
