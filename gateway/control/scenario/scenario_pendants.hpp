// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/server/pendant/pendant_session.hpp"

namespace servogate::gateway {

/// The simulated pendants of a machine in a scenario, on the thread that steps the machine; hands live by the
/// machine's time. Real ones have no part in a scenario.
class ScenarioPendants {
 public:
  /// Asks for a pendant, and gives its answer; the machine may have moved on meanwhile.
  using Ask = std::function<Reply(const ask::Command&, const image::Hand&)>;

  explicit ScenarioPendants(Control& control);
  ScenarioPendants(const ScenarioPendants&) = delete;

  /// Behind every cycle.
  void poll(const image::ProcessImage& image, const Ask& ask);

 private:
  struct Pendant {
    image::Hand hand;
    std::vector<std::pair<std::uint64_t, ask::Command>> asked;  ///< not carried out yet
    std::map<std::uint64_t, Reply> answers;
    std::uint64_t last = 0;
    std::unique_ptr<PendantSession> session;
  };
  std::vector<std::unique_ptr<Pendant>> pendants_;
  bool polling_ = false;
};

}  // namespace servogate::gateway
