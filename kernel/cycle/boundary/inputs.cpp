// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/boundary/inputs.hpp"

#include <algorithm>
#include <cstring>

#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::cycle {

namespace {

void put_varint(std::vector<std::uint8_t>& out, std::uint64_t v) {
  for (; v >= 0x80; v >>= 7) out.push_back(static_cast<std::uint8_t>(v | 0x80));
  out.push_back(static_cast<std::uint8_t>(v));
}

void put_raw(std::vector<std::uint8_t>& out, const void* from, std::size_t bytes) {
  const auto* p = static_cast<const std::uint8_t*>(from);
  out.insert(out.end(), p, p + bytes);
}

template <typename T, std::size_t N>
void put_changed(std::vector<std::uint8_t>& out, const std::array<T, N>& now, const std::array<T, N>& last) {
  std::uint64_t mask = 0;
  for (std::size_t i = 0; i < N; ++i)
    if (std::memcmp(&now[i], &last[i], sizeof(T)) != 0) mask |= std::uint64_t{1} << i;
  put_varint(out, mask);
  for (std::size_t i = 0; i < N; ++i)
    if (((mask >> i) & 1) != 0) put_raw(out, &now[i], sizeof(T));
}

void put_edges(std::vector<std::uint8_t>& out, const image::Edges& now, const image::Edges& last) {
  put_varint(out, now.list().size());
  for (const image::Edge& e : now.list()) {
    out.push_back(static_cast<std::uint8_t>(e.place.packet));
    out.push_back(static_cast<std::uint8_t>(e.place.format));
    put_varint(out, e.place.index);
    out.push_back(e.level ? 1 : 0);
    put_raw(out, &e.t_ns, sizeof e.t_ns);
  }
  put_varint(out, now.lost() - last.lost());
}

}  // namespace

bool tell_of_ended_scan(const CycleInputs& in) noexcept {
  return std::any_of(
      in.notices.begin(), in.notices.begin() + in.notice_count,
      [](const image::AlarmRecord& r) { return r.number == alarm::kPlcWatchdog && r.detail1 == kScanEnded; });
}

void InputEncoder::append(const CycleInputs& in, std::vector<std::uint8_t>& out) {
  put_varint(out, static_cast<std::uint64_t>(in.number - last_.number));
  put_changed(out, in.axes, last_.axes);
  put_changed(out, in.spindles, last_.spindles);
  std::uint64_t changed = 0;
  for (std::size_t i = 0; i < in.packet_a.size(); ++i) changed += in.packet_a[i] != last_.packet_a[i];
  put_varint(out, changed);
  for (std::size_t i = 0; changed != 0 && i < in.packet_a.size(); ++i)
    if (in.packet_a[i] != last_.packet_a[i]) {
      put_varint(out, i);
      out.push_back(in.packet_a[i]);
    }
  put_changed(out, in.sources, last_.sources);
  put_edges(out, in.edges, last_.edges);
  std::uint64_t moved = 0;
  for (std::size_t i = 0; i < in.visible.size(); ++i)
    if (in.visible[i] != last_.visible[i]) moved |= std::uint64_t{1} << i;
  put_varint(out, moved);
  for (std::size_t i = 0; i < in.visible.size(); ++i)
    if ((moved >> i & 1) != 0) put_varint(out, in.visible[i] - last_.visible[i]);
  out.push_back(in.request_count);
  put_raw(out, in.requests.data(), sizeof(image::Request) * in.request_count);
  out.push_back(in.notice_count);
  put_raw(out, in.notices.data(), sizeof(image::AlarmRecord) * in.notice_count);
  last_ = in;
}

std::uint64_t InputDecoder::varint() noexcept {
  std::uint64_t v = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    if (at_ >= bytes_.size()) break;
    const std::uint8_t b = bytes_[at_++];
    v |= static_cast<std::uint64_t>(b & 0x7f) << shift;
    if ((b & 0x80) == 0) return v;
  }
  damaged_ = true;
  return 0;
}

void InputDecoder::raw(void* to, std::size_t bytes) noexcept {
  if (bytes_.size() - at_ < bytes) {
    damaged_ = true;
    at_ = bytes_.size();
    return;
  }
  if (bytes != 0) std::memcpy(to, bytes_.data() + at_, bytes);
  at_ += bytes;
}

void InputDecoder::edges() noexcept {
  last_.edges.clear();
  const std::uint64_t count = varint();
  if (count > image::Edges::kCapacity) damaged_ = true;
  for (std::uint64_t i = 0; i < count && !damaged_; ++i) {
    image::Edge edge;
    std::uint8_t packet = 0, format = 0, level = 0;
    raw(&packet, 1);
    raw(&format, 1);
    edge.place.index = static_cast<std::uint32_t>(varint());
    raw(&level, 1);
    raw(&edge.t_ns, sizeof edge.t_ns);
    damaged_ = damaged_ || packet > static_cast<std::uint8_t>(image::Packet::v) ||
               format > static_cast<std::uint8_t>(image::Format::ch);
    if (damaged_) break;
    edge.place.packet = static_cast<image::Packet>(packet);
    edge.place.format = static_cast<image::Format>(format);
    edge.level = level != 0;
    last_.edges.add(edge);
  }
  last_.edges.note_lost(static_cast<std::uint32_t>(varint()));
}

bool InputDecoder::give(CycleInputs& in) noexcept {
  if (damaged_ || at_ >= bytes_.size()) return false;
  const auto changed = [&](auto& items) {
    const std::uint64_t mask = varint();
    for (std::size_t i = 0; i < items.size() && !damaged_; ++i)
      if (((mask >> i) & 1) != 0) raw(&items[i], sizeof items[i]);
  };
  last_.number += static_cast<std::int64_t>(varint());
  changed(last_.axes);
  changed(last_.spindles);
  for (std::uint64_t n = varint(); n > 0 && !damaged_; --n) {
    const std::uint64_t i = varint();
    std::uint8_t value = 0;
    raw(&value, 1);
    if (i < last_.packet_a.size())
      last_.packet_a[i] = value;
    else
      damaged_ = true;
  }
  changed(last_.sources);
  edges();
  const std::uint64_t moved = varint();
  for (std::size_t i = 0; i < last_.visible.size() && !damaged_; ++i)
    if ((moved >> i & 1) != 0) last_.visible[i] += varint();
  raw(&last_.request_count, 1);
  if (last_.request_count > kRequestsPerCycle) damaged_ = true;
  if (!damaged_) raw(last_.requests.data(), sizeof(image::Request) * last_.request_count);
  raw(&last_.notice_count, 1);
  if (last_.notice_count > kNoticesPerCycle) damaged_ = true;
  if (!damaged_) raw(last_.notices.data(), sizeof(image::AlarmRecord) * last_.notice_count);
  in = last_;
  return !damaged_;
}

}  // namespace servogate::cycle
