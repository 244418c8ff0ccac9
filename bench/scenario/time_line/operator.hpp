// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "bench/scenario/scenario.hpp"

namespace servogate::scenario {

/// What was answered to what `do` says; texts in both languages.
struct Said {
  bool accepted = false;
  std::string code, text;
};

/// Who does what `do` says: a client of the machine's desk, which the gateway hands over. Everything happens
/// on the thread that steps the machine.
class Operator {
 public:
  virtual ~Operator() = default;
  /// What is wrong with the words, in both languages; empty: they can be carried out. Moves nothing.
  virtual std::string problem(const Do& what) = 0;
  /// Carries it out; `step` moves the machine by a cycle while an answer is waited for, false: it cannot.
  virtual Said carry_out(const Do& what, const std::function<bool()>& step) = 0;
  /// What was begun last goes on.
  virtual bool under_way() = 0;
  /// After under_way(): why it did not end as asked, in both languages; empty: it did.
  virtual std::string failure() = 0;
  /// Behind every cycle; `step` as in carry_out(): it may be called, and then this is, too.
  virtual void poll(const std::function<bool()>& step) = 0;
};

}  // namespace servogate::scenario
