// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/handshake.hpp"

#include "firmware_if/image/interface_map.hpp"

namespace servogate::channel {

namespace {

using image::field;
using image::kProcessFields;
using image::Place;

struct Word {
  Place strobe, ack, code;
};
constexpr Word kWords[] = {
    {field(kProcessFields, "m_strobe"), field(kProcessFields, "m_ack"), field(kProcessFields, "m_code")},
    {field(kProcessFields, "s_strobe"), field(kProcessFields, "s_ack"), field(kProcessFields, "s_value")},
    {field(kProcessFields, "t_strobe"), field(kProcessFields, "t_ack"), field(kProcessFields, "t_number")},
    {field(kProcessFields, "h_strobe"), field(kProcessFields, "h_ack"), field(kProcessFields, "h_code")},
};
constexpr Place kUnknown = field(kProcessFields, "m_unknown");
constexpr Place kCorrector = field(kProcessFields, "t_corrector");

}  // namespace

void Handshake::begin(HandshakeWord word, std::int32_t code, double value, double timeout_s) noexcept {
  phase_ = Phase::clear;
  word_ = word;
  code_ = code;
  value_ = value;
  timeout_s_ = timeout_s;
  waited_s_ = 0.0;
  unknown_ = false;
}

Handshake::State Handshake::step(image::ProcessImage& image, std::uint32_t base, bool held) noexcept {
  if (phase_ == Phase::idle) return State::idle;
  const Word& w = kWords[static_cast<int>(word_)];
  image::Packets& k = image.packets;
  const bool ack = k.bit(image::at(w.ack, base));
  if (!held) waited_s_ += image.now.period_s();
  if (phase_ == Phase::clear && !ack) {
    k.set_number(image::at(w.code, base), word_ == HandshakeWord::s ? value_ : code_);
    if (word_ == HandshakeWord::t) k.set_number(image::at(kCorrector, base), value_);
    k.set_bit(image::at(w.strobe, base), true);
    phase_ = Phase::strobe;
  } else if (phase_ == Phase::strobe && ack) {
    unknown_ = word_ == HandshakeWord::m && k.bit(image::at(kUnknown, base));
    k.set_bit(image::at(w.strobe, base), false);
    phase_ = Phase::release;
  } else if (phase_ == Phase::release && !ack) {
    phase_ = Phase::idle;
    return unknown_ ? State::unknown : State::done;
  }
  if (waited_s_ > timeout_s_) {
    cancel(image, base);
    return State::timed_out;
  }
  return State::waiting;
}

void Handshake::cancel(image::ProcessImage& image, std::uint32_t base) noexcept {
  if (phase_ == Phase::idle) return;
  image.packets.set_bit(image::at(kWords[static_cast<int>(word_)].strobe, base), false);
  phase_ = Phase::idle;
}

}  // namespace servogate::channel
