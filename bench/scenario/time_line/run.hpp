// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/machine.hpp"
#include "bench/scenario/scenario.hpp"
#include "bench/scenario/signals/signals.hpp"
#include "bench/scenario/time_line/operator.hpp"

namespace servogate::scenario {

/// What came of a scenario. Sentences are in both languages (text::both).
struct Outcome {
  enum class Status : std::uint8_t {
    passed,
    failed,
    skipped,
    impossible,  ///< the file names what the machine does not have: `findings`
    infrastructure,
  };
  Status status = Status::passed;
  std::string message = {};  ///< of a failure: "expected ... got ... at 1.204 s"; of a skip: its reason
  Where at = {};             ///< of the step that failed
  double t_s = 0.0;          ///< when, since the beginning (behind `given`)
  double virtual_s = 0.0;    ///< machine time of the whole run
  std::string diagram = {};  ///< the last 50 ms as text
  std::string code = {};     ///< of the refusal that it failed by; empty: it did not
  std::vector<text::Finding> findings = {};
};

/// How scenarios are run.
struct RunManner {
  bool without_faults = false;  ///< `fault` steps are left out: does anything notice?
};

/// Runs a scenario on a machine that has not made a cycle yet.
Outcome run(const Scenario& scenario, bench::Machine& machine, Operator& who, const Signals& signals,
            const RunManner& manner);

/// A machine whose steps come one by one, each when the one before is done: for a program that writes its
/// scenario as it goes.
class Session {
 public:
  /// Makes the first cycle. All outlive it.
  Session(bench::Machine& machine, Operator& who, const Signals& signals);
  ~Session();
  /// Does a step. What it begins to watch (`always`, `until`) is watched in all later ones, and fails the one
  /// in which it happens.
  Outcome perform(Step step);
  /// One cycle with all that is watched; false: the machine has come to its end.
  bool advance();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::scenario
