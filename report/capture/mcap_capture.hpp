// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "report/capture/layout.hpp"

namespace servogate::report {

/// A capture as an MCAP file, which Foxglove, PlotJuggler and others open: a channel a topic with a message
/// of JSON a cycle and its schema, a channel a bus with a message a frame, notes, chunks of a megabyte with
/// indexes, a summary. Log time is the machine time in ns. Source: mcap.dev/spec.
class McapCapture final : public CaptureSink {
 public:
  explicit McapCapture(std::string path) : path_(std::move(path)) {}
  ~McapCapture() override;
  void begin(const CaptureLayout& layout) override;
  void row(image::Nanoseconds t_ns, std::span<const double> values) override;
  void frame(const CaptureFrame& frame) override;
  void note(image::Nanoseconds t_ns, const std::string& text) override;
  void end() override;
  std::string error() const override { return error_; }

 private:
  struct Topic {
    std::string name, schema;
    std::vector<std::pair<std::string, std::size_t>> fields;  ///< `"field":` and index of the channel
    std::uint16_t id = 0;                                     ///< from 1, of channel and schema
    std::uint32_t sequence = 0;
  };
  struct ChunkIndex {
    std::uint64_t begin_ns, end_ns, offset, length;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
    std::uint64_t index_length, size;
  };
  void add_topic(const std::string& name, std::string schema);
  void message(Topic& topic, image::Nanoseconds t_ns, std::string_view json);
  void flush_chunk();
  void put(std::string_view bytes);
  std::string schema_record(const Topic& topic) const;
  std::string channel_record(const Topic& topic) const;

  std::string path_, error_;
  std::FILE* file_ = nullptr;
  std::uint64_t offset_ = 0;
  std::vector<Topic> topics_;  ///< groups of channels, then buses, then notes
  std::size_t groups_ = 0, buses_ = 0;
  std::string json_;
  std::string chunk_;
  std::uint64_t chunk_begin_ns_ = 0, chunk_end_ns_ = 0;
  std::map<std::uint16_t, std::string> chunk_index_;  ///< pairs of time and offset, by channel
  std::vector<ChunkIndex> chunks_;
  std::uint64_t metadata_offset_ = 0, metadata_length_ = 0;
  std::uint64_t messages_ = 0, first_ns_ = 0, last_ns_ = 0;
};

}  // namespace servogate::report
