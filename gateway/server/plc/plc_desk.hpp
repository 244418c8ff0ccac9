// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/compose/plc/logic_change.hpp"
#include "gateway/server/desk/outcome.hpp"
#include "gateway/server/request/caller.hpp"
#include "plc/types/type.hpp"

namespace servogate::gateway {

class Resident;

/// What clients do to the PLC of a running control: see its values, force them, load another program. Every
/// change goes through the gate as a request. For the desk's thread.
class PlcDesk {
 public:
  explicit PlcDesk(Resident& resident) : resident_(resident) {}

  /// Carries out `plc_load`, `plc_force`, `plc_release`, `plc_hold`, `plc_step`, `plc_go`, `plc_watch` or
  /// `plc_list`; the answer is what docs/control-socket.md says.
  Outcome carry_out(const nlohmann::json& request, const Caller& who);
  /// Lets go what a connection has forced, and the PLC where it holds it.
  void release_of(std::uint64_t connection);
  /// Who holds the PLC for single scans; empty: nobody.
  const std::string& held_by() const noexcept { return holder_; }
  /// All that is forced: name, value, who, and whether it stays.
  nlohmann::json forced() const;

 private:
  struct Force {
    std::string name, value, user;
    /// Of a packet place: the requests that let it go; none: a variable. Of characters one for each.
    std::vector<image::Request> places;
    std::uint64_t owner = 0;  ///< connection; 0: it stays
  };
  using json = nlohmann::json;
  struct Load;
  Outcome load(const json& request, const Caller& who);
  json loaded(Load& load, const Caller& who);
  json force(const json& request, const Caller& who);
  json release(const json& request, const Caller& who);
  json hold(const json& request, const Caller& who);
  json step(const json& request, const Caller& who);
  json go(const json& request, const Caller& who);
  json watch(const json& request, const Caller& who);
  json watch_body(const std::string& name, const Caller& who);
  json list(const json& request, const Caller& who);
  json times(json answer, const Caller& who);
  json change(const LogicChange& change, double value, const Caller& who);
  json ask(image::Request request, const Caller& who);
  bool let_go(const Force& force, const Caller& who);
  json force_places(std::vector<image::Request> requests, const Caller& who);
  const Force* force_of(const std::string& name) const;
  std::optional<std::string> forced_value(const std::string& name, const plc::Type& type) const;
  std::string log(const LogicChange& change, const json& told, const Caller& who);

  Resident& resident_;
  std::vector<Force> forces_;
  std::string holder_;         ///< name of who holds the PLC
  std::uint64_t held_by_ = 0;  ///< and the connection
};

}  // namespace servogate::gateway
