// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/sdo/sdo_server.hpp"

#include <algorithm>

namespace servogate::canopen {

bool SdoServer::handle(std::span<const std::uint8_t> request, image::Nanoseconds now,
                       SdoBytes& answer) noexcept {
  if (request.size() != 8) return false;
  heard_ = now;
  // Within a sub-block every frame but an abort is a segment, whatever its bits say otherwise.
  if (transfer_ == Transfer::block_download && request[0] != 0x80) return take_segment(request, answer);
  if (transfer_ == Transfer::block_download_end && std::ranges::equal(request, last_segment_)) return false;
  const SdoFrame f = parse_sdo_request(request);
  switch (f.command) {
    case SdoCommand::download_initiate:
      answer = begin_download(f);
      return true;
    case SdoCommand::upload_initiate:
      answer = begin_upload(f);
      return true;
    case SdoCommand::download_segment:
      answer = continue_download(f);
      return true;
    case SdoCommand::upload_segment:
      answer = continue_upload(f);
      return true;
    case SdoCommand::abort:
      transfer_ = Transfer::none;
      return false;
    case SdoCommand::block_download:
      if (!blocks_allowed_) break;
      answer = transfer_ == Transfer::block_download_end ? end_block_download(request)
                                                         : begin_block_download(request);
      return true;
    case SdoCommand::block_upload:
      if (!blocks_allowed_) break;
      return block_upload_request(request, answer);
    default:
      break;
  }
  index_ = static_cast<std::uint16_t>(request[1] | request[2] << 8);
  subindex_ = request[3];
  answer = refuse(AbortCode::command_specifier_invalid);
  return true;
}

SdoBytes SdoServer::refuse(AbortCode code) noexcept {
  transfer_ = Transfer::none;
  return sdo_abort(index_, subindex_, code);
}

// Object, access and announced length of a download; finds its memory.
AbortCode SdoServer::open_download(bool size_known, std::size_t total) noexcept {
  std::size_t size = 0;
  if (const AbortCode code = objects_.may_write(index_, subindex_, size); code != AbortCode::none)
    return code;
  target_ = objects_.room(index_, subindex_);
  if (target_.empty()) target_ = buffer_;
  if (size_known && total > (size > 0 ? size : target_.size())) return AbortCode::length_too_high;
  if (size_known && total < size) return AbortCode::length_too_low;
  size_known_ = size_known;
  total_ = total;
  toggle_ = false;
  done_ = 0;
  return AbortCode::none;
}

SdoBytes SdoServer::begin_download(const SdoFrame& f) noexcept {
  transfer_ = Transfer::none;
  index_ = f.index;
  subindex_ = f.subindex;
  if (f.expedited) {
    std::size_t size = 0;
    AbortCode code = objects_.may_write(index_, subindex_, size);
    // Without a given size the object's own length counts.
    const std::size_t given = f.size_indicated || size == 0 || size > 4 ? f.size : size;
    if (code == AbortCode::none) code = objects_.write(index_, subindex_, std::span(f.data).first(given));
    return code == AbortCode::none ? sdo_response::download(index_, subindex_) : refuse(code);
  }
  if (const AbortCode code = open_download(f.size_indicated, f.total); code != AbortCode::none)
    return refuse(code);
  transfer_ = Transfer::download;
  return sdo_response::download(index_, subindex_);
}

SdoBytes SdoServer::continue_download(const SdoFrame& f) noexcept {
  if (transfer_ != Transfer::download) return refuse(AbortCode::command_specifier_invalid);
  if (f.toggle != toggle_) return refuse(AbortCode::toggle_not_alternated);
  if (done_ + f.size > (size_known_ ? total_ : target_.size())) return refuse(AbortCode::length_too_high);
  std::copy_n(f.data.begin(), f.size, target_.begin() + static_cast<std::ptrdiff_t>(done_));
  done_ += f.size;
  toggle_ = !toggle_;
  if (f.last) {
    if (size_known_ && done_ != total_) return refuse(AbortCode::length_too_low);
    transfer_ = Transfer::none;
    const AbortCode code = objects_.write(index_, subindex_, target_.first(done_));
    if (code != AbortCode::none) return refuse(code);
  }
  return sdo_response::download_segment(f.toggle);
}

// Finds the content of an upload.
AbortCode SdoServer::open_upload() noexcept {
  std::size_t size = 0;
  if (const AbortCode code = objects_.read(index_, subindex_, buffer_, size); code != AbortCode::none)
    return code;
  source_ = objects_.content(index_, subindex_);
  if (source_.empty()) source_ = std::span<const std::uint8_t>(buffer_).first(size);
  total_ = source_.size();
  toggle_ = false;
  done_ = 0;
  return AbortCode::none;
}

SdoBytes SdoServer::begin_upload(const SdoFrame& f) noexcept {
  transfer_ = Transfer::none;
  index_ = f.index;
  subindex_ = f.subindex;
  if (const AbortCode code = open_upload(); code != AbortCode::none) return refuse(code);
  return plain_upload();
}

SdoBytes SdoServer::plain_upload() noexcept {
  if (total_ >= 1 && total_ <= 4) return sdo_response::upload_expedited(index_, subindex_, source_);
  transfer_ = Transfer::upload;
  return sdo_response::upload_segmented(index_, subindex_, static_cast<std::uint32_t>(total_));
}

SdoBytes SdoServer::continue_upload(const SdoFrame& f) noexcept {
  if (transfer_ != Transfer::upload) return refuse(AbortCode::command_specifier_invalid);
  if (f.toggle != toggle_) return refuse(AbortCode::toggle_not_alternated);
  const std::size_t part = std::min<std::size_t>(7, total_ - done_);
  const auto piece = source_.subspan(done_, part);
  done_ += part;
  toggle_ = !toggle_;
  const bool last = done_ == total_;
  if (last) transfer_ = Transfer::none;
  return sdo_response::upload_segment(f.toggle, piece, last);
}

}  // namespace servogate::canopen
