// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/sdo_server.hpp"

#include <algorithm>

namespace servogate::canopen {

bool SdoServer::handle(std::span<const std::uint8_t> request, SdoBytes& answer) noexcept {
  if (request.size() != 8) return false;
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
    default:
      index_ = static_cast<std::uint16_t>(request[1] | request[2] << 8);
      subindex_ = request[3];
      answer = refuse(AbortCode::command_specifier_invalid);
      return true;
  }
}

SdoBytes SdoServer::refuse(AbortCode code) noexcept {
  transfer_ = Transfer::none;
  return sdo_abort(index_, subindex_, code);
}

SdoBytes SdoServer::begin_download(const SdoFrame& f) noexcept {
  transfer_ = Transfer::none;
  index_ = f.index;
  subindex_ = f.subindex;
  std::size_t size = 0;
  if (const AbortCode code = objects_.may_write(index_, subindex_, size); code != AbortCode::none)
    return refuse(code);
  if (f.expedited) {
    // Without a given size the object's own length counts.
    const std::size_t given = f.size_indicated || size == 0 || size > 4 ? f.size : size;
    const AbortCode code = objects_.write(index_, subindex_, std::span(f.data).first(given));
    return code == AbortCode::none ? sdo_response::download(index_, subindex_) : refuse(code);
  }
  if (f.size_indicated && f.total > (size > 0 ? size : kMaxText)) return refuse(AbortCode::length_too_high);
  if (f.size_indicated && f.total < size) return refuse(AbortCode::length_too_low);
  transfer_ = Transfer::download;
  toggle_ = false;
  size_known_ = f.size_indicated;
  total_ = f.total;
  done_ = 0;
  return sdo_response::download(index_, subindex_);
}

SdoBytes SdoServer::continue_download(const SdoFrame& f) noexcept {
  if (transfer_ != Transfer::download) return refuse(AbortCode::command_specifier_invalid);
  if (f.toggle != toggle_) return refuse(AbortCode::toggle_not_alternated);
  if (done_ + f.size > (size_known_ ? total_ : kMaxText)) return refuse(AbortCode::length_too_high);
  std::copy_n(f.data.begin(), f.size, buffer_.begin() + static_cast<std::ptrdiff_t>(done_));
  done_ += f.size;
  toggle_ = !toggle_;
  if (f.last) {
    if (size_known_ && done_ != total_) return refuse(AbortCode::length_too_low);
    transfer_ = Transfer::none;
    const AbortCode code = objects_.write(index_, subindex_, std::span(buffer_).first(done_));
    if (code != AbortCode::none) return refuse(code);
  }
  return sdo_response::download_segment(f.toggle);
}

SdoBytes SdoServer::begin_upload(const SdoFrame& f) noexcept {
  transfer_ = Transfer::none;
  index_ = f.index;
  subindex_ = f.subindex;
  const AbortCode code = objects_.read(index_, subindex_, buffer_, total_);
  if (code != AbortCode::none) return refuse(code);
  if (total_ >= 1 && total_ <= 4)
    return sdo_response::upload_expedited(index_, subindex_, std::span(buffer_).first(total_));
  transfer_ = Transfer::upload;
  toggle_ = false;
  done_ = 0;
  return sdo_response::upload_segmented(index_, subindex_, static_cast<std::uint32_t>(total_));
}

SdoBytes SdoServer::continue_upload(const SdoFrame& f) noexcept {
  if (transfer_ != Transfer::upload) return refuse(AbortCode::command_specifier_invalid);
  if (f.toggle != toggle_) return refuse(AbortCode::toggle_not_alternated);
  const std::size_t part = std::min<std::size_t>(7, total_ - done_);
  const auto piece = std::span(buffer_).subspan(done_, part);
  done_ += part;
  toggle_ = !toggle_;
  const bool last = done_ == total_;
  if (last) transfer_ = Transfer::none;
  return sdo_response::upload_segment(f.toggle, piece, last);
}

}  // namespace servogate::canopen
