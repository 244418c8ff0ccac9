// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/control/compose/control.hpp"
#include "report/report.hpp"

namespace servogate::gateway {

/// What `servogate run --force` holds, from before the drives come on to the end of the run: requests through
/// the gate like anybody's, one after the other, so that a record holds them.
class RunForces {
 public:
  explicit RunForces(Control& control) : control_(control) {}

  /// Before the first cycle. A finding: there is no such variable or place, or no such value of it.
  std::vector<text::Finding> plan(const std::vector<report::ForceEntry>& wanted);
  /// Posts the next one, once the one before it is answered.
  void poll();
  /// Takes an answer; false: it is of somebody else, or a refusal, which ends the matter.
  bool take(const image::Answer& answer);
  /// All are in force, or one was refused.
  bool done() const noexcept { return refused_ || (!waits_ && next_ == steps_.size()); }
  /// Those that the gate has agreed to.
  const std::vector<report::ForceEntry>& active() const noexcept { return active_; }

 private:
  struct Step {
    image::Request request;  ///< of a packet place
    int entry = 0;           ///< index of wanted_
    bool variable = false;
    bool last = false;  ///< of its entry
  };
  static constexpr std::uint64_t kFirstId = 1'000'000'000;

  Control& control_;
  std::vector<report::ForceEntry> wanted_, active_;
  std::vector<Step> steps_;
  std::size_t next_ = 0;
  bool waits_ = false, refused_ = false;
};

}  // namespace servogate::gateway
