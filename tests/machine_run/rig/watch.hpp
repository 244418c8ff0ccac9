// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::machine_run {

/// What a thread did while it was watched.
struct Offences {
  long allocations = 0;   ///< operator new, malloc and its relatives, and their releases
  long locks = 0;         ///< mutexes, read-write locks, condition variables
  long system_calls = 0;  ///< but those of the vDSO
  long first_system_call = -1;
  bool none() const { return allocations == 0 && locks == 0 && system_calls == 0; }
  std::string words() const;
};

/// Counts what the calling thread does between construction and the end. One at a time. The first of each
/// offence writes its stack to standard error where SERVOGATE_WATCH_STACK is set.
class Watch {
 public:
  Watch();
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  /// Of all watches of this program so far.
  static Offences offences();
  static void forget();
  /// Why system calls cannot be counted here, empty: they can.
  static std::string no_system_calls();
  /// Why allocations and locks cannot be counted here, empty: they can.
  static std::string no_allocations();
};

}  // namespace servogate::machine_run
