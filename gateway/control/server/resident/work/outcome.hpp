// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <stop_token>
#include <string>
#include <variant>

#include "gateway/control/compose/program/program_check.hpp"
#include "gateway/control/server/protocol/reply.hpp"

namespace servogate::gateway {

struct Work;

/// What a request leads to: its reply, or work that is done beside the desk first.
using Outcome = std::variant<Reply, Work>;

/// Behind work, on the desk's thread again.
using Finish = std::function<Outcome()>;

/// Something that takes long. `run` is for another thread: it touches only what it holds itself or what
/// nobody changes, and may throw Cancelled when the token asks for its end.
struct Work {
  enum class Bench {
    thought,  ///< reading, checking and compiling; ended with the control
    files     ///< writing what must not be lost; done before the control ends
  };
  std::function<Finish(const std::stop_token&)> run;
  std::string what, name;  ///< of the request, for `status`: "load", "part.nc"
  Bench bench = Bench::thought;
};

}  // namespace servogate::gateway
