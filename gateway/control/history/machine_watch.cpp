// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/history/machine_watch.hpp"

#include <algorithm>
#include <span>

#include "gateway/control/history/texts.hpp"
#include "gateway/control/run/words/alarm_entries.hpp"
#include "gateway/control/run/words/stop_words.hpp"

namespace servogate::gateway::history {

using image::ProcessState;

void MachineWatch::add(std::string kind, const text::Entry& entry,
                       const std::vector<std::string>& arguments) {
  found_.push_back(event(std::move(kind), entry, arguments, now_s_));
}

std::string MachineWatch::letter(int axis) const {
  return control_.machine().axes[static_cast<std::size_t>(axis)].letter;
}

std::vector<Event> MachineWatch::look(const image::ProcessImage& image, const cycle::AlarmSnapshot& alarms) {
  found_.clear();
  now_s_ = static_cast<double>(image.now.t_ns) * 1e-9;
  look_at_alarms(alarms);
  look_at_axes(image);
  for (int p = 0; p < image.process_count; ++p) look_at_process(image, p);
  return std::move(found_);
}

void MachineWatch::look_at_alarms(const cycle::AlarmSnapshot& alarms) {
  const std::span records(alarms.records.data(), static_cast<std::size_t>(alarms.count));
  const auto stands = [&](std::uint32_t sequence) {
    return std::any_of(records.begin(), records.end(), [&](const auto& r) { return r.sequence == sequence; });
  };
  for (auto a = alarms_.begin(); a != alarms_.end(); a = stands(a->first) ? std::next(a) : alarms_.erase(a)) {
    if (stands(a->first)) continue;
    add("cleared", says::kCleared,
        {std::to_string(a->second.number), text::both(a->second.english, a->second.russian)});
    found_.back().id = a->second.id;
    found_.back().number = a->second.number;
  }
  std::vector<image::AlarmRecord> fresh;
  std::copy_if(records.begin(), records.end(), std::back_inserter(fresh),
               [&](const auto& r) { return !alarms_.contains(r.sequence); });
  std::sort(fresh.begin(), fresh.end(), [](const auto& a, const auto& b) { return a.sequence < b.sequence; });
  for (const image::AlarmRecord& record : fresh) {
    const auto in = [&](text::Language language) {
      return alarm_entries(control_, std::span(&record, 1), language).front();
    };
    const report::AlarmEntry english = in(text::Language::english);
    Alarm alarm{english.id, english.text, in(text::Language::russian).text, record.number};
    const bool warning = record.reaction <= image::Reaction::warn;
    add("alarm", warning ? says::kWarning : says::kAlarm,
        {std::to_string(record.number), text::both(alarm.english, alarm.russian)});
    found_.back().machine_s = static_cast<double>(record.t_ns) * 1e-9;
    found_.back().id = alarm.id;
    found_.back().number = record.number;
    alarms_.emplace(record.sequence, std::move(alarm));
  }
  const std::uint32_t made = alarms.raised - alarms_seen_;
  if (made > fresh.size()) add("alarm", says::kMissed, {std::to_string(made - fresh.size())});
  alarms_seen_ = alarms.raised;
}

void MachineWatch::look_at_axes(const image::ProcessImage& image) {
  const std::span axes(image.axes.data(), static_cast<std::size_t>(image.axis_count));
  const bool all =
      !axes.empty() && std::all_of(axes.begin(), axes.end(), [](const auto& a) { return a.enabled; });
  const bool none = std::none_of(axes.begin(), axes.end(), [](const auto& a) { return a.enabled; });
  if (powered_ ? none : all) {
    powered_ = all;
    add("drives", all ? says::kDrivesOn : says::kDrivesOff, {});
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].homed == homed_[a]) continue;
    homed_[a] = axes[a].homed;
    add("axis", homed_[a] ? says::kHomed : says::kNotHomed, {letter(static_cast<int>(a))});
  }
}

void MachineWatch::look_at_process(const image::ProcessImage& image, int process) {
  const image::ProcessStatus& now = image.processes[static_cast<std::size_t>(process)];
  image::ProcessStatus& before = processes_[static_cast<std::size_t>(process)];
  const std::string line = std::to_string(now.line);
  if (now.run != before.run) {
    const std::string block = now.typed && typed_ ? typed_(process) : std::string();
    if (now.typed)
      add("program", says::kTyped, {block});
    else
      add("program", says::kStarted, {control_.process(process).texts().file(now.run, 0)});
    before.state = ProcessState::running;
  }
  if (now.state != before.state) {
    const bool went_on = before.state == ProcessState::held && now.state == ProcessState::running;
    if (went_on) add("program", says::kGoesOn, {line});
    if (now.state == ProcessState::held) add("program", says::kHeld, {line});
    if (now.state == ProcessState::ended) add("program", says::kEnded, {});
    if (now.state == ProcessState::stopped_by_alarm) add("program", says::kStoppedByAlarm, {line});
    if (now.state == ProcessState::stopped) {
      const auto in = [&](text::Language language) { return stop_words(control_, image, process, language); };
      add("program", says::kStopped, {line});
      if (const auto english = in(text::Language::english)) {
        found_.back().english = english->text;
        found_.back().russian = in(text::Language::russian)->text;
      }
    }
  }
  before = now;
}

}  // namespace servogate::gateway::history
