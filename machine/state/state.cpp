// SPDX-License-Identifier: Apache-2.0
#include "machine/state/state.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include "firmware_if/text/system_words.hpp"
#include "machine/files/read_file.hpp"
#include "machine/keys/findings.hpp"
#include "machine/state/state_lock.hpp"
#include "machine/state/state_text.hpp"

namespace servogate::machine {

namespace {

namespace fs = std::filesystem;

/// Those of one file each; the retained variables have two copies.
constexpr StatePart kParts[] = {StatePart::origins,  StatePart::tools, StatePart::homing,
                                StatePart::counters, StatePart::gains, StatePart::records};

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

bool write_whole(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(fd, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool sync_folder(const std::string& folder) {
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return fd.get() >= 0 && ::fsync(fd.get()) == 0;
}

bool write_temporary(const std::string& temporary, std::string_view text) {
  // What stands there is left from a save that was broken off, or leads elsewhere.
  if (::unlink(temporary.c_str()) != 0 && errno != ENOENT) return false;
  const Descriptor fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  return fd.get() >= 0 && write_whole(fd.get(), text) && ::fsync(fd.get()) == 0;
}

/// Temporary file, fsync, rename, fsync of the folder; the other copy is not touched.
bool write_copy(const std::string& folder, const std::string& file, std::string_view text) {
  const std::string temporary = file + ".new";
  return write_temporary(temporary, text) && ::rename(temporary.c_str(), file.c_str()) == 0 &&
         sync_folder(folder);
}

/// Temporary file, fsync, the present generation kept under another name, rename, fsync of the folder: at
/// every point of time one whole generation has a name that load() looks at.
bool write_generation(const std::string& folder, const std::string& file, const std::string& previous,
                      std::string_view text) {
  const std::string temporary = file + ".new";
  if (!write_temporary(temporary, text)) return false;
  if (::unlink(previous.c_str()) != 0 && errno != ENOENT) return false;
  if (::link(file.c_str(), previous.c_str()) != 0 && errno != ENOENT) return false;
  if (::rename(temporary.c_str(), file.c_str()) != 0) return false;
  return sync_folder(folder);
}

/// A generation's content; nullopt: there is no such file, or a finding says why it cannot be read.
std::optional<std::string> contents(const std::string& path, std::vector<text::Finding>& findings) {
  std::string reason;
  if (auto content = files::read_file(path, files::kMostOfSettings, reason)) return content;
  std::error_code error;
  if (fs::exists(path, error) || error)
    findings.push_back({text::Severity::error, path, 1, 1, &finding::kFileMissing, {reason}});
  return std::nullopt;
}

bool any_error(const std::vector<text::Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const text::Finding& f) { return f.severity == text::Severity::error; });
}

std::string previous_of(const std::string& file) {
  return file.substr(0, file.size() - 5) + ".previous.toml";
}

/// What a person has lost with a part, and what makes it good again.
struct Loss {
  StatePart part;
  std::string_view lost, lost_ru, remedy, remedy_ru;
};
constexpr Loss kLosses[] = {
    {StatePart::origins, "the origins are lost", "начала отсчёта утрачены", "set them again (`zero`)",
     "задайте их заново (`zero`)"},
    {StatePart::tools, "the lengths and diameters of the tools are lost",
     "вылеты и диаметры инструментов утрачены", "measure the tools again", "измерьте инструменты заново"},
    {StatePart::homing, "the references of the axes and the tool in the spindle are lost",
     "привязка осей и номер инструмента в шпинделе утрачены",
     "home all axes again, absolute encoders too, and call the tool anew",
     "выведите все оси в ноль, с абсолютными датчиками тоже, и вызовите инструмент заново"},
    {StatePart::counters, "the counters are lost", "счётчики утрачены", "they begin at 0",
     "они начнутся с нуля"},
    {StatePart::gains, "the gains that were found are lost", "найденные коэффициенты утрачены",
     "tune again; until then those of the machine file hold",
     "настройте заново; до этого действуют коэффициенты файла станка"},
    {StatePart::records, "the record files of part programs are lost", "файлы записей программ утрачены",
     "have the programs create them anew", "дайте программам создать их заново"}};

text::Finding loss_of(StatePart part, const std::string& file, const std::string& other, bool both) {
  const auto& l = *std::find_if(std::begin(kLosses), std::end(kLosses),
                                [part](const Loss& row) { return row.part == part; });
  return {text::Severity::error,
          file,
          1,
          1,
          both ? &finding::kPartLost : &finding::kPartLostAlone,
          {other, text::both(l.lost, l.lost_ru), text::both(l.remedy, l.remedy_ru)}};
}

/// One part from its newest whole generation.
void load_part(const std::string& file, StatePart part, const std::vector<std::string>& axes,
               MachineState& state, std::vector<text::Finding>& findings) {
  const std::string previous = previous_of(file);
  std::vector<text::Finding> problems, of_previous;
  const auto newest = contents(file, problems), older = contents(previous, of_previous);
  const bool file_there = newest || !problems.empty(), previous_there = older || !of_previous.empty();
  if (!file_there && !previous_there) return;
  if (newest) {
    problems = read_part(*newest, file, part, state, axes);
    if (!any_error(problems)) {
      findings.insert(findings.end(), problems.begin(), problems.end());
      return;
    }
  }
  if (file_there && edited_by_people(part)) {
    findings.insert(findings.end(), problems.begin(), problems.end());
    if (older) findings.push_back({text::Severity::error, file, 1, 1, &finding::kTableRefused, {previous}});
    return;
  }
  if (older) of_previous = read_part(*older, previous, part, state, axes);
  if (older && !any_error(of_previous)) {
    for (text::Finding& f : problems) f.severity = text::Severity::warning;
    findings.insert(findings.end(), problems.begin(), problems.end());
    findings.push_back({text::Severity::warning, file, 1, 1, &finding::kPreviousTaken, {previous}});
    return;
  }
  problems.insert(problems.end(), of_previous.begin(), of_previous.end());
  problems.push_back(file_there ? loss_of(part, file, previous, previous_there)
                                : loss_of(part, previous, file, false));
  // A machine moves as well by the gains of its file.
  if (part == StatePart::gains)
    for (text::Finding& f : problems) f.severity = text::Severity::warning;
  findings.insert(findings.end(), problems.begin(), problems.end());
}

/// The retained variables from the newest whole copy.
void load_retained(const std::string (&files)[2], MachineState& state, std::vector<text::Finding>& findings) {
  std::vector<text::Finding> problems;
  const std::string* taken = nullptr;
  MachineState newest;
  for (const std::string& file : files) {
    const auto text = contents(file, problems);
    if (!text) continue;
    MachineState copy;
    std::vector<text::Finding> found = read_part(*text, file, StatePart::retained, copy);
    const bool whole = !any_error(found);
    if (!whole || copy.retained_generation > newest.retained_generation || taken == nullptr)
      problems.insert(problems.end(), found.begin(), found.end());
    if (!whole || (taken != nullptr && copy.retained_generation <= newest.retained_generation)) continue;
    newest = std::move(copy);
    taken = &file;
  }
  if (taken != nullptr) {
    const bool damaged = any_error(problems);
    for (text::Finding& f : problems) f.severity = text::Severity::warning;
    if (damaged)
      problems.push_back({text::Severity::warning,
                          *taken,
                          0,
                          0,
                          &finding::kOtherCopyTaken,
                          {std::to_string(newest.retained_generation)}});
    state.retained = std::move(newest.retained);
    state.retained_generation = newest.retained_generation;
  } else if (!problems.empty()) {
    problems.push_back({text::Severity::error, files[0], 1, 1, &finding::kRetainedLost, {files[1]}});
  }
  findings.insert(findings.end(), problems.begin(), problems.end());
}

}  // namespace

bool StateDirectory::Loaded::fell_back() const {
  return std::any_of(findings.begin(), findings.end(), [](const text::Finding& f) {
    const bool gains = (f.entry == &finding::kPartLost || f.entry == &finding::kPartLostAlone) &&
                       f.severity == text::Severity::warning;
    if (gains) return true;
    return f.entry == &finding::kPreviousTaken || f.entry == &finding::kOtherCopyTaken;
  });
}

bool StateDirectory::Loaded::ok() const { return !any_error(findings); }

StateDirectory::StateDirectory(std::string path, std::vector<std::string> axes)
    : path_(std::move(path)), axes_(std::move(axes)) {}

std::string StateDirectory::file(StatePart part) const {
  return (fs::path(path_) / (std::string(part_name(part)) + ".toml")).string();
}

std::string StateDirectory::retained_file(std::int64_t generation) const {
  return (fs::path(path_) / (generation % 2 == 0 ? "retained.a.toml" : "retained.b.toml")).string();
}

StateDirectory::Loaded StateDirectory::load() const {
  Loaded out;
  for (const StatePart part : kParts) load_part(file(part), part, axes_, out.state, out.findings);
  load_retained({retained_file(0), retained_file(1)}, out.state, out.findings);
  return out;
}

program::Tables StateDirectory::load_tables(std::vector<text::Finding>& findings) const {
  MachineState state;
  for (const StatePart part : {StatePart::origins, StatePart::tools, StatePart::records})
    load_part(file(part), part, axes_, state, findings);
  return state.tables;
}

bool StateDirectory::save(const MachineState& state, StatePart part, std::string& error) const {
  error = make_state_directory(path_);
  if (!error.empty()) return false;
  const bool copies = part == StatePart::retained;
  const std::string name = copies ? retained_file(state.retained_generation) : file(part);
  const std::string text = write_part(state, part);
  if (copies ? write_copy(path_, name, text) : write_generation(path_, name, previous_of(name), text))
    return true;
  error = name + ": " + text::words_of(errno);
  return false;
}

bool StateDirectory::save_all(const MachineState& state, std::string& error) const {
  return std::all_of(std::begin(kParts), std::end(kParts), [&](StatePart part) {
    // Without gains there is nothing to save, and damaged ones stay as they are.
    if (part == StatePart::gains && state.gains.empty()) return true;
    // Most machines never have a record file.
    if (part == StatePart::records && state.tables.record_files.empty() && !fs::exists(file(part)))
      return true;
    return save(state, part, error);
  });
}

}  // namespace servogate::machine
