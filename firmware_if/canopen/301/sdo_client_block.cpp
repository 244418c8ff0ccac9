// SPDX-License-Identifier: Apache-2.0
// Block transfers of SdoClient. Source: CiA 301, 7.2.4.3.9-15.
#include <algorithm>

#include "firmware_if/canopen/301/sdo_client.hpp"

namespace servogate::canopen {
namespace {

// The device says that it cannot do this kind of transfer, not that the object is wrong (class 06).
constexpr bool refuses_blocks(AbortCode code) noexcept {
  const std::uint32_t error_class = static_cast<std::uint32_t>(code) >> 24;
  return error_class == 0x05 || error_class == 0x08 || code == AbortCode::unsupported_access;
}
// What another try may mend: something was lost or spoiled on the way.
constexpr bool came_from_the_wire(AbortCode code) noexcept {
  return code == AbortCode::crc_error || code == AbortCode::sequence_number_invalid ||
         code == AbortCode::timed_out;
}

}  // namespace

bool SdoClient::wants_blocks() const noexcept {
  if (!blocks_allowed_ || blocks_refused_) return false;
  return result_.download ? source_ && length_ > kBlockThreshold : target_ && capacity_ > kBlockThreshold;
}

SdoBytes SdoClient::block_request() noexcept {
  switch (phase_) {
    case Phase::block_initiate:
      return result_.download ? sdo_block::download_initiate(result_.index, result_.subindex, length_)
                              : sdo_block::upload_initiate(result_.index, result_.subindex, own_block_size_,
                                                           kBlockThreshold);
    case Phase::block_segments: {
      if (!result_.download) return sdo_block::upload_start();
      const std::uint32_t from = position_ + sequence_ * kSegmentData;
      const std::uint32_t size = std::min(length_ - from, kSegmentData);
      return sdo_block::segment(static_cast<std::uint8_t>(sequence_ + 1), std::span(memory() + from, size),
                                from + size == length_);
    }
    case Phase::block_confirm:
      return sdo_block::confirm(sequence_, own_block_size_);
    case Phase::block_end: {
      take_into_crc(length_);
      const auto unused = static_cast<std::uint8_t>((kSegmentData - length_ % kSegmentData) % kSegmentData);
      return sdo_block::end(unused, crc_used_ ? crc_ : std::uint16_t{0});
    }
    default:
      return sdo_block::end_confirm();
  }
}

void SdoClient::block_sent() noexcept {
  if (phase_ == Phase::block_done) return finish(SdoStatus::done, AbortCode::none);
  if (result_.download && phase_ == Phase::block_segments) {
    ++sequence_;
    const bool all = position_ + sequence_ * kSegmentData >= length_;
    if (all || sequence_ >= block_size_)
      phase_ = Phase::block_confirm;
    else
      request_due_ = true;
  } else if (!result_.download && phase_ == Phase::block_confirm) {
    position_ += sequence_ * kSegmentData;
    phase_ = last_segment_ ? Phase::block_end : Phase::block_segments;
    if (!last_segment_) take_into_crc(position_);
    if (!last_segment_) sequence_ = 0;
  }
}

bool SdoClient::on_block_frame(const SdoBytes& bytes) noexcept {
  const SdoFrame plain = parse_sdo_response(bytes);
  // 80h cannot be a segment: their numbers begin with 1.
  if (bytes[0] == 0x80) {
    if (plain.index != result_.index || plain.subindex != result_.subindex) return false;
    on_abort(plain.abort);
    return true;
  }
  switch (phase_) {
    case Phase::block_initiate:
      return !request_due_ && on_block_initiate(bytes);
    case Phase::block_segments:
      if (result_.download) return on_download_confirm(bytes);
      return !request_due_ && on_upload_segment(bytes);
    case Phase::block_confirm:
      return result_.download && on_download_confirm(bytes);
    case Phase::block_end: {
      if (request_due_) return false;
      if (!result_.download) return on_upload_end(bytes);
      if (sdo_block::parse(bytes, true, false).command != BlockCommand::end) return false;
      position_ = length_;
      finish(SdoStatus::done, AbortCode::none);
      return true;
    }
    default:
      return false;
  }
}

void SdoClient::on_abort(AbortCode code) noexcept {
  if (phase_ == Phase::block_initiate && refuses_blocks(code)) {
    blocks_refused_ = true;
    if (code == AbortCode::command_specifier_invalid) blocks_allowed_ = false;
    return restart();
  }
  if (came_from_the_wire(code) && repeat()) return;
  finish(SdoStatus::aborted, code);
}

bool SdoClient::on_block_initiate(const SdoBytes& bytes) noexcept {
  const BlockFrame f = sdo_block::parse(bytes, result_.download, false);
  // Below the switch threshold the device answers a block upload as a plain one.
  if (f.command != BlockCommand::initiate)
    return !result_.download && parse_sdo_response(bytes).command == SdoCommand::upload_initiate &&
           on_plain_frame(bytes);
  if (f.index != result_.index || f.subindex != result_.subindex) return false;
  blocks_known_ = true;
  crc_used_ = f.crc_supported;
  sequence_ = 0;
  if (result_.download) {
    if (f.block_size < 1 || f.block_size > kMaxBlockSize)
      return break_off(AbortCode::block_size_invalid), true;
    block_size_ = f.block_size;
  } else {
    length_ = f.total;
    if (length_ > capacity_) return break_off(AbortCode::out_of_memory), true;
    block_size_ = own_block_size_;
  }
  phase_ = Phase::block_segments;
  request_due_ = true;
  return true;
}

// A device may confirm early, when nothing came for a while; a confirmation of more than was sent is one that
// came twice.
bool SdoClient::on_download_confirm(const SdoBytes& bytes) noexcept {
  const BlockFrame f = sdo_block::parse(bytes, true, false);
  if (f.command != BlockCommand::confirm || f.sequence > sequence_) return false;
  if (f.block_size < 1 || f.block_size > kMaxBlockSize) return break_off(AbortCode::block_size_invalid), true;
  if (f.sequence == 0 && ++stalls_ > retries_) {
    if (!repeat()) break_off(AbortCode::sequence_number_invalid);
    return true;
  }
  if (f.sequence != 0) stalls_ = 0;
  position_ = std::min(length_, position_ + f.sequence * kSegmentData);
  take_into_crc(position_);
  block_size_ = f.block_size;
  sequence_ = 0;
  phase_ = position_ == length_ ? Phase::block_end : Phase::block_segments;
  request_due_ = true;
  return true;
}

bool SdoClient::on_upload_segment(const SdoBytes& bytes) noexcept {
  progress_ = true;
  last_answer_ = bytes;
  const std::uint8_t number = segment_sequence(bytes[0]);
  if (number == sequence_ + 1) {
    const std::uint32_t from = position_ + sequence_ * kSegmentData;
    const bool last = segment_last(bytes[0]);
    // The last segment may be filled up with bytes that are no data.
    if (from + (last ? 0 : kSegmentData) > capacity_) return break_off(AbortCode::out_of_memory), true;
    std::copy_n(bytes.begin() + 1, std::min(kSegmentData, capacity_ - from), writable() + from);
    ++sequence_;
    stalls_ = 0;
    last_segment_ = last;
  }
  // Also when what came last was not what was missing: the device waits now.
  if (number >= block_size_ || segment_last(bytes[0])) {
    phase_ = Phase::block_confirm;
    request_due_ = true;
  }
  return true;
}

bool SdoClient::on_upload_end(const SdoBytes& bytes) noexcept {
  const BlockFrame f = sdo_block::parse(bytes, false, false);
  if (f.command != BlockCommand::end || bytes == last_answer_) return false;
  if (f.unused > position_) return break_off(AbortCode::length_mismatch), true;
  position_ -= f.unused;
  if (position_ > capacity_) return break_off(AbortCode::out_of_memory), true;
  if (length_ != 0 && position_ != length_) return break_off(AbortCode::length_mismatch), true;
  take_into_crc(position_);
  if (crc_used_ && f.crc != crc_) {
    const bool again = repeat();
    if (!again) break_off(AbortCode::crc_error);
    abort_due_ = true;
    abort_code_ = AbortCode::crc_error;
    return true;
  }
  phase_ = Phase::block_done;
  request_due_ = true;
  return true;
}

// The rest of a sub-block did not come: what came in order is confirmed, and the device goes on from there.
// With nothing of it here our confirmation of the one before may have been lost, and a second one could be
// taken for that of segments never seen; then only a new transfer is safe.
bool SdoClient::block_stalled() noexcept {
  if (phase_ != Phase::block_segments || result_.download || sequence_ == 0) return false;
  if (++stalls_ > retries_) return false;
  phase_ = Phase::block_confirm;
  request_due_ = true;
  return true;
}

void SdoClient::take_into_crc(std::uint32_t to) noexcept {
  if (to <= crc_position_) return;
  if (crc_used_) crc_ = sdo_crc(std::span(memory() + crc_position_, to - crc_position_), crc_);
  crc_position_ = to;
}

}  // namespace servogate::canopen
