// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/machine/config.hpp"
#include "gateway/server/request/request_form.hpp"

namespace servogate::gateway {

/// Who has sent a request, and how it is to be answered.
struct Caller {
  image::Asker asker = image::Asker::command_line;
  std::uint64_t connection = 0;
  std::string user;  ///< name on the computer
  text::Language language = text::user_language();

  image::Hand hand() const noexcept { return {asker, static_cast<std::uint32_t>(connection)}; }
};

/// Fills asker and language from the request; false: nobody of that name may ask here.
bool read_caller(const nlohmann::json& request, Caller& caller, FormProblem& problem);

/// Index of the axis that `name` says; -1: the machine has none of that name.
int axis_of(const machine::MachineConfig& machine, const nlohmann::json& name, FormProblem& problem);

/// The request takes motion or energy away, or keeps a jog alive: it does not wait behind others.
bool is_urgent(const nlohmann::json& request);

}  // namespace servogate::gateway
