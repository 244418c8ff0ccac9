// SPDX-License-Identifier: Apache-2.0
// `servogate backup` and `restore`: what a machine has learned, in one file.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/machine_start.hpp"
#include "machine/files/read_file.hpp"
#include "machine/state/state_text.hpp"

namespace servogate::gateway::command {

namespace {

using machine::StatePart;
using nlohmann::json;
using text::Entry;

constexpr StatePart kParts[] = {StatePart::origins,  StatePart::tools, StatePart::homing,
                                StatePart::counters, StatePart::gains, StatePart::records,
                                StatePart::retained};
constexpr int kSchema = 1;

const Entry kWritten{"backup.written",
                     "{0}: {1} origins, {2} tools, the references of {3} axes, {4} values of the PLC",
                     "{0}: начал {1}, инструментов {2}, привязок осей {3}, величин ПЛК {4}"};
const Entry kNotWritten{"backup.not-written", "{0} cannot be written: {1}", "{0} не записывается: {1}"};
const Entry kThere{"backup.there", "{0} is there already: name another file, or --force",
                   "{0} уже есть: задайте "
                   "другой файл или --force"};
const Entry kNotReadable{"backup.not-readable", "{0} cannot be read: {1}", "{0} не читается: {1}"};
const Entry kNoBackup{"backup.no-backup", "{0} is no backup of this program: {1}",
                      "{0} — не копия этой программы: {1}"};
const Entry kOtherMachine{
    "backup.other-machine",
    "{0} is a backup of '{1}', and this machine is '{2}': --force restores it all the same",
    "{0} — копия станка «{1}», а этот станок — «{2}»: --force восстановит её всё равно"};
const Entry kRestored{"backup.restored", "{0} is restored into {1}; what stood there before is in {2}",
                      "{0} восстановлена в {1}; прежнее состояние — в {2}"};
const Entry kHomeAgain{
    "backup.home-again",
    "check the references of absolute encoders before anything moves: a drive or motor that was "
    "swapped counts from elsewhere",
    "проверьте привязку абсолютных датчиков до движения: заменённый привод или двигатель считает "
    "от другого нуля"};
const Entry kRunning{"backup.running", "end the control first (`servogate down`): {0}",
                     "сначала завершите управление (`servogate down`): {0}"};

std::string folder_of(const BackupOptions& options, const machine::MachineConfig& m) {
  return options.state.empty() ? m.resolve(m.run.state) : options.state;
}

/// False: it was said.
bool write_file(const std::string& path, const std::string& content) {
  const std::string temporary = path + ".new";
  std::FILE* file = std::fopen(temporary.c_str(), "wbe");
  bool good = file != nullptr && std::fwrite(content.data(), 1, content.size(), file) == content.size();
  int error = errno;
  if (file != nullptr && std::fclose(file) != 0 && good) {
    good = false;
    error = errno;
  }
  if (good && std::rename(temporary.c_str(), path.c_str()) != 0) {
    good = false;
    error = errno;
  }
  if (!good) complain(kNotWritten, {path, text::words_of(error)});
  return good;
}

json content_of(const machine::MachineConfig& m, const machine::MachineState& state) {
  json parts = json::object();
  for (const StatePart part : kParts)
    parts[std::string(machine::part_name(part))] = machine::write_part(state, part);
  return {{"schema", kSchema}, {"kind", "servogate-backup"}, {"machine", m.name}, {"parts", parts}};
}

/// The state that a backup holds; false: it was said.
bool read_backup(const std::string& path, const machine::MachineConfig& m, bool force,
                 machine::MachineState& state) {
  std::string why;
  const auto text = files::read_file(path, files::kMostOfProgram, why);
  if (!text) {
    complain(kNotReadable, {path, why});
    return false;
  }
  const json content = json::parse(*text, nullptr, false);
  const bool known = content.is_object() && content.value("kind", json()) == "servogate-backup" &&
                     content.value("schema", json()) == kSchema &&
                     content.value("parts", json()).is_object() &&
                     content.value("machine", json()).is_string();
  if (!known) {
    complain(kNoBackup, {path, text::both("its head is another one", "у него другой заголовок")});
    return false;
  }
  const std::string name = content["machine"];
  if (name != m.name && !force) {
    complain(kOtherMachine, {path, name, m.name});
    return false;
  }
  std::vector<text::Finding> findings;
  for (const StatePart part : kParts) {
    const auto entry = content["parts"].find(machine::part_name(part));
    if (entry == content["parts"].end() || !entry->is_string()) {
      complain(kNoBackup, {path, std::string(machine::part_name(part))});
      return false;
    }
    const auto found =
        machine::read_part(entry->get<std::string>(), path + "#" + std::string(machine::part_name(part)),
                           part, state, m.letters());
    findings.insert(findings.end(), found.begin(), found.end());
  }
  return print_findings(findings) == 0;
}

/// The first name NAME.before-N that is not there.
std::string free_name(const std::string& folder) {
  for (int n = 1;; ++n)
    if (const std::string name = folder + ".before-" + std::to_string(n); !std::filesystem::exists(name))
      return name;
}

}  // namespace

int backup(const BackupOptions& options) {
  const machine::LoadResult loaded = machine::load(options.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  if (!options.force && std::filesystem::exists(options.file)) {
    complain(kThere, {options.file});
    return kWrongUse;
  }
  const machine::StateDirectory directory(folder_of(options, loaded.machine), loaded.machine.letters());
  const machine::StateDirectory::Loaded kept = directory.load();
  if (print_findings(kept.findings) > 0) return kWrongUse;
  if (!write_file(options.file, content_of(loaded.machine, kept.state).dump(1) + "\n"))
    return kInfrastructure;
  const auto homed = std::count_if(kept.state.homing.begin(), kept.state.homing.end(),
                                   [](const auto& h) { return h.second.valid; });
  print_line(text::render(
      kWritten,
      std::vector<std::string>{options.file, std::to_string(kept.state.tables.origins.size()),
                               std::to_string(kept.state.tables.correctors.size()), std::to_string(homed),
                               std::to_string(kept.state.retained.size())},
      text::user_language()));
  return kDone;
}

int restore(const BackupOptions& options) {
  const machine::LoadResult loaded = machine::load(options.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  machine::MachineState state;
  if (!read_backup(options.file, loaded.machine, options.force, state)) return kWrongUse;
  const std::string folder = folder_of(options, loaded.machine);
  machine::StateLock lock;
  if (const std::string why = lock.take(folder); !why.empty()) {
    complain(kRunning, {why});
    return kInfrastructure;
  }
  const std::string before = free_name(folder);
  std::error_code error;
  std::filesystem::copy(folder, before, std::filesystem::copy_options::recursive, error);
  if (error) {
    complain(kNotWritten, {before, text::words_of(error.value())});
    return kInfrastructure;
  }
  // A file that was damaged would stand in the way of the newer one.
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") std::filesystem::remove(entry.path(), error);
  const machine::StateDirectory directory(folder);
  std::string why;
  state.retained_generation = std::max<std::int64_t>(1, state.retained_generation);
  if (!directory.save_all(state, why) || !directory.save(state, StatePart::retained, why)) {
    complain(kNotWritten, {folder, why});
    return kInfrastructure;
  }
  print_line(
      text::render(kRestored, std::vector<std::string>{options.file, folder, before}, text::user_language()));
  const auto& axes = loaded.machine.axes;
  if (std::any_of(axes.begin(), axes.end(),
                  [](const auto& a) { return a.home.method == machine::HomingMethod::absolute; }))
    print_line(text::render(kHomeAgain, {}, text::user_language()));
  return kDone;
}

}  // namespace servogate::gateway::command
