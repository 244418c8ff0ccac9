// SPDX-License-Identifier: Apache-2.0
#include "report/capture/csv_capture.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>

#include "firmware_if/text/csv.hpp"
#include "firmware_if/text/system_words.hpp"
#include "report/decimal.hpp"

namespace servogate::report {

namespace {

void append_seconds(std::string& out, image::Nanoseconds t_ns, bool fine) {
  char text[24];
  out.append(text, write_seconds(text, t_ns, fine));
}

}  // namespace

void append_number(std::string& out, double value, const char* none) {
  if (!std::isfinite(value)) {
    out += none;
    return;
  }
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value == 0.0 ? 0.0 : value).ptr;
  out.append(text, end);
}

void append_hex(std::string& out, const image::CanFrame& frame) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  if (frame.remote) return;
  for (std::size_t n = 0; n < frame.length && n < frame.data.size(); ++n) {
    out += kDigits[frame.data[n] >> 4];
    out += kDigits[frame.data[n] & 0xF];
  }
}

CsvCapture::~CsvCapture() { end(); }

void CsvCapture::put(std::FILE*& file, const std::string& suffix, const char* header,
                     const std::string& line) {
  if (!error_.empty()) return;
  const auto fail = [&] { error_ = path_ + suffix + ": " + text::words_of(errno); };
  if (file == nullptr) {
    file = std::fopen((path_ + suffix).c_str(), "wb");
    if (file == nullptr || std::fputs(header, file) < 0) return fail();
  }
  if (std::fwrite(line.data(), 1, line.size(), file) != line.size()) fail();
}

void CsvCapture::begin(const CaptureLayout& layout) {
  fine_ = layout.period_ns % image::kMicrosecond != 0;
  buses_ = layout.buses;
  line_ = "t";
  for (const CaptureChannel& c : layout.channels) line_ += ',' + text::csv_field(c.name);
  line_ += '\n';
  put(rows_, "", "", line_);
}

void CsvCapture::row(image::Nanoseconds t_ns, std::span<const double> values) {
  line_.clear();
  append_seconds(line_, t_ns, fine_);
  for (const double value : values) {
    line_ += ',';
    append_number(line_, value, "nan");
  }
  line_ += '\n';
  put(rows_, "", "", line_);
}

void CsvCapture::frame(const CaptureFrame& f) {
  const auto bus = static_cast<std::size_t>(f.bus);
  line_.clear();
  append_seconds(line_, f.t_ns, true);
  line_ += ',' + (bus < buses_.size() ? text::csv_field(buses_[bus]) : std::to_string(bus)) + ',';
  char id[16];
  std::snprintf(id, sizeof id, f.frame.extended ? "%08X" : "%03X", f.frame.id);
  line_ += id;
  for (const bool flag : {f.frame.extended, f.frame.remote, f.frame.fd}) line_ += flag ? ",1" : ",0";
  line_ += ',';
  append_hex(line_, f.frame);
  line_ += '\n';
  put(frames_, ".frames.csv", "t,bus,id,extended,remote,fd,data\n", line_);
}

void CsvCapture::note(image::Nanoseconds t_ns, const std::string& text) {
  line_.clear();
  append_seconds(line_, t_ns, true);
  line_ += ',' + text::csv_field(text) + '\n';
  put(notes_, ".notes.csv", "t,text\n", line_);
}

void CsvCapture::end() {
  for (std::FILE** file : {&rows_, &frames_, &notes_}) {
    if (*file != nullptr && std::fclose(*file) != 0 && error_.empty())
      error_ = path_ + ": " + text::words_of(errno);
    *file = nullptr;
  }
}

}  // namespace servogate::report
