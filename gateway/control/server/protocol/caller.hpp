// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// Why a question cannot be taken: a sentence of says:: and its arguments.
struct FormProblem {
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
  text::Language language = text::user_language();  ///< in which it is asked, as far as that can be read
};

/// Who has sent a request, and how it is to be answered.
struct Caller {
  image::Asker asker = image::Asker::command_line;
  std::uint64_t connection = 0;  ///< the client's number at the desk
  std::string user;              ///< name on the computer
  text::Language language = text::user_language();
  /// From then on the request may have lain, in the socket too.
  std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  bool left = false;  ///< its connection had ended when the request was taken from it
  /// Becomes true when the client is gone; none: nobody can go. Set by the desk.
  std::shared_ptr<std::atomic<bool>> gone;

  image::Hand hand() const noexcept { return {asker, static_cast<std::uint32_t>(connection)}; }
};

/// Index of the axis with this letter; -1: the machine has none.
int axis_of(const machine::MachineConfig& machine, const std::string& letter, FormProblem& problem);

}  // namespace servogate::gateway
