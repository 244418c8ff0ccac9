// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/control/server/resident/work/outcome.hpp"
#include "gateway/control/server/protocol/caller.hpp"
#include "gateway/control/server/protocol/command.hpp"
#include "plc/logic/logic_change.hpp"
#include "plc/types/type.hpp"

namespace servogate::gateway {

class Resident;

/// What clients do to the PLC of a running control: see its values, force them, load another program. Every
/// change goes through the gate as a request. For the desk's thread.
class PlcDesk {
 public:
  explicit PlcDesk(Resident& resident) : resident_(resident) {}

  /// Carries out what is ask::of_plc().
  Outcome carry_out(const ask::Command& command, const Caller& who);
  /// Lets go what a connection has forced, and the PLC where it holds it. What guards motion or energy stays
  /// forced until the machine stands; look_after() sees to it.
  void release_of(std::uint64_t connection);
  /// Now and then: what is left of connections that are gone.
  void look_after();
  /// Who holds the PLC for single scans; empty: nobody.
  const std::string& held_by() const noexcept { return holder_; }
  /// All that is forced: name, value, who, and whether it stays.
  std::vector<ForcedValue> forced() const;

 private:
  struct Force {
    std::string name, value, user;
    /// Of a packet place: the requests that let it go; none: a variable. Of characters one for each.
    std::vector<image::Request> places;
    std::uint64_t owner = 0;  ///< connection; 0: it stays
    bool left = false;        ///< its connection is gone
  };
  struct Load;
  Outcome take(const ask::PlcLoad& wanted, const Caller& who);
  Outcome take(const ask::PlcForce& wanted, const Caller& who);
  Outcome take(const ask::PlcRelease& wanted, const Caller& who);
  Outcome take(const ask::PlcHold& wanted, const Caller& who);
  Outcome take(const ask::PlcStep& wanted, const Caller& who);
  Outcome take(const ask::PlcGo& wanted, const Caller& who);
  Outcome take(const ask::PlcWatch& wanted, const Caller& who);
  Outcome take(const ask::PlcList& wanted, const Caller& who);
  Reply loaded(Load& load, const Caller& who);
  Outcome watch_body(const std::string& name, const Caller& who);
  Reply change(const plc::LogicChange& change, double value, const Caller& who);
  /// What the gate answers; accepted: nothing but that.
  Reply ask(image::Request request, const Caller& who);
  Reply let_go(const Force& force, const Caller& who);
  void let_go_left();
  Reply force_places(std::vector<image::Request> requests, const Caller& who);
  const Force* force_of(const std::string& name) const;
  std::optional<std::string> forced_value(const std::string& name, const plc::Type& type) const;
  PlcValue value_of(const std::string& shown, const std::string& name, const plc::Type& type,
                    std::string text) const;

  Resident& resident_;
  std::vector<Force> forces_;
  std::string holder_;         ///< name of who holds the PLC
  std::uint64_t held_by_ = 0;  ///< and the connection
};

}  // namespace servogate::gateway
