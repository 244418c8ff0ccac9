// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/program_texts.hpp"

#include <algorithm>
#include <utility>

namespace servogate::channel {

namespace {

template <typename T>
std::int32_t add(std::deque<T>& kept, std::int32_t& gone, std::size_t most, T value) {
  kept.push_back(std::move(value));
  if (kept.size() > most) {
    kept.pop_front();
    ++gone;
  }
  return gone + static_cast<std::int32_t>(kept.size());
}

template <typename T>
std::optional<T> at(const std::deque<T>& kept, std::int32_t gone, std::int32_t number) {
  const std::int64_t index = std::int64_t{number} - gone - 1;
  if (index < 0 || index >= std::ssize(kept)) return std::nullopt;
  return kept[static_cast<std::size_t>(index)];
}

}  // namespace

std::int32_t ProgramTexts::add_finding(text::Finding finding) {
  const std::scoped_lock lock(mutex_);
  return add(findings_, findings_gone_, kFindingsKept, std::move(finding));
}

std::int32_t ProgramTexts::add_message(std::string words) {
  const std::scoped_lock lock(mutex_);
  return add(messages_, messages_gone_, kMessagesKept, std::move(words));
}

void ProgramTexts::set_files(std::uint32_t run, const std::vector<std::string>& files) {
  const std::scoped_lock lock(mutex_);
  if (files_.empty() || files_.back().run != run) {
    files_.push_back({run, files});
    if (files_.size() > kRunsKept) files_.pop_front();
  } else {
    files_.back().names = files;
  }
}

void ProgramTexts::add_frame(std::uint32_t run, std::int64_t executed, const program::Frame& frame) {
  const std::scoped_lock lock(mutex_);
  frames_.push_back({run, executed, frame});
  if (frames_.size() > kFramesKept) frames_.pop_front();
}

std::optional<program::Frame> ProgramTexts::frame(std::uint32_t run, std::int64_t executed) const {
  const std::scoped_lock lock(mutex_);
  for (auto f = frames_.rbegin(); f != frames_.rend(); ++f)
    if (f->run == run && f->executed <= executed) return f->frame;
  const auto first =
      std::find_if(frames_.begin(), frames_.end(), [run](const FrameFrom& f) { return f.run == run; });
  return first == frames_.end() ? std::nullopt : std::optional(first->frame);
}

std::optional<text::Finding> ProgramTexts::finding(std::int32_t number) const {
  const std::scoped_lock lock(mutex_);
  return at(findings_, findings_gone_, number);
}

std::optional<std::string> ProgramTexts::message(std::int32_t number) const {
  const std::scoped_lock lock(mutex_);
  return at(messages_, messages_gone_, number);
}

std::string ProgramTexts::file(std::uint32_t run, std::int32_t index) const {
  const std::scoped_lock lock(mutex_);
  const auto found =
      std::find_if(files_.begin(), files_.end(), [run](const Files& files) { return files.run == run; });
  if (found == files_.end() || index < 0 || index >= std::ssize(found->names)) return {};
  return found->names[static_cast<std::size_t>(index)];
}

}  // namespace servogate::channel
