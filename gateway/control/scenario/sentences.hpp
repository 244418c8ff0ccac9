// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bench/scenario/scenario.hpp"
#include "gateway/control/server/protocol/command.hpp"

namespace servogate::gateway {

/// What `do` says, as things to do one after the other.
namespace sentence {
struct Ready {};       ///< reset, drives on, home
struct FallSilent {};  ///< nothing keeps jogs alive any more
struct Wait {
  image::Nanoseconds time = 0;
};
/// A level for a while.
struct Press {
  std::string point;
  image::Nanoseconds time = 0;
};
struct Handwheel {
  std::string point;
  double counts = 0.0;
};
}  // namespace sentence
using Deed = std::variant<ask::Command, sentence::Ready, sentence::FallSilent, sentence::Wait,
                          sentence::Press, sentence::Handwheel>;

/// Reads a sentence or a command of the control socket. nullopt: `why`, in both languages.
std::optional<std::vector<Deed>> read_sentence(const scenario::Do& what, std::string& why);

}  // namespace servogate::gateway
