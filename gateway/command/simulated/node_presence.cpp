// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/node_presence.hpp"

#include <poll.h>

#include <algorithm>
#include <optional>

#include "drivers/clock.hpp"
#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kTwice{"simulated.node-twice", "--node names {0} twice", "--node называет {0} дважды"};
const text::Entry kTaken{
    "simulated.node-taken",
    "node {0} is not simulated: a device with this node-ID is on {1} already, its frame {2} was heard",
    "узел {0} не имитируется: на {1} уже есть устройство с этим номером узла, услышан его кадр {2}"};
const text::Entry kTwin{
    "simulated.node-twin",
    "another device on {1} has the node-ID {0}, too: its frame {2} was heard. One of the two has to go",
    "у другого устройства на {1} тот же номер узла {0}: услышан его кадр {2}. Одно из двух надо убрать"};

/// Silence after which a bus has no master; time in which nodes of a bus with one speak; patience with
/// answers.
constexpr image::Nanoseconds kQuiet = 250 * image::kMillisecond, kControlled = image::kSecond,
                             kAnswers = 250 * image::kMillisecond;

/// The node that sends such a frame in the pre-defined connection set; 0: it is no frame of a device.
int sender_of(const image::CanFrame& frame) {
  using canopen::Service;
  if (frame.error || frame.remote || frame.fd) return 0;
  const canopen::CobId id = canopen::classify(frame.id, frame.extended);
  switch (id.service) {
    case Service::emcy:
    case Service::tpdo1:
    case Service::tpdo2:
    case Service::tpdo3:
    case Service::tpdo4:
    case Service::sdo_response:
    case Service::heartbeat:
      return id.node;
    default:
      return 0;
  }
}

/// Hears who is there before the devices of this process are.
class Ear {
 public:
  Ear(const CanTransport& transport, const std::vector<int>& nodes, const EndBySignal& signals)
      : transport_(transport), nodes_(nodes), signals_(signals) {}

  /// Until a device with one of the node-IDs is heard, at most to `until`.
  void listen(image::Nanoseconds until) {
    image::CanFrame frame;
    while (!found_ && !signals_.ended()) {
      while (!found_ && transport_.bus->receive(frame)) hear(frame);
      const image::Nanoseconds left = until - drivers::clock_ns(CLOCK_MONOTONIC);
      if (left <= 0) return;
      pollfd p{transport_.descriptor, POLLIN, 0};
      const timespec limit{0, std::min(left, 50 * image::kMillisecond)};
      ppoll(&p, 1, &limit, nullptr);
    }
  }
  /// Asks every node for its device type.
  void ask() {
    constexpr std::uint8_t kUpload1000[] = {0x40, 0x00, 0x10, 0, 0, 0, 0, 0};
    for (const int node : nodes_)
      transport_.bus->send(
          canopen::make_frame(canopen::cob::sdo_request(static_cast<canopen::NodeId>(node)), kUpload1000));
  }
  bool controlled() const noexcept { return controlled_; }
  const std::optional<image::CanFrame>& found() const noexcept { return found_; }

 private:
  bool mine(int node) const { return std::find(nodes_.begin(), nodes_.end(), node) != nodes_.end(); }
  void hear(const image::CanFrame& frame) {
    if (mine(sender_of(frame))) found_ = frame;
    const canopen::CobId id = canopen::classify(frame.id, frame.extended);
    // Whoever asks another node will not take an answer of this one for its own.
    if (canopen::sent_by_masters(frame) && (id.service != canopen::Service::sdo_request || mine(id.node)))
      controlled_ = true;
  }

  const CanTransport& transport_;
  const std::vector<int>& nodes_;
  const EndBySignal& signals_;
  bool controlled_ = false;
  std::optional<image::CanFrame> found_;
};

}  // namespace

bool each_once(const std::vector<int>& nodes) {
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (std::find(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(i), nodes[i]) ==
        nodes.begin() + static_cast<std::ptrdiff_t>(i))
      continue;
    complain(kTwice, {std::to_string(nodes[i])});
    return false;
  }
  return true;
}

int may_join(const CanTransport& transport, const std::string& url, const std::vector<int>& nodes, bool ask,
             const EndBySignal& signals) {
  if (transport.bus->state() == image::CanState::down) return kDone;
  const image::Nanoseconds begin = drivers::clock_ns(CLOCK_MONOTONIC);
  Ear ear(transport, nodes, signals);
  ear.listen(begin + kQuiet);
  if (ear.controlled()) {
    ear.listen(begin + kControlled);
  } else if (ask && !ear.found()) {
    ear.ask();
    ear.listen(drivers::clock_ns(CLOCK_MONOTONIC) + kAnswers);
  }
  if (!ear.found()) return kDone;
  complain(kTaken, {std::to_string(sender_of(*ear.found())), url, canopen::frame_words(*ear.found())});
  return kAlarm;
}

void TwinWatch::hear(const image::CanFrame& frame) {
  const int node = sender_of(frame);
  if (node == 0 || told_.contains(node) || !own_(node)) return;
  told_.insert(node);
  complain(kTwin, {std::to_string(node), url_, canopen::frame_words(frame)});
}

}  // namespace servogate::gateway::command
