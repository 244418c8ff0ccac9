// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/master_claim.hpp"

#include <algorithm>
#include <array>

#include "firmware_if/canopen/301/words/frame_words.hpp"

namespace servogate::canopen {
namespace {

constexpr std::array<std::uint8_t, 2> kMark = {'S', 'G'};
constexpr image::Nanoseconds kFirst = 50 * image::kMillisecond;  ///< before the first announcement, at most
constexpr image::Nanoseconds kLeastPause = 40 * image::kMillisecond, kMostPause = 90 * image::kMillisecond;
constexpr int kLeastSaid = 4;
/// Whoever was not there for so long may have company that was not there either: the time does not count.
constexpr image::Nanoseconds kAttention = 50 * image::kMillisecond;

/// splitmix64, so that neighbouring seeds have nothing in common. Source: Steele, Lea and Flood, 2014.
constexpr std::uint64_t mixed(std::uint64_t z) noexcept {
  z += 0x9E37'79B9'7F4A'7C15u;
  z = (z ^ z >> 30) * 0xBF58'476D'1CE4'E5B9u;
  z = (z ^ z >> 27) * 0x94D0'49BB'1331'11EBu;
  return z ^ z >> 31;
}

}  // namespace

MasterClaim::MasterClaim(NodeId own_node, image::Nanoseconds listening, std::uint64_t chance) noexcept
    : own_node_(own_node), listening_(listening), chance_(chance), number_(draw(0, kCobs)) {}

void MasterClaim::begin(image::Nanoseconds now) noexcept {
  state_ = State::listening;
  until_ = now + listening_;
  polled_ = now;
}

bool MasterClaim::announces(const image::CanFrame& frame) noexcept {
  return !frame.extended && !frame.remote && !frame.error && !frame.fd && frame.length == kMark.size() &&
         frame.id >= kFirstCob && frame.id < kFirstCob + kCobs &&
         std::equal(kMark.begin(), kMark.end(), frame.data.begin());
}

void MasterClaim::on_frame(const image::CanFrame& frame) noexcept {
  if (state_ > State::announcing) return;
  if (leads_nodes(frame, own_node_)) {
    state_ = State::led;
  } else if (announces(frame)) {
    const auto number = static_cast<std::int64_t>(frame.id - kFirstCob);
    if (state_ == State::listening || number < number_) state_ = State::late;
    if (number == number_) {
      number_ = draw(0, kCobs);
      again_ = true;
    }
  }
}

std::int64_t MasterClaim::draw(std::int64_t least, std::int64_t end) noexcept {
  chance_ = mixed(chance_);
  return least + static_cast<std::int64_t>(chance_ % static_cast<std::uint64_t>(end - least));
}

MasterClaim::State MasterClaim::poll(image::Nanoseconds now, image::CanBus& bus) noexcept {
  const image::Nanoseconds away = now - polled_;
  polled_ = now;
  if ((state_ == State::listening && now >= until_) || (state_ == State::announcing && again_)) {
    state_ = State::announcing;
    again_ = false;
    said_ = 0;
    until_ = now + kAnnouncing;
    next_ = now + draw(0, kFirst);
  }
  if (state_ != State::announcing) return state_;
  if (away > kAttention) until_ += away;
  if (now >= until_ && said_ >= kLeastSaid) {
    state_ = State::leads;
  } else if (now >= next_) {
    // A bus that takes nothing is nobody's: its own alarm will say so.
    bus.send(make_frame(kFirstCob + static_cast<std::uint32_t>(number_), kMark));
    ++said_;
    next_ = now + draw(kLeastPause, kMostPause);
  }
  return state_;
}

}  // namespace servogate::canopen
