// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "gateway/control/server/resident/work/question.hpp"

namespace servogate::gateway {

/// What clients wait for that takes long. For the desk's thread.
class Works {
 public:
  struct Entry {
    Ticket ticket;
    std::string what, name;
    std::chrono::steady_clock::time_point since;
  };
  void begin(const Ticket& ticket, std::string what, std::string name) {
    if (ticket.client == 0) return;
    const auto same = find(ticket);  // one work may lead to another
    if (same != list_.end())
      same->what = std::move(what), same->name = std::move(name);
    else
      list_.push_back({ticket, std::move(what), std::move(name), std::chrono::steady_clock::now()});
  }
  void end(const Ticket& ticket) {
    if (const auto entry = find(ticket); entry != list_.end()) list_.erase(entry);
  }
  const std::vector<Entry>& list() const noexcept { return list_; }

 private:
  std::vector<Entry>::iterator find(const Ticket& ticket) {
    return std::find_if(list_.begin(), list_.end(),
                        [&](const Entry& e) { return e.ticket.client == ticket.client; });
  }
  std::vector<Entry> list_;
};

}  // namespace servogate::gateway
