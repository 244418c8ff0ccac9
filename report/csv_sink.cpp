// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

#include "firmware_if/text/csv.hpp"
#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/system_words.hpp"
#include "report/decimal.hpp"
#include "report/trace.hpp"
#include "report/work_places.hpp"

namespace servogate::report {

namespace {

constexpr int kPositionDecimals = 12, kFeedDecimals = 9, kErrorDecimals = 9, kSpindleDecimals = 6,
              kWorkDecimals = 6, kAngleDecimals = 3;
constexpr std::size_t kChunk = std::size_t{1} << 18;

std::size_t signal_count(const TraceLayout& layout) {
  return std::min<std::size_t>(layout.signals.size(), kMaxTraceSignals);
}

}  // namespace

struct CsvSink::Impl {
  std::string path;
  CsvColumns columns;
  std::FILE* file = nullptr;
  std::string error;
  std::size_t axes = 0, spindles = 0, signals = 0, further = 0;
  std::optional<WorkPlaces> places;
  bool sub_microsecond = false;
  std::size_t row_max = 0;
  std::vector<char> buffer;
  std::size_t used = 0;

  void fail(const std::string& what) {
    if (error.empty()) error = path + ": " + what + ": " + text::words_of(errno);
  }
  void flush() {
    if (file != nullptr && error.empty() && used > 0 && std::fwrite(buffer.data(), 1, used, file) != used)
      fail(text::both("cannot write", "не записывается"));
    used = 0;
  }
  void put(const std::string& text) {
    if (used + text.size() > buffer.size()) flush();
    if (text.size() > buffer.size()) buffer.resize(text.size());
    std::memcpy(buffer.data() + used, text.data(), text.size());
    used += text.size();
  }
  char* write(char* out, const TraceRow& row) const noexcept;
};

char* CsvSink::Impl::write(char* out, const TraceRow& row) const noexcept {
  out = write_seconds(out, row.t_ns, sub_microsecond);
  *out++ = ',';
  out = write_fixed(out, row.feed_mm_s, kFeedDecimals);
  *out++ = ',';
  out = write_integer(out, row.line);
  for (std::size_t a = 0; a < axes; ++a) {
    *out++ = ',';
    out = write_fixed(out, row.axes[a].command, kPositionDecimals);
    *out++ = ',';
    out = write_fixed(out, row.axes[a].actual, kPositionDecimals);
  }
  for (std::size_t s = 0; s < spindles; ++s) {
    *out++ = ',';
    out = write_fixed(out, row.spindles[s].command_rpm, kSpindleDecimals);
    *out++ = ',';
    out = write_fixed(out, row.spindles[s].actual_rpm, kSpindleDecimals);
    *out++ = ',';
    out = write_fixed(out, row.spindles[s].angle_deg, kAngleDecimals);
  }
  for (std::size_t a = 0; a < axes && columns.following_error; ++a) {
    *out++ = ',';
    out = write_fixed(out, row.axes[a].following_error, kErrorDecimals);
  }
  for (std::size_t n = 0; n < signals; ++n) {
    *out++ = ',';
    *out++ = row.signal(n) ? '1' : '0';
  }
  for (std::size_t p = 0; p < further; ++p) {
    *out++ = ',';
    out = write_fixed(out, row.further[p].feed_mm_s, kFeedDecimals);
    *out++ = ',';
    out = write_integer(out, row.further[p].line);
    *out++ = ',';
    out = write_integer(out, row.further[p].tool);
  }
  for (std::size_t a = 0; a < axes && places; ++a) {
    *out++ = ',';
    if (places->known(a))
      out = write_fixed(out, places->place(a, row), kWorkDecimals);
    else
      out = std::copy_n("nan", 3, out);
  }
  *out++ = '\n';
  return out;
}

CsvSink::CsvSink(std::string path, CsvColumns columns) : impl_(std::make_unique<Impl>()) {
  impl_->path = std::move(path);
  impl_->columns = columns;
}

CsvSink::~CsvSink() {
  if (impl_->file != nullptr) std::fclose(impl_->file);
}

std::string CsvSink::header(const TraceLayout& layout, CsvColumns columns) {
  std::string out = "t,feed,line";
  for (const std::string& a : layout.axes)
    out += "," + text::csv_field(a + ".cmd") + "," + text::csv_field(a + ".act");
  for (int s = 0; s < layout.spindles; ++s) {
    const std::string name = s == 0 ? "spindle" : "spindle" + std::to_string(s + 1);
    out += "," + name + ".cmd," + name + ".act," + name + ".angle";
  }
  if (columns.following_error)
    for (const std::string& a : layout.axes) out += "," + text::csv_field(a + ".error");
  if (columns.signals)
    for (std::size_t n = 0; n < signal_count(layout); ++n)
      out += "," + text::csv_field(layout.signals[n].name);
  for (int p = 2; p <= layout.processes; ++p) {
    const std::string number = std::to_string(p);
    out += ",feed" + number + ",line" + number + ",tool" + number;
  }
  if (columns.work && layout.frame_of)
    for (const std::string& a : layout.axes) out += "," + text::csv_field(a + ".work");
  return out;
}

void CsvSink::begin(const TraceLayout& layout) {
  Impl& i = *impl_;
  i.axes = std::min<std::size_t>(layout.axes.size(), image::kMaxAxes);
  i.spindles = static_cast<std::size_t>(std::clamp(layout.spindles, 0, image::kMaxSpindles));
  i.further = static_cast<std::size_t>(std::clamp(layout.processes, 1, image::kMaxProcesses) - 1);
  i.signals = i.columns.signals ? signal_count(layout) : 0;
  i.sub_microsecond = layout.period_ns % image::kMicrosecond != 0;
  i.row_max = 64 + kFixedMax * (1 + 4 * i.axes + 3 * i.spindles + 3 * i.further) + 2 * i.signals;
  if (i.columns.work && layout.frame_of) i.places.emplace(layout);
  i.buffer.resize(kChunk + i.row_max);
  i.file = std::fopen(i.path.c_str(), "wb");
  if (i.file == nullptr) i.fail(text::both("cannot create", "не создаётся"));
  i.put(header(layout, i.columns) + "\n");
}

void CsvSink::row(const TraceRow& row) {
  Impl& i = *impl_;
  if (i.used > kChunk) i.flush();
  if (i.places) i.places->follow(row);
  i.used = static_cast<std::size_t>(i.write(i.buffer.data() + i.used, row) - i.buffer.data());
}

void CsvSink::end(std::uint64_t) {
  impl_->flush();
  if (impl_->file != nullptr && std::fclose(impl_->file) != 0)
    impl_->fail(text::both("cannot close", "не закрывается"));
  impl_->file = nullptr;
}

std::string CsvSink::error() const { return impl_->error; }

}  // namespace servogate::report
