// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "machine/files/output_files.hpp"
#include "report/capture/csv_capture.hpp"
#include "report/capture/mcap_reader.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kHolds{"capture.holds", "{0} values, {1} rows from {2} to {3} s, {4} frames",
                         "величин: {0}, строк: {1} (от {2} до {3} с), кадров: {4}"};
const text::Entry kChannel{"capture.channel", "  {0}: {1} to {2} {3}", "  {0}: от {1} до {2} {3}"};
const text::Entry kNote{"capture.note", "{0} s: {1}", "{0} с: {1}"};

/// Sums up what a capture holds, and hands it on.
class Summary final : public report::CaptureSink {
 public:
  explicit Summary(report::CaptureSink* to) : to_(to) {}
  void begin(const report::CaptureLayout& l) override {
    layout = l;
    least.assign(l.channels.size(), std::numeric_limits<double>::infinity());
    most.assign(l.channels.size(), -std::numeric_limits<double>::infinity());
    if (to_ != nullptr) to_->begin(l);
  }
  void row(image::Nanoseconds t_ns, std::span<const double> values) override {
    if (rows++ == 0) first_ns = t_ns;
    last_ns = t_ns;
    for (std::size_t n = 0; n < values.size(); ++n) {  // a value that is none changes nothing
      least[n] = std::min(least[n], values[n]);
      most[n] = std::max(most[n], values[n]);
    }
    if (to_ != nullptr) to_->row(t_ns, values);
  }
  void frame(const report::CaptureFrame& f) override {
    ++frames;
    if (to_ != nullptr) to_->frame(f);
  }
  void note(image::Nanoseconds t_ns, const std::string& text) override {
    notes.emplace_back(t_ns, text);
    if (to_ != nullptr) to_->note(t_ns, text);
  }
  void end() override {
    if (to_ != nullptr) to_->end();
  }

  report::CaptureLayout layout;
  std::vector<double> least, most;
  long long rows = 0, frames = 0;
  image::Nanoseconds first_ns = 0, last_ns = 0;
  std::vector<std::pair<image::Nanoseconds, std::string>> notes;

 private:
  report::CaptureSink* to_;
};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

double seconds(image::Nanoseconds t_ns) { return static_cast<double>(t_ns) * 1e-9; }

nlohmann::ordered_json as_json(const Summary& s) {
  nlohmann::ordered_json out{{"schema", 1},
                             {"rows", s.rows},
                             {"from_s", seconds(s.first_ns)},
                             {"to_s", seconds(s.last_ns)},
                             {"period_s", seconds(s.layout.period_ns)},
                             {"frames", s.frames},
                             {"origin", nlohmann::ordered_json::object()},
                             {"channels", nlohmann::ordered_json::array()},
                             {"notes", nlohmann::ordered_json::array()}};
  for (const auto& [key, value] : s.layout.origin) out["origin"][key] = value;
  for (std::size_t n = 0; n < s.layout.channels.size(); ++n) {
    nlohmann::ordered_json channel{{"name", s.layout.channels[n].name}, {"unit", s.layout.channels[n].unit}};
    channel["least"] =
        s.least[n] <= s.most[n] ? nlohmann::ordered_json(s.least[n]) : nlohmann::ordered_json();
    channel["most"] = s.least[n] <= s.most[n] ? nlohmann::ordered_json(s.most[n]) : nlohmann::ordered_json();
    out["channels"].push_back(channel);
  }
  for (const auto& [t, text] : s.notes) out["notes"].push_back({{"t_s", seconds(t)}, {"text", text}});
  return out;
}

void print(const Summary& s) {
  print_line(say(kHolds, {std::to_string(s.layout.channels.size()), std::to_string(s.rows),
                          text::number(seconds(s.first_ns), 3), text::number(seconds(s.last_ns), 3),
                          std::to_string(s.frames)}));
  for (const auto& [t, text] : s.notes) print_line(say(kNote, {text::number(seconds(t), 3), text}));
  for (std::size_t n = 0; n < s.layout.channels.size(); ++n)
    if (s.least[n] <= s.most[n])
      print_line(say(kChannel, {s.layout.channels[n].name, text::number(s.least[n], 6),
                                text::number(s.most[n], 6), s.layout.channels[n].unit}));
}

}  // namespace

int capture(const CaptureOptions& options) {
  if (!options.csv.empty()) {
    const auto problem = files::problem_of_outputs({{"--csv", options.csv}}, {{options.file, options.file}});
    if (problem) {
      complain(*problem->entry, problem->arguments);
      return problem->wrong_use ? kWrongUse : kInfrastructure;
    }
  }
  report::CsvCapture csv(options.csv);
  Summary summary(options.csv.empty() ? nullptr : &csv);
  const auto unread = report::read_mcap(options.file, summary);
  if (unread) complain(*unread->entry, unread->arguments);
  if (!csv.error().empty()) {
    complain(kCannotWrite, {options.csv, csv.error()});
    return kInfrastructure;
  }
  if (!summary.layout.channels.empty()) {
    if (options.json)
      print_exact(as_json(summary).dump());
    else
      print(summary);
  }
  return unread ? kWrongUse : kDone;
}

}  // namespace servogate::gateway::command
