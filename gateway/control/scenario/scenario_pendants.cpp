// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/scenario/scenario_pendants.hpp"

namespace servogate::gateway {

namespace {

constexpr std::uint32_t kFirstClient = 100;  ///< of pendants; the operator's is another

}  // namespace

ScenarioPendants::ScenarioPendants(Control& control) {
  for (const machine::PendantConfig& config : control.machine().pendants) {
    mock::MockPendant* const port = control.world().pendant(config.name);
    if (port == nullptr) continue;
    auto pendant = std::make_unique<Pendant>();
    Pendant* const p = pendant.get();
    p->hand = {image::Asker::pendant, kFirstClient + static_cast<std::uint32_t>(pendants_.size())};
    PendantAsks asks;
    asks.hand = p->hand;
    asks.question = [p](ask::Command command) {
      p->asked.emplace_back(++p->last, std::move(command));
      return p->last;
    };
    asks.answer = [p](std::uint64_t question) -> std::optional<Reply> {
      auto found = p->answers.extract(question);
      return found.empty() ? std::nullopt : std::optional(std::move(found.mapped()));
    };
    p->session =
        std::make_unique<PendantSession>(control.loaded(), config, *port, std::move(asks), Announce{});
    pendants_.push_back(std::move(pendant));
  }
}

void ScenarioPendants::poll(const image::ProcessImage& image, const Ask& ask) {
  for (const auto& p : pendants_) p->session->step(image, image.now.t_ns);
  if (polling_) return;  // an answer is waited for
  polling_ = true;
  const struct End {  // an ask may throw
    bool& polling;
    ~End() { polling = false; }
  } end{polling_};
  for (const auto& p : pendants_)
    while (!p->asked.empty()) {
      const auto [question, command] = std::move(p->asked.front());
      p->asked.erase(p->asked.begin());
      p->answers.emplace(question, ask(command, p->hand));
    }
}

}  // namespace servogate::gateway
