// SPDX-License-Identifier: Apache-2.0
#include "report/capture/mcap_capture.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>

#include "firmware_if/text/system_words.hpp"
#include "report/capture/csv_capture.hpp"
#include "report/capture/mcap_records.hpp"

namespace servogate::report {

using mcap::Content;
using mcap::Kind;

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

const char* const kFrameSchema =
    R"({"type":"object","properties":{"id":{"type":"integer"},"extended":{"type":"boolean"},)"
    R"("remote":{"type":"boolean"},"fd":{"type":"boolean"},"data":{"type":"string","description":"hexadecimal"}}})";
const char* const kNoteSchema = R"({"type":"object","properties":{"text":{"type":"string"}}})";

}  // namespace

McapCapture::~McapCapture() { end(); }

void McapCapture::put(std::string_view bytes) {
  if (file_ == nullptr || !error_.empty()) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    error_ = path_ + ": " + text::words_of(errno);
  offset_ += bytes.size();
}

void McapCapture::add_topic(const std::string& name, std::string schema) {
  topics_.push_back({name, std::move(schema), {}, static_cast<std::uint16_t>(topics_.size() + 1), 0});
}

std::string McapCapture::schema_record(const Topic& topic) const {
  Content c;
  c.number(topic.id).text(topic.name).text("jsonschema").text(topic.schema);
  std::string out;
  append(out, Kind::schema, c.bytes());
  return out;
}

std::string McapCapture::channel_record(const Topic& topic) const {
  Content c;
  c.number(topic.id).number(topic.id).text(topic.name).text("json").number(std::uint32_t{0});
  std::string out;
  append(out, Kind::channel, c.bytes());
  return out;
}

void McapCapture::begin(const CaptureLayout& layout) {
  for (std::size_t n = 0; n < layout.channels.size(); ++n) {
    const CaptureChannel& c = layout.channels[n];
    auto topic =
        std::find_if(topics_.begin(), topics_.end(), [&](const Topic& t) { return t.name == c.topic; });
    if (topic == topics_.end()) {
      add_topic(c.topic, {});
      topic = topics_.end() - 1;
    }
    topic->fields.emplace_back(nlohmann::json(c.field).dump() + ':', n);
  }
  groups_ = topics_.size();
  for (Topic& topic : topics_) {
    nlohmann::ordered_json schema{{"type", "object"}};
    for (const auto& [field, n] : topic.fields) {
      const CaptureChannel& c = layout.channels[n];
      // `title` is the name under which people asked for it; `channel` its place among all of them.
      nlohmann::ordered_json property{{"type", "number"}, {"title", c.name}, {"channel", n}};
      if (!c.unit.empty()) property["description"] = c.unit;
      schema["properties"][c.field] = property;
    }
    topic.schema = schema.dump();
  }
  buses_ = layout.buses.size();
  for (const std::string& bus : layout.buses) add_topic(std::string(mcap::kFrames) + bus, kFrameSchema);
  add_topic(std::string(mcap::kNotes), kNoteSchema);

  file_ = std::fopen(path_.c_str(), "wb");
  if (file_ == nullptr) {
    error_ = path_ + ": " + text::words_of(errno);
    return;
  }
  put(mcap::kMagic);
  std::string records;
  append(records, Kind::header, Content().text("").text("servogate").bytes());
  put(records);
  Content pairs;
  for (const auto& [key, value] : layout.origin) pairs.text(key).text(value);
  pairs.text(mcap::kPeriod).text(std::to_string(layout.period_ns));
  records.clear();
  append(records, Kind::metadata, Content().text(mcap::kOrigin).text(pairs.bytes()).bytes());
  metadata_offset_ = offset_;
  metadata_length_ = records.size();
  put(records);
  for (const Topic& topic : topics_) put(schema_record(topic) + channel_record(topic));
}

void McapCapture::message(Topic& topic, image::Nanoseconds t_ns, std::string_view json) {
  const auto t = static_cast<std::uint64_t>(t_ns);
  if (chunk_.empty()) chunk_begin_ns_ = chunk_end_ns_ = t;
  if (messages_ == 0) first_ns_ = last_ns_ = t;
  chunk_begin_ns_ = std::min(chunk_begin_ns_, t);
  chunk_end_ns_ = std::max(chunk_end_ns_, t);
  first_ns_ = std::min(first_ns_, t);
  last_ns_ = std::max(last_ns_, t);
  chunk_index_[topic.id] += Content().number(t).number(static_cast<std::uint64_t>(chunk_.size())).bytes();
  Content c;
  c.number(topic.id).number(topic.sequence++).number(t).number(t).raw(json);
  append(chunk_, Kind::message, c.bytes());
  ++messages_;
  if (chunk_.size() >= kChunk) flush_chunk();
}

void McapCapture::row(image::Nanoseconds t_ns, std::span<const double> values) {
  for (std::size_t n = 0; n < groups_; ++n) {
    json_ = '{';
    for (const auto& [field, channel] : topics_[n].fields) {
      if (json_.size() > 1) json_ += ',';
      json_ += field;
      append_number(json_, values[channel], "null");
    }
    json_ += '}';
    message(topics_[n], t_ns, json_);
  }
}

void McapCapture::frame(const CaptureFrame& f) {
  if (static_cast<std::size_t>(f.bus) >= buses_) return;
  json_ = "{\"id\":" + std::to_string(f.frame.id);
  const auto flag = [this](const char* name, bool is) {
    json_ += std::string(",\"") + name + "\":" + (is ? "true" : "false");
  };
  flag("extended", f.frame.extended);
  flag("remote", f.frame.remote);
  flag("fd", f.frame.fd);
  json_ += ",\"data\":\"";
  append_hex(json_, f.frame);
  json_ += "\"}";
  message(topics_[groups_ + static_cast<std::size_t>(f.bus)], f.t_ns, json_);
}

void McapCapture::note(image::Nanoseconds t_ns, const std::string& text) {
  message(topics_.back(), t_ns,
          nlohmann::json{{"text", text}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void McapCapture::flush_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex index{chunk_begin_ns_, chunk_end_ns_, offset_, 0, {}, 0, chunk_.size()};
  Content c;
  c.number(index.begin_ns).number(index.end_ns).number(index.size).number(checksum(chunk_)).text("");
  c.number(index.size).raw(chunk_);
  std::string record;
  append(record, Kind::chunk, c.bytes());
  index.length = record.size();
  put(record);
  const std::uint64_t indexes = offset_;
  for (const auto& [channel, pairs] : chunk_index_) {
    index.index_offsets[channel] = offset_;
    record.clear();
    append(record, Kind::message_index, Content().number(channel).text(pairs).bytes());
    put(record);
  }
  index.index_length = offset_ - indexes;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_index_.clear();
}

void McapCapture::end() {
  if (file_ == nullptr) return;
  flush_chunk();
  std::string record;
  append(record, Kind::data_end, Content().number(std::uint32_t{0}).bytes());
  put(record);

  const std::uint64_t summary_begin = offset_;
  std::string summary, offsets;
  const auto group = [&](Kind kind, std::uint64_t begin) {
    if (summary_begin + summary.size() == begin) return;
    Content c;
    c.number(static_cast<std::uint8_t>(kind)).number(begin).number(summary_begin + summary.size() - begin);
    append(offsets, Kind::summary_offset, c.bytes());
  };
  std::uint64_t begin = summary_begin;
  for (const Topic& topic : topics_) summary += schema_record(topic);
  group(Kind::schema, begin);
  begin = summary_begin + summary.size();
  for (const Topic& topic : topics_) summary += channel_record(topic);
  group(Kind::channel, begin);
  begin = summary_begin + summary.size();
  Content counts;
  for (const Topic& topic : topics_)
    counts.number(topic.id).number(static_cast<std::uint64_t>(topic.sequence));
  Content statistics;
  statistics.number(messages_).number(static_cast<std::uint16_t>(topics_.size()));
  statistics.number(static_cast<std::uint32_t>(topics_.size()))
      .number(std::uint32_t{0})
      .number(std::uint32_t{1});
  statistics.number(static_cast<std::uint32_t>(chunks_.size()))
      .number(first_ns_)
      .number(last_ns_)
      .text(counts.bytes());
  append(summary, Kind::statistics, statistics.bytes());
  group(Kind::statistics, begin);
  begin = summary_begin + summary.size();
  append(summary, Kind::metadata_index,
         Content().number(metadata_offset_).number(metadata_length_).text(mcap::kOrigin).bytes());
  group(Kind::metadata_index, begin);
  begin = summary_begin + summary.size();
  for (const ChunkIndex& chunk : chunks_) {
    Content places;
    for (const auto& [channel, offset] : chunk.index_offsets) places.number(channel).number(offset);
    Content c;
    c.number(chunk.begin_ns)
        .number(chunk.end_ns)
        .number(chunk.offset)
        .number(chunk.length)
        .text(places.bytes());
    c.number(chunk.index_length).text("").number(chunk.size).number(chunk.size);
    append(summary, Kind::chunk_index, c.bytes());
  }
  group(Kind::chunk_index, begin);

  Content footer;
  footer.number(summary_begin).number(summary_begin + summary.size());
  std::string tail = summary + offsets;
  // The checksum covers the summary and the footer up to the checksum itself.
  std::string head;
  append(head, Kind::footer, footer.bytes() + std::string(4, '\0'));
  head.resize(head.size() - 4);
  tail += head;
  const std::uint32_t sum = checksum(tail);
  tail += Content().number(sum).bytes();
  put(tail);
  put(mcap::kMagic);
  if (std::fclose(file_) != 0 && error_.empty()) error_ = path_ + ": " + text::words_of(errno);
  file_ = nullptr;
}

}  // namespace servogate::report
