// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::counting {

/// Calls of operator new by the calling thread so far.
std::uint64_t allocations() noexcept;

/// Adds what its scope allocates to a total.
class Tally {
 public:
  explicit Tally(std::uint64_t& total) noexcept : total_(total), before_(allocations()) {}
  ~Tally() { total_ += allocations() - before_; }
  Tally(const Tally&) = delete;
  Tally& operator=(const Tally&) = delete;

 private:
  std::uint64_t& total_;
  std::uint64_t before_;
};

}  // namespace servogate::counting
