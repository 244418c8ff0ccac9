// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_client.hpp"

#include <algorithm>

namespace servogate::canopen {
bool SdoClient::start(bool is_download, std::uint16_t index, std::uint8_t subindex) noexcept {
  result_ = {SdoStatus::busy, AbortCode::none, index, subindex, is_download, 0, 0};
  blocks_refused_ = false;
  patience_ns_ = timeout_ns_;
  restart();
  return true;
}

void SdoClient::restart() noexcept {
  phase_ = wants_blocks() ? Phase::block_initiate : Phase::initiate;
  request_due_ = true;
  toggle_ = progress_ = last_segment_ = false;
  position_ = crc_position_ = stalls_ = 0;
  sequence_ = 0;
  crc_ = 0;
  last_answer_ = {};
  if (!result_.download) length_ = 0;
}

bool SdoClient::download(std::uint16_t index, std::uint8_t subindex,
                         std::span<const std::uint8_t> data) noexcept {
  if (busy() || data.size() > kBuffer) return false;
  std::ranges::copy(data, buffer_.begin());
  source_ = nullptr;
  target_ = nullptr;
  length_ = static_cast<std::uint32_t>(data.size());
  return start(true, index, subindex);
}

bool SdoClient::download(std::uint16_t index, std::uint8_t subindex, std::uint64_t value,
                         std::uint8_t bytes) noexcept {
  std::array<std::uint8_t, 8> raw{};
  if (bytes > raw.size()) return false;
  store_le(value, raw);
  return download(index, subindex, std::span(raw).first(bytes));
}

bool SdoClient::download_from(std::uint16_t index, std::uint8_t subindex,
                              std::span<const std::uint8_t> data) noexcept {
  if (busy() || data.size() > 0xFFFF'FFFFu) return false;
  source_ = data.data();
  target_ = nullptr;
  length_ = static_cast<std::uint32_t>(data.size());
  return start(true, index, subindex);
}

bool SdoClient::upload(std::uint16_t index, std::uint8_t subindex) noexcept {
  if (busy()) return false;
  source_ = nullptr;
  target_ = nullptr;
  capacity_ = kBuffer;
  return start(false, index, subindex);
}

bool SdoClient::upload_into(std::uint16_t index, std::uint8_t subindex,
                            std::span<std::uint8_t> memory) noexcept {
  if (busy()) return false;
  source_ = nullptr;
  target_ = memory.data();
  capacity_ = static_cast<std::uint32_t>(std::min<std::size_t>(memory.size(), 0xFFFF'FFFFu));
  return start(false, index, subindex);
}

void SdoClient::cancel() noexcept {
  if (!busy()) return;
  abort_due_ = true;
  abort_code_ = AbortCode::general_error;
  finish(SdoStatus::idle, AbortCode::none);
}

SdoBytes SdoClient::request() noexcept {
  if (in_block()) return block_request();
  return phase_ == Phase::initiate ? initiate_request() : segment_request();
}

SdoBytes SdoClient::initiate_request() const noexcept {
  if (!result_.download) return sdo_request::upload(result_.index, result_.subindex);
  if (expedited())
    return sdo_request::download_expedited(result_.index, result_.subindex, std::span(memory(), length_));
  return sdo_request::download_segmented(result_.index, result_.subindex, length_);
}

SdoBytes SdoClient::segment_request() const noexcept {
  if (!result_.download) return sdo_request::upload_segment(toggle_);
  const std::uint32_t size = std::min(length_ - position_, kSegmentData);
  return sdo_request::download_segment(toggle_, std::span(memory() + position_, size),
                                       position_ + size == length_);
}

void SdoClient::finish(SdoStatus status, AbortCode abort) noexcept {
  phase_ = Phase::idle;
  request_due_ = false;
  result_.status = status;
  result_.abort = abort;
  result_.size = status == SdoStatus::done ? position_ : 0;
}

void SdoClient::break_off(AbortCode code) noexcept {
  abort_due_ = true;
  abort_code_ = code;
  finish(SdoStatus::bad_protocol, code);
}

bool SdoClient::repeat() noexcept {
  if (result_.retries >= retries_) return false;
  ++result_.retries;
  restart();
  return true;
}

void SdoClient::on_timeout() noexcept {
  if (block_stalled()) return;
  // A device that has never done one may simply keep silent about what it does not know.
  blocks_refused_ |= phase_ == Phase::block_initiate && !blocks_known_;
  if (!repeat()) finish(SdoStatus::no_answer, AbortCode::timed_out);
  abort_due_ = true;
  abort_code_ = AbortCode::timed_out;
}

bool SdoClient::send_abort(image::CanBus& bus) noexcept {
  const SdoBytes bytes = sdo_abort(result_.index, result_.subindex, abort_code_);
  abort_due_ = !bus.send(make_frame(cob::sdo_request(node_), bytes));
  return !abort_due_;
}

bool SdoClient::poll(image::Nanoseconds now, image::CanBus& bus) noexcept {
  if (progress_) deadline_ns_ = now + patience_ns_;
  progress_ = false;
  if (busy() && !request_due_ && now >= deadline_ns_) on_timeout();
  if (abort_due_) return send_abort(bus);
  if (!request_due_) return false;
  const SdoBytes bytes = request();
  if (!bus.send(make_frame(cob::sdo_request(node_), bytes))) return false;
  request_due_ = false;
  deadline_ns_ = now + patience_ns_;
  if (in_block()) block_sent();
  return true;
}

// An answer of another object, or to another kind of request, is one that came too late for an earlier
// transfer.
bool SdoClient::expects(const SdoFrame& answer) const noexcept {
  const bool object_matches = answer.index == result_.index && answer.subindex == result_.subindex;
  if (answer.command == SdoCommand::abort) return object_matches;
  if (phase_ == Phase::initiate || phase_ == Phase::block_initiate)
    return object_matches &&
           answer.command == (result_.download ? SdoCommand::download_initiate : SdoCommand::upload_initiate);
  return answer.command == (result_.download ? SdoCommand::download_segment : SdoCommand::upload_segment);
}

bool SdoClient::on_frame(const image::CanFrame& frame) noexcept {
  if (frame.extended || frame.remote || frame.id != cob::sdo_response(node_)) return false;
  if (!busy() || abort_due_ || frame.length != 8) return false;
  SdoBytes bytes;
  std::copy_n(frame.data.begin(), bytes.size(), bytes.begin());
  if (in_block()) return on_block_frame(bytes);
  // Nothing can be answered before it was asked: a request still waiting for the bus has no answer yet.
  return !request_due_ && on_plain_frame(bytes);
}

bool SdoClient::on_plain_frame(const SdoBytes& bytes) noexcept {
  const SdoFrame answer = parse_sdo_response(bytes);
  if (!expects(answer) || bytes == last_answer_) return false;
  last_answer_ = bytes;
  if (answer.command == SdoCommand::abort) {
    finish(SdoStatus::aborted, answer.abort);
  } else if (phase_ == Phase::segments) {
    on_segment(answer);
  } else {
    on_initiate(answer);
  }
  return true;
}

void SdoClient::on_initiate(const SdoFrame& answer) noexcept {
  if (result_.download) {
    if (expedited()) {
      position_ = length_;
      return finish(SdoStatus::done, AbortCode::none);
    }
  } else if (answer.expedited) {
    if (answer.size > capacity_) return break_off(AbortCode::out_of_memory);
    std::copy_n(answer.data.begin(), answer.size, writable());
    position_ = answer.size;
    return finish(SdoStatus::done, AbortCode::none);
  } else {
    length_ = answer.total;
    if (length_ > capacity_) return break_off(AbortCode::out_of_memory);
  }
  phase_ = Phase::segments;
  request_due_ = true;
}

void SdoClient::on_segment(const SdoFrame& answer) noexcept {
  if (answer.toggle != toggle_) return break_off(AbortCode::toggle_not_alternated);
  bool last = answer.last;
  if (result_.download) {
    position_ += std::min(length_ - position_, kSegmentData);
    last = position_ == length_;
  } else {
    if (position_ + answer.size > capacity_) return break_off(AbortCode::out_of_memory);
    std::copy_n(answer.data.begin(), answer.size, writable() + position_);
    position_ += answer.size;
    if (last && length_ != 0 && position_ != length_) return break_off(AbortCode::length_mismatch);
    // A device that neither ends nor sends data would keep us here for ever.
    if (!last && answer.size == 0) return break_off(AbortCode::length_mismatch);
  }
  if (last) return finish(SdoStatus::done, AbortCode::none);
  toggle_ = !toggle_;
  request_due_ = true;
}

}  // namespace servogate::canopen
