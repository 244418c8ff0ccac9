// SPDX-License-Identifier: Apache-2.0
// Block transfers of SdoServer. Source: CiA 301, 7.2.4.3.9-15.
#include <algorithm>

#include "firmware_if/canopen/device/sdo/sdo_server.hpp"

namespace servogate::canopen {
namespace {

constexpr bool good_block_size(std::uint8_t segments) noexcept {
  return segments >= 1 && segments <= kMaxBlockSize;
}

}  // namespace

bool SdoServer::tick(image::Nanoseconds now, SdoBytes& answer) noexcept {
  if (transfer_ != Transfer::block_download) return false;
  const image::Nanoseconds silent = now - heard_;
  // With nothing of this sub-block here our confirmation of the one before may have been lost; a second one
  // could be taken for that of segments never seen.
  if (silent >= kSilence && sequence_ > 0) {
    heard_ = now;
    answer = confirm_block();
    return true;
  }
  if (silent < 2 * kSilence) return false;
  answer = refuse(AbortCode::timed_out);
  return true;
}

void SdoServer::take_into_crc(std::size_t to) noexcept {
  if (to <= crc_position_) return;
  const std::span<const std::uint8_t> all = transfer_ >= Transfer::block_upload_start ? source_ : target_;
  if (crc_used_) crc_ = sdo_crc(all.subspan(crc_position_, to - crc_position_), crc_);
  crc_position_ = to;
}

SdoBytes SdoServer::begin_block_download(std::span<const std::uint8_t> request) noexcept {
  transfer_ = Transfer::none;
  const BlockFrame f = sdo_block::parse(request, true, true);
  if (f.command != BlockCommand::initiate) return refuse(AbortCode::command_specifier_invalid);
  index_ = f.index;
  subindex_ = f.subindex;
  if (const AbortCode code = open_download(f.size_indicated, f.total); code != AbortCode::none)
    return refuse(code);
  transfer_ = Transfer::block_download;
  crc_used_ = f.crc_supported;
  crc_ = 0;
  crc_position_ = 0;
  sequence_ = 0;
  last_ = false;
  block_size_ = own_block_size_;
  return sdo_block::download_accept(index_, subindex_, block_size_);
}

bool SdoServer::take_segment(std::span<const std::uint8_t> request, SdoBytes& answer) noexcept {
  const std::uint8_t number = segment_sequence(request[0]);
  const bool last = segment_last(request[0]);
  if (number == sequence_ + 1) {
    const std::size_t from = done_ + sequence_ * std::size_t{kSegmentData};
    // The last segment may be filled up with bytes that are no data.
    const std::size_t room = size_known_ ? total_ : target_.size();
    if (from >= room || (!last && from + kSegmentData > room)) {
      answer = refuse(AbortCode::length_too_high);
      return true;
    }
    std::copy_n(request.begin() + 1, std::min<std::size_t>(kSegmentData, room - from),
                target_.begin() + static_cast<std::ptrdiff_t>(from));
    ++sequence_;
    last_ = last;
    if (last) std::copy_n(request.begin(), last_segment_.size(), last_segment_.begin());
  }
  if (number < block_size_ && !last) return false;
  answer = confirm_block();
  return true;
}

SdoBytes SdoServer::confirm_block() noexcept {
  const std::uint8_t sequence = sequence_;
  done_ += sequence * std::size_t{kSegmentData};
  if (!last_) take_into_crc(done_);
  if (last_) transfer_ = Transfer::block_download_end;
  sequence_ = 0;
  block_size_ = own_block_size_;
  return sdo_block::confirm(sequence, block_size_);
}

SdoBytes SdoServer::end_block_download(std::span<const std::uint8_t> request) noexcept {
  const BlockFrame f = sdo_block::parse(request, true, true);
  if (f.command != BlockCommand::end) return begin_block_download(request);
  const std::size_t size = done_ - std::min<std::size_t>(f.unused, done_);
  if (size > target_.size()) return refuse(AbortCode::length_too_high);
  if (size_known_ && size != total_)
    return refuse(size < total_ ? AbortCode::length_too_low : AbortCode::length_too_high);
  take_into_crc(size);
  if (crc_used_ && crc_ != f.crc) return refuse(AbortCode::crc_error);
  const AbortCode code = objects_.write(index_, subindex_, target_.first(size));
  if (code != AbortCode::none) return refuse(code);
  transfer_ = Transfer::none;
  return sdo_block::end_confirm();
}

bool SdoServer::block_upload_request(std::span<const std::uint8_t> request, SdoBytes& answer) noexcept {
  const BlockFrame f = sdo_block::parse(request, false, true);
  switch (f.command) {
    case BlockCommand::initiate:
      answer = begin_block_upload(f);
      return true;
    case BlockCommand::start:
      if (transfer_ != Transfer::block_upload_start) break;
      transfer_ = Transfer::block_upload;
      return false;
    case BlockCommand::confirm:
      if (transfer_ != Transfer::block_upload) break;
      return upload_confirmed(f, answer);
    case BlockCommand::end:
      if (transfer_ != Transfer::block_upload_end) break;
      transfer_ = Transfer::none;
      return false;
    default:
      break;
  }
  answer = refuse(AbortCode::command_specifier_invalid);
  return true;
}

SdoBytes SdoServer::begin_block_upload(const BlockFrame& f) noexcept {
  transfer_ = Transfer::none;
  index_ = f.index;
  subindex_ = f.subindex;
  if (!good_block_size(f.block_size)) return refuse(AbortCode::block_size_invalid);
  if (const AbortCode code = open_upload(); code != AbortCode::none) return refuse(code);
  if (f.switch_threshold > 0 && total_ <= f.switch_threshold) return plain_upload();
  transfer_ = Transfer::block_upload_start;
  crc_used_ = f.crc_supported;
  crc_ = 0;
  crc_position_ = 0;
  sequence_ = 0;
  block_size_ = f.block_size;
  return sdo_block::upload_accept(index_, subindex_, static_cast<std::uint32_t>(total_));
}

bool SdoServer::segment(SdoBytes& frame) const noexcept {
  if (transfer_ != Transfer::block_upload || sequence_ >= block_size_) return false;
  const std::size_t from = done_ + sequence_ * std::size_t{kSegmentData};
  if (from >= total_ && !(total_ == 0 && sequence_ == 0)) return false;
  const std::size_t size = std::min<std::size_t>(kSegmentData, total_ - from);
  frame = sdo_block::segment(static_cast<std::uint8_t>(sequence_ + 1), source_.subspan(from, size),
                             from + size == total_);
  return true;
}

bool SdoServer::upload_confirmed(const BlockFrame& f, SdoBytes& answer) noexcept {
  if (f.sequence > sequence_) {
    answer = refuse(AbortCode::sequence_number_invalid);
    return true;
  }
  if (!good_block_size(f.block_size)) {
    answer = refuse(AbortCode::block_size_invalid);
    return true;
  }
  const std::size_t sent = done_ + f.sequence * std::size_t{kSegmentData};
  const bool all = f.sequence > 0 && sent >= total_;
  done_ = std::min(sent, total_);
  take_into_crc(done_);
  sequence_ = 0;
  block_size_ = f.block_size;
  if (!all) return false;
  transfer_ = Transfer::block_upload_end;
  answer = sdo_block::end(static_cast<std::uint8_t>(sent - total_), crc_used_ ? crc_ : std::uint16_t{0});
  return true;
}

}  // namespace servogate::canopen
