// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/record_file.hpp"

#include <readerwriterqueue/readerwriterqueue.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "firmware_if/text/system_words.hpp"
#include "gateway/control/compose/program/program_model.hpp"
#include "machine/files/mapped_file.hpp"
#include "machine/state/state_text.hpp"
#include "report/report.hpp"

namespace servogate::gateway {

namespace {

constexpr int kRecordSchema = 5;
constexpr std::size_t kLongestHead = std::size_t{64} << 20;  ///< bytes of the line that heads a record
constexpr std::size_t kQueued = 2048;
constexpr std::size_t kChunk = 1 << 16;
constexpr std::size_t kChunkHead = 8;  // length, checksum
// First byte of a chunk: what it holds.
constexpr char kCycleChunk = 'c', kChangeChunk = 'p', kSubprogramChunk = 's', kLogicChunk = 'l';
/// Index = ProgramChange::Kind.
constexpr std::string_view kChangeNames[] = {"program", "tables", "block", "touch", "modes", "restart"};
/// Index = plc::LogicChange::Kind.
constexpr std::string_view kLogicNames[] = {"load", "force", "release", "release_all"};
constexpr machine::StatePart kTableParts[] = {machine::StatePart::origins, machine::StatePart::tools,
                                              machine::StatePart::records};
constexpr machine::StatePart kParts[] = {machine::StatePart::origins, machine::StatePart::tools,
                                         machine::StatePart::homing,  machine::StatePart::counters,
                                         machine::StatePart::gains,   machine::StatePart::records,
                                         machine::StatePart::retained};

const text::Entry kLost{"record.lost", "{0} cycles could not be kept: the file is too slow",
                        "не записано циклов: {0}; носитель не успевает"};
const text::Entry kNotRecord{"record.not-record", "not a record of servogate", "это не запись servogate"};
const text::Entry kEmpty{"record.empty", "the file is empty", "файл пуст"};
const text::Entry kOtherSchema{"record.other-schema",
                               "it is of schema {0}, this version of servogate reads schema {1}",
                               "у неё схема {0}, эта версия servogate читает схему {1}"};
const text::Entry kOtherLayout{
    "record.other-layout",
    "it was made by another version or on another kind of processor (a cycle of {0} "
    "bytes, here {1})",
    "она сделана другой версией или на другом процессоре (цикл в {0} байт, здесь {1})"};
const text::Entry kDamagedHead{"record.damaged", "it is damaged before its first cycle, at byte {0}",
                               "она повреждена до первого цикла, байт {0}"};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments = {}) {
  return text::render(entry, arguments, text::user_language());
}

std::uint32_t word_at(std::string_view bytes) {
  std::uint32_t v = 0;
  for (std::size_t i = 4; i-- > 0;) v = v << 8 | static_cast<std::uint8_t>(bytes[i]);
  return v;
}

void put_word(std::string& out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(v >> (8 * i)));
}

/// Checksum of a chunk that also speaks for everything before it.
std::uint32_t chained(std::uint32_t before, std::string_view bytes) {
  std::string all;
  all.reserve(bytes.size() + 4);
  put_word(all, before);
  all.append(bytes);
  return machine::crc32(all);
}

}  // namespace

struct RecordWriter::Queue {
  explicit Queue(const std::string& path) : file(std::fopen(path.c_str(), "wb")) {}
  moodycamel::ReaderWriterQueue<cycle::CycleInputs> cycles{kQueued};
  std::FILE* file;
  std::uint32_t checksum = 0;
};

RecordWriter::RecordWriter(const std::string& path, const RecordHeader& header)
    : queue_(std::make_unique<Queue>(path)) {
  if (queue_->file == nullptr) {
    error_ = text::words_of(errno);
    return;
  }
  nlohmann::json head{{"servogate", "record"},
                      {"schema", kRecordSchema},
                      {"layout", sizeof(cycle::CycleInputs)},
                      {"machine", header.machine},
                      {"machine_sha256", header.machine_sha256},
                      {"period_ns", header.period_ns},
                      {"time_scale", header.time_scale}};
  for (const machine::StatePart part : kParts)
    head["state"][std::string(machine::part_name(part))] = machine::write_part(header.state, part);
  const std::string line = head.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (std::fwrite(line.data(), 1, line.size(), queue_->file) != line.size()) error_ = text::words_of(errno);
  queue_->checksum = machine::crc32(line);
  thread_ = std::thread([this] { drain(); });
}

RecordWriter::~RecordWriter() { close(); }

std::unique_ptr<RecordWriter> begin_record(const std::string& path, const std::string& machine_file,
                                           const machine::MachineState& state, Control& control) {
  RecordHeader header;
  header.machine = std::filesystem::absolute(machine_file).string();
  header.machine_sha256 = report::identify(machine_file).sha256;
  header.state = state;
  header.period_ns = control.cycle().period_ns();
  header.time_scale = control.cycle().time_scale();
  auto record = std::make_unique<RecordWriter>(path, header);
  control.cycle().attach(static_cast<cycle::InputTap*>(record.get()));
  control.attach(record.get());
  return record;
}

void RecordWriter::take(const cycle::CycleInputs& inputs) noexcept {
  if (!queue_->cycles.try_enqueue(inputs)) lost_.fetch_add(1, std::memory_order_relaxed);
}

void RecordWriter::wait_for_room() {
  while (thread_.joinable() && queue_->cycles.size_approx() >= kQueued - 1) std::this_thread::yield();
}

void RecordWriter::take(const ProgramChange& change) {
  const bool loads = change.file != nullptr;
  machine::MachineState state;
  state.tables = change.tables;
  nlohmann::json head{{"kind", kChangeNames[static_cast<std::size_t>(change.kind)]},
                      {"process", change.process}};
  if (!change.block.empty()) head["block"] = change.block;
  if (change.restart)
    head["restart"] = {{"by", static_cast<int>(change.restart->at.by)},
                       {"value", change.restart->at.value},
                       {"skip_levels", change.restart->at.switches.skip_levels},
                       {"dry_run", change.restart->at.switches.dry_run},
                       {"feed", change.restart->feed_mm_min},
                       {"confirm", change.restart->confirm}};
  if (loads) {
    head["path"] = change.file->path;
    head["dialect"] = change.file->dialect;
    for (const machine::StatePart part : kTableParts)
      head["tables"][std::string(machine::part_name(part))] = machine::write_part(state, part);
  }
  const std::scoped_lock lock(loaded_mutex_);
  const bool new_text = loads && change.file != file_;
  head["text"] = new_text;
  std::string chunk =
      kChangeChunk + head.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (new_text) chunk += change.file->text.view();
  if (loads) file_ = change.file;
  loaded_.push_back(std::move(chunk));
}

/// A line of JSON, then the texts of the files one behind the other, byte for byte.
void RecordWriter::take(const plc::LogicChange& change) {
  nlohmann::json head{{"kind", kLogicNames[static_cast<std::size_t>(change.kind)]},
                      {"number", change.number},
                      {"online", change.online},
                      {"name", change.name},
                      {"value", change.value},
                      {"files", nlohmann::json::array()}};
  for (const plc::SourceFile& f : change.files)
    head["files"].push_back({{"name", f.name}, {"bytes", f.text.size()}});
  std::string chunk =
      kLogicChunk + head.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  for (const plc::SourceFile& f : change.files) chunk += f.text;
  const std::scoped_lock lock(loaded_mutex_);
  loaded_.push_back(std::move(chunk));
}

/// The process' number, the name, a line end, the text.
void RecordWriter::take_subprogram(int process, std::string_view name, std::string_view text) {
  const std::scoped_lock lock(loaded_mutex_);
  loaded_.push_back(kSubprogramChunk + std::to_string(process) + std::string(name) + "\n" +
                    std::string(text));
}

/// Writes what was loaded since the last call, behind the cycles encoded so far.
void RecordWriter::write_loaded(std::string& cycles) {
  const std::scoped_lock lock(loaded_mutex_);
  if (loaded_.empty()) return;
  if (cycles.size() > 1) write_chunk(cycles);
  cycles = kCycleChunk;
  for (std::string& chunk : loaded_) write_chunk(chunk);
  loaded_.clear();
}

void RecordWriter::write_chunk(std::string& bytes) {
  queue_->checksum = chained(queue_->checksum, bytes);
  std::string chunk;
  put_word(chunk, static_cast<std::uint32_t>(bytes.size()));
  put_word(chunk, queue_->checksum);
  chunk.append(bytes);
  bytes.clear();
  if (failed_) return;  // what came behind a gap would be no record
  if (std::fwrite(chunk.data(), 1, chunk.size(), queue_->file) == chunk.size()) return;
  error_ = text::words_of(errno);
  failed_ = true;
}

void RecordWriter::drain() {
  cycle::InputEncoder encoder;
  std::vector<std::uint8_t> bytes;
  std::string chunk(1, kCycleChunk);
  cycle::CycleInputs inputs;
  for (bool last = false; !last;) {
    last = stop_.load();
    while (queue_->cycles.try_dequeue(inputs)) {
      // A change is queued before any cycle can see it.
      write_loaded(chunk);
      bytes.clear();
      encoder.append(inputs, bytes);
      chunk.append(bytes.begin(), bytes.end());
      if (chunk.size() < kChunk) continue;
      write_chunk(chunk);
      chunk = kCycleChunk;
    }
    if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  write_loaded(chunk);
  if (chunk.size() > 1) write_chunk(chunk);
  std::string end;
  write_chunk(end);
}

std::string RecordWriter::close() {
  if (thread_.joinable()) {
    stop_ = true;
    thread_.join();
    if (std::fclose(queue_->file) != 0 && error_.empty()) error_ = text::words_of(errno);
    queue_->file = nullptr;
  }
  if (error_.empty() && lost() != 0) error_ = say(kLost, {std::to_string(lost())});
  return error_;
}

bool RecordReader::read_head(const std::string& line, std::string& error) {
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  try {
    if (!json.is_object() || json.value("servogate", "") != "record") {
      const bool broken = json.is_discarded() && line.starts_with("{\"");
      error = line.empty() ? say(kEmpty) : broken ? say(kDamagedHead, {"0"}) : say(kNotRecord);
      return false;
    }
    const int schema = json.value("schema", 0);
    const std::size_t layout = json.value("layout", std::size_t{0});
    if (schema != kRecordSchema || layout != sizeof(cycle::CycleInputs)) {
      error = schema != kRecordSchema
                  ? say(kOtherSchema, {std::to_string(schema), std::to_string(kRecordSchema)})
                  : say(kOtherLayout, {std::to_string(layout), std::to_string(sizeof(cycle::CycleInputs))});
      return false;
    }
    header_.machine = json.value("machine", "");
    header_.machine_sha256 = json.value("machine_sha256", "");
    header_.period_ns = json.value("period_ns", image::Nanoseconds{0});
    header_.time_scale = json.value("time_scale", 1.0);
    for (const machine::StatePart part : kParts) {
      const std::string name(machine::part_name(part));
      machine::read_part(json.at("state").value(name, ""), name, part, header_.state);
    }
  } catch (const nlohmann::json::exception&) {
    error = say(kDamagedHead, {"0"});
    return false;
  }
  checksum_ = machine::crc32(line);
  return true;
}

void RecordReader::read_chunks(std::string_view all, std::size_t at) {
  for (damaged_at_ = at; all.size() - at >= kChunkHead; damaged_at_ = at) {
    const std::size_t length = word_at(all.substr(at));
    if (length > all.size() - at - kChunkHead) return;
    const std::string_view bytes = all.substr(at + kChunkHead, length);
    checksum_ = chained(checksum_, bytes);
    if (checksum_ != word_at(all.substr(at + 4))) return;
    if (length != 0 && !read_chunk(bytes)) return;
    at += kChunkHead + length;
    if (length == 0) {
      damaged_at_ = at;
      whole_ = at == all.size();
      return;
    }
  }
}

bool RecordReader::read_chunk(std::string_view bytes) {
  const char kind = bytes.front();
  bytes.remove_prefix(1);
  if (kind == kCycleChunk) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return true;
  }
  if (kind == kChangeChunk) return read_change(bytes);
  if (kind == kLogicChunk) return read_logic_change(bytes);
  const std::size_t end = bytes.find('\n');
  if (kind != kSubprogramChunk || end == std::string_view::npos || end < 2) return false;
  const int process = bytes.front() - '0';
  if (process < 0 || process >= image::kMaxProcesses || !subprograms_[static_cast<std::size_t>(process)])
    return false;
  subprograms_[static_cast<std::size_t>(process)]->insert_or_assign(std::string(bytes.substr(1, end - 1)),
                                                                    std::string(bytes.substr(end + 1)));
  return true;
}

bool RecordReader::read_logic_change(std::string_view bytes) {
  const std::size_t end = bytes.find('\n');
  const nlohmann::json head = nlohmann::json::parse(bytes.substr(0, end), nullptr, false);
  if (end == std::string_view::npos || !head.is_object()) return false;
  try {
    const auto name = std::find(std::begin(kLogicNames), std::end(kLogicNames), head.value("kind", ""));
    if (name == std::end(kLogicNames)) return false;
    plc::LogicChange change;
    change.kind = static_cast<plc::LogicChange::Kind>(name - std::begin(kLogicNames));
    change.number = head.value("number", 0u);
    change.online = head.value("online", false);
    change.name = head.value("name", "");
    change.value = head.value("value", "");
    std::string_view texts = bytes.substr(end + 1);
    for (const nlohmann::json& f : head.at("files")) {
      const std::size_t size = f.value("bytes", std::size_t{0});
      if (size > texts.size()) return false;
      change.files.push_back({f.value("name", ""), std::string(texts.substr(0, size))});
      texts.remove_prefix(size);
    }
    logic_changes_.push_back(std::move(change));
  } catch (const nlohmann::json::exception&) {
    return false;
  }
  return true;
}

bool RecordReader::read_change(std::string_view bytes) {
  const std::size_t end = bytes.find('\n');
  const nlohmann::json head = nlohmann::json::parse(bytes.substr(0, end), nullptr, false);
  if (end == std::string_view::npos || !head.is_object()) return false;
  try {
    const auto name = std::find(std::begin(kChangeNames), std::end(kChangeNames), head.value("kind", ""));
    if (name == std::end(kChangeNames)) return false;
    ProgramChange change;
    change.kind = static_cast<ProgramChange::Kind>(name - std::begin(kChangeNames));
    change.process = head.value("process", 0);
    change.block = head.value("block", "");
    if (const auto restart = head.find("restart"); restart != head.end()) {
      ProgramRestart& r = change.restart.emplace();
      r.at.by = static_cast<program::RestartAt::By>(restart->value("by", 0));
      r.at.value = restart->value("value", std::int64_t{0});
      r.at.switches.skip_levels = restart->value("skip_levels", std::uint16_t{0});
      r.at.switches.dry_run = restart->value("dry_run", false);
      r.feed_mm_min = restart->value("feed", 0.0);
      r.confirm = restart->value("confirm", false);
    }
    if (head.value("text", false)) {
      if (change.process < 0 || change.process >= image::kMaxProcesses) return false;
      const auto texts = std::make_shared<Texts>();
      subprograms_[static_cast<std::size_t>(change.process)] = texts;
      auto file = std::make_shared<ProgramFile>();
      file->path = head.value("path", "");
      file->dialect = head.value("dialect", "");
      file->text = std::string(bytes.substr(end + 1));
      file->loader = [texts](std::string_view wanted) -> std::optional<program::LoadedProgram> {
        const auto found = texts->find(wanted);
        if (found == texts->end()) return std::nullopt;
        return program::LoadedProgram{found->second};
      };
      files_.push_back(std::move(file));
    }
    if (head.contains("tables")) {
      if (files_.empty()) return false;
      files_.back()->process = change.process;
      change.file = files_.back();
      machine::MachineState state;
      for (const machine::StatePart part : kTableParts) {
        const std::string part_name(machine::part_name(part));
        machine::read_part(head["tables"].value(part_name, ""), part_name, part, state);
      }
      change.tables = state.tables;
    }
    changes_.push_back(std::move(change));
  } catch (const nlohmann::json::exception&) {
    return false;
  }
  return true;
}

std::vector<ProgramChange> RecordReader::changes(const machine::MachineConfig& machine) const {
  for (const std::shared_ptr<ProgramFile>& file : files_) file->model = program_model(machine, file->process);
  return changes_;
}

bool RecordReader::open(const std::string& path, std::string& error) {
  files::MappedFile file;
  error = file.open(path);
  if (!error.empty()) return false;
  const std::string_view content = file.content();
  const std::string_view head = content.substr(0, kLongestHead);
  const std::size_t end = head.find('\n');
  const bool headed = end != std::string_view::npos;
  if (!read_head(std::string(headed ? head.substr(0, end + 1) : head), error)) return false;
  if (headed) read_chunks(content, end + 1);
  decoder_ = std::make_unique<cycle::InputDecoder>(bytes_);
  look_ahead();
  if (!has_next_ && damaged_) error = say(kDamagedHead, {std::to_string(damaged_at_)});
  return has_next_ || !damaged_;
}

void RecordReader::look_ahead() noexcept {
  has_next_ = decoder_->give(next_) && next_.number == expected_++;
  damaged_ = !has_next_ && (!whole_ || decoder_->damaged() || !decoder_->at_end());
}

bool RecordReader::give(cycle::CycleInputs& inputs) noexcept {
  if (!has_next_) return false;
  inputs = next_;
  look_ahead();
  inputs.scan_ended = has_next_ && cycle::tell_of_ended_scan(next_);
  return true;
}

}  // namespace servogate::gateway
