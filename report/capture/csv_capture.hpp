// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "report/capture/layout.hpp"

namespace servogate::report {

/// A capture as text: `t,NAME,...`, one row a cycle, t in seconds, every number as short as it reads back the
/// same, `nan` where there is none. Frames stand in a file beside it, FILE.frames.csv:
/// `t,bus,id,extended,remote,fd,data` (id in hexadecimal digits, data too), notes in FILE.notes.csv:
/// `t,text`; both only where there is something to write.
class CsvCapture final : public CaptureSink {
 public:
  explicit CsvCapture(std::string path) : path_(std::move(path)) {}
  ~CsvCapture() override;
  void begin(const CaptureLayout& layout) override;
  void row(image::Nanoseconds t_ns, std::span<const double> values) override;
  void frame(const CaptureFrame& frame) override;
  void note(image::Nanoseconds t_ns, const std::string& text) override;
  void end() override;
  std::string error() const override { return error_; }

 private:
  void put(std::FILE*& file, const std::string& suffix, const char* header, const std::string& line);

  std::string path_, error_;
  bool fine_ = false;  ///< times below a microsecond
  std::vector<std::string> buses_;
  std::FILE *rows_ = nullptr, *frames_ = nullptr, *notes_ = nullptr;
  std::string line_;
};

/// The shortest text that reads back as the same number. Not for the cycle.
void append_number(std::string& out, double value, const char* none);
/// Two digits a byte.
void append_hex(std::string& out, const image::CanFrame& frame);

}  // namespace servogate::report
