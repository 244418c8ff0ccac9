// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/log/frame_filter.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>

#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/cli/messages.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kBadId{"play.bad-id",
                         "--id {0}: identifiers are hexadecimal, 0 to 1FFFFFFF: 181, or 180-1FF",
                         "--id {0}: идентификаторы шестнадцатеричные, от 0 до 1FFFFFFF: 181 или 180-1FF"};
constexpr std::uint32_t kLargestId = 0x1FFF'FFFF;
constexpr std::size_t kShown = 8;

std::optional<std::uint32_t> identifier(std::string_view word) {
  std::uint32_t value = 0;
  const char* const end = word.data() + word.size();
  const auto read = std::from_chars(word.data(), end, value, 16);
  if (word.empty() || read.ec != std::errc{} || read.ptr != end || value > kLargestId) return std::nullopt;
  return value;
}

}  // namespace

bool FrameFilter::set(const PlayOptions& options) {
  nodes_.assign(options.nodes.begin(), options.nodes.end());
  sender_ = options.sender;
  ids_.clear();
  for (const std::string& word : options.ids) {
    const std::size_t dash = word.find('-');
    const auto first = identifier(std::string_view(word).substr(0, dash));
    const auto last = dash == std::string::npos ? first : identifier(std::string_view(word).substr(dash + 1));
    if (!first || !last || *last < *first) {
      complain(kBadId, {word});
      return false;
    }
    ids_.push_back({*first, *last});
  }
  return true;
}

bool FrameFilter::of_nodes(const image::CanFrame& frame) const noexcept {
  const canopen::CobId id = canopen::classify(frame.id, frame.extended);
  if (id.service == canopen::Service::sync || id.service == canopen::Service::time) return true;
  canopen::NodeId node = id.node;
  if (id.service == canopen::Service::nmt) node = frame.length > 1 ? frame.data[1] : canopen::NodeId{0};
  return node != 0 && std::find(nodes_.begin(), nodes_.end(), node) != nodes_.end();
}

bool FrameFilter::of_ids(std::uint32_t id) const noexcept {
  return std::any_of(ids_.begin(), ids_.end(), [&](const Range& r) { return r.first <= id && id <= r.last; });
}

bool FrameFilter::passes(const image::CanFrame& frame) const noexcept {
  if (!nodes_.empty() && !of_nodes(frame)) return false;
  if (!ids_.empty() && !of_ids(frame.id)) return false;
  return sender_.empty() || (sender_ == "master") == canopen::sent_by_masters(frame);
}

void FrameCount::add(const image::CanFrame& frame) {
  ++by_id_[{frame.extended, frame.id}];
  ++frames_;
}

bool FrameCount::has(const image::CanFrame& frame) const {
  return by_id_.contains({frame.extended, frame.id});
}

std::string FrameCount::Id::text() const {
  char text[16];
  std::snprintf(text, sizeof text, extended ? "%08X" : "%03X", id);
  return text;
}

std::map<std::string, std::int64_t> FrameCount::counts() const {
  std::map<std::string, std::int64_t> counts;
  for (const auto& [id, count] : by_id_) counts[id.text()] = count;
  return counts;
}

std::string FrameCount::words() const {
  std::string words;
  std::size_t shown = 0;
  for (const auto& [id, count] : by_id_) {
    if (shown++ == kShown) break;
    words += (words.empty() ? "" : ", ") + id.text() + " (" + std::to_string(count) + ")";
  }
  if (by_id_.size() <= kShown) return words;
  const std::string more = std::to_string(by_id_.size() - kShown);
  return text::both(words + " and " + more + " more", words + " и ещё " + more);
}

}  // namespace servogate::gateway::command
