// SPDX-License-Identifier: Apache-2.0
#include "report/capture/mcap_reader.hpp"

#include <zlib.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "firmware_if/text/system_words.hpp"
#include "report/capture/mcap_records.hpp"

namespace servogate::report {

using mcap::Kind;
using nlohmann::json;

namespace {

constexpr std::uint64_t kMostRecord = std::uint64_t{256} << 20;
constexpr std::size_t kMostChannels = 65536;
constexpr std::size_t kMostMessage = std::size_t{16} << 20;

const text::Entry kNoFile{"capture.no-file", "cannot read {0}: {1}", "{0} не читается: {1}"};
const text::Entry kNoRegularFile{"capture.no-regular-file", "{0} is no regular file",
                                 "{0} — не обычный файл"};
const text::Entry kNoCapture{"capture.not-mcap",
                             "{0} is no MCAP file: it does not begin with the mark of one",
                             "{0} — не файл MCAP: он не начинается с его метки"};
const text::Entry kDamaged{"capture.damaged", "{0} is damaged at byte {1}: what stands before it was read",
                           "{0} повреждён с байта {1}: прочитано то, что стоит до него"};
const text::Entry kCompressed{"capture.compressed",
                              "{0}: its chunks are compressed with {1}: convert it with `mcap compress "
                              "--compression none`",
                              "{0}: его блоки сжаты ({1}): преобразуйте его командой `mcap compress "
                              "--compression none`"};
const text::Entry kForeign{"capture.foreign", "{0} is no capture of servogate: it has no channel of values",
                           "{0} — не запись servogate: в ней нет ни одного канала значений"};

/// The content of a record does not hold what it should.
struct Malformed {};

/// Takes numbers and texts off a record's content.
class Input {
 public:
  explicit Input(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  T number() {
    std::uint64_t value = 0;
    const std::string_view from = take(sizeof(T));
    for (std::size_t n = 0; n < sizeof(T); ++n)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(from[n])) << (8 * n);
    return static_cast<T>(value);
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) throw Malformed{};
    const std::string_view part = bytes_.substr(0, static_cast<std::size_t>(size));
    bytes_.remove_prefix(part.size());
    return part;
  }
  std::string_view rest() const noexcept { return bytes_; }
  bool empty() const noexcept { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

std::string as_text(const json& object, const char* key) {
  const auto at = object.find(key);
  return at != object.end() && at->is_string() ? at->get<std::string>() : std::string();
}

image::CanFrame frame_of(const json& message) {
  image::CanFrame f;
  f.id = message.value("id", 0u);
  f.extended = message.value("extended", false);
  f.remote = message.value("remote", false);
  f.fd = message.value("fd", false);
  const std::string data = as_text(message, "data");
  if (data.size() % 2 != 0 || data.size() / 2 > f.data.size()) throw Malformed{};
  f.length = static_cast<std::uint8_t>(data.size() / 2);
  for (std::size_t n = 0; n < f.length; ++n) {
    const auto digit = [](char c) -> int {
      if (c >= '0' && c <= '9') return c - '0';
      if (c >= 'A' && c <= 'F') return c - 'A' + 10;
      throw Malformed{};
    };
    f.data[n] = static_cast<std::uint8_t>(16 * digit(data[2 * n]) + digit(data[2 * n + 1]));
  }
  return f;
}

class Reader {
 public:
  Reader(const std::string& path, CaptureSink& sink) : path_(path), sink_(sink) {}
  std::optional<UnreadCapture> read();

 private:
  struct Topic {
    std::string name;
    std::uint16_t schema = 0;
    std::map<std::string, std::size_t> fields;  ///< to index of the channel
    int bus = -1;
  };
  bool record(Kind kind, std::string_view content);
  void chunk(std::string_view content);
  void message(std::string_view content);
  void begin();
  void give_row();

  const std::string& path_;
  CaptureSink& sink_;
  CaptureLayout layout_;
  std::map<std::uint16_t, std::pair<std::string, json>> schemas_;
  std::map<std::uint16_t, Topic> topics_;
  bool begun_ = false;
  std::optional<image::Nanoseconds> row_ns_;
  std::vector<double> row_;
  std::optional<UnreadCapture> problem_;
};

void Reader::begin() {
  begun_ = true;
  std::map<std::size_t, CaptureChannel> channels;
  for (auto& [id, topic] : topics_) {
    if (topic.name.starts_with(mcap::kFrames)) {
      topic.bus = static_cast<int>(layout_.buses.size());
      layout_.buses.push_back(topic.name.substr(mcap::kFrames.size()));
      continue;
    }
    const auto schema = schemas_.find(topic.schema);
    if (topic.name == mcap::kNotes || schema == schemas_.end()) continue;
    const json& properties = schema->second.second.value("properties", json::object());
    for (const auto& [field, property] : properties.items()) {
      const auto at = property.find("channel");
      if (at == property.end() || !at->is_number_unsigned() || *at >= kMostChannels) continue;
      channels[*at] = {as_text(property, "title"), as_text(property, "description"), topic.name, field};
      topic.fields[field] = *at;
    }
  }
  std::map<std::size_t, std::size_t> index;
  for (const auto& [number, channel] : channels) {
    index[number] = layout_.channels.size();
    layout_.channels.push_back(channel);
  }
  for (auto& [id, topic] : topics_)
    for (auto& [field, number] : topic.fields) number = index[number];
  if (layout_.channels.empty()) {
    problem_ = UnreadCapture{&kForeign, {path_}};
    return;
  }
  row_.assign(layout_.channels.size(), std::numeric_limits<double>::quiet_NaN());
  sink_.begin(layout_);
}

void Reader::give_row() {
  if (!row_ns_) return;
  sink_.row(*row_ns_, row_);
  row_.assign(row_.size(), std::numeric_limits<double>::quiet_NaN());
  row_ns_.reset();
}

void Reader::message(std::string_view content) {
  if (!begun_) begin();
  if (problem_) return;
  Input in(content);
  const auto topic = topics_.find(in.number<std::uint16_t>());
  in.number<std::uint32_t>();
  const auto t = static_cast<image::Nanoseconds>(in.number<std::uint64_t>());
  in.number<std::uint64_t>();
  if (topic == topics_.end() || in.rest().size() > kMostMessage) throw Malformed{};
  const json message = json::parse(in.rest(), nullptr, false);
  if (!message.is_object()) throw Malformed{};
  if (topic->second.fields.empty()) {
    give_row();
    if (topic->second.bus >= 0) sink_.frame({t, topic->second.bus, frame_of(message)});
    if (topic->second.name == mcap::kNotes) sink_.note(t, as_text(message, "text"));
    return;
  }
  if (row_ns_ && *row_ns_ != t) give_row();
  row_ns_ = t;
  for (const auto& [field, value] : message.items())
    if (const auto at = topic->second.fields.find(field);
        at != topic->second.fields.end() && value.is_number())
      row_[at->second] = value.get<double>();
}

void Reader::chunk(std::string_view content) {
  Input in(content);
  in.number<std::uint64_t>();
  in.number<std::uint64_t>();
  const auto size = in.number<std::uint64_t>();
  const auto sum = in.number<std::uint32_t>();
  const std::string compression(in.text());
  const std::string_view records = in.take(in.number<std::uint64_t>());
  if (!compression.empty()) {
    problem_ = UnreadCapture{&kCompressed, {path_, compression}};
    return;
  }
  if (records.size() != size) throw Malformed{};
  if (sum != 0 &&
      sum != crc32(0, reinterpret_cast<const Bytef*>(records.data()), static_cast<uInt>(records.size())))
    throw Malformed{};
  Input each(records);
  while (!each.empty() && !problem_) {
    const auto kind = static_cast<Kind>(each.number<std::uint8_t>());
    if (kind == Kind::chunk) throw Malformed{};
    record(kind, each.take(each.number<std::uint64_t>()));
  }
}

/// False: nothing of the data comes behind it.
bool Reader::record(Kind kind, std::string_view content) {
  Input in(content);
  switch (kind) {
    case Kind::schema: {
      if (begun_) break;
      const auto id = in.number<std::uint16_t>();
      const std::string name(in.text());
      in.text();
      json schema = json::parse(in.text(), nullptr, false);
      if (!schema.is_object()) throw Malformed{};
      schemas_[id] = {name, std::move(schema)};
      break;
    }
    case Kind::channel: {
      if (begun_) break;
      const auto id = in.number<std::uint16_t>();
      Topic topic;
      topic.schema = in.number<std::uint16_t>();
      topic.name = std::string(in.text());
      topics_[id] = std::move(topic);
      break;
    }
    case Kind::metadata: {
      if (in.text() != mcap::kOrigin) break;
      Input pairs(in.text());
      while (!pairs.empty()) {
        std::string key(pairs.text()), value(pairs.text());
        if (key == mcap::kPeriod)
          layout_.period_ns = std::max<image::Nanoseconds>(1, std::strtoll(value.c_str(), nullptr, 10));
        else
          layout_.origin.emplace_back(std::move(key), std::move(value));
      }
      break;
    }
    case Kind::message:
      message(content);
      break;
    case Kind::chunk:
      chunk(content);
      break;
    case Kind::data_end:
    case Kind::footer:
      return false;
    default:
      break;  // what others add is read over, as the specification asks
  }
  return true;
}

std::optional<UnreadCapture> Reader::read() {
  std::error_code ignored;
  if (std::filesystem::exists(path_, ignored) && !std::filesystem::is_regular_file(path_, ignored))
    return UnreadCapture{&kNoRegularFile, {path_}};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path_.c_str(), "rb"), &std::fclose);
  if (file == nullptr) return UnreadCapture{&kNoFile, {path_, text::words_of(errno)}};
  const auto bytes = [&](std::string& out, std::uint64_t size) {
    out.resize(static_cast<std::size_t>(size));
    return std::fread(out.data(), 1, out.size(), file.get()) == out.size();
  };
  std::string head, content;
  if (!bytes(head, mcap::kMagic.size()) || head != mcap::kMagic) return UnreadCapture{&kNoCapture, {path_}};
  std::uint64_t at = mcap::kMagic.size();
  std::fseek(file.get(), 0, SEEK_END);
  const auto total = static_cast<std::uint64_t>(std::ftell(file.get()));
  std::fseek(file.get(), static_cast<long>(at), SEEK_SET);
  bool more = true;
  try {
    while (more && !problem_) {
      if (!bytes(head, 9)) throw Malformed{};
      Input in(head);
      const auto kind = static_cast<Kind>(in.number<std::uint8_t>());
      const auto size = in.number<std::uint64_t>();
      if (size > kMostRecord || size > total - at - 9 || !bytes(content, size)) throw Malformed{};
      more = record(kind, content);
      at += 9 + size;
    }
  } catch (const Malformed&) {
    problem_ = UnreadCapture{&kDamaged, {path_, std::to_string(at)}};
  } catch (const json::exception&) {
    problem_ = UnreadCapture{&kDamaged, {path_, std::to_string(at)}};
  }
  if (!begun_ && !problem_) begin();
  if (begun_ && !layout_.channels.empty()) {
    give_row();
    sink_.end();
  }
  return problem_;
}

}  // namespace

std::optional<UnreadCapture> read_mcap(const std::string& path, CaptureSink& sink) {
  return Reader(path, sink).read();
}

}  // namespace servogate::report
