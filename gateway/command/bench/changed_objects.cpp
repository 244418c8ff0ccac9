// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/changed_objects.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "gateway/cli/messages.hpp"
#include "machine/files/read_file.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {
namespace {

namespace fs = std::filesystem;
using canopen::address_text;
using canopen::SdoOutcome;
using nlohmann::json;

const text::Entry kNoTorqueLimit{"bench.no-torque-limit",
                                 "node {0} has no 6072h: only this program watches its torque",
                                 "у узла {0} нет 6072h: за его моментом следит только эта программа"};
const text::Entry kNotRestored{"bench.not-restored", "{0} of node {1} is not what it was before: {2}",
                               "{0} узла {1} не возвращено к прежнему значению: {2}"};
const text::Entry kPutRight{"bench.put-right",
                            "the run {0} was cut off and had left {1} of node {2} changed; it is {3} again",
                            "прогон {0} был оборван и оставил {1} узла {2} изменённым; снова {3}"};

constexpr const char* kFile = "/changed.json";
constexpr std::size_t kMostFolders = 2000;

json optional_json(const std::optional<std::int64_t>& v) { return v ? json(*v) : json(nullptr); }

json mark_json(const DriveMark& mark) {
  return {{"schema", 1},
          {"bus", mark.bus},
          {"node", mark.node},
          {"product", optional_json(mark.product)},
          {"serial", optional_json(mark.serial)}};
}

bool same_drive(const json& file, const DriveMark& mark) {
  const json own = mark_json(mark);
  return std::all_of(own.items().begin(), own.items().end(),
                     [&](const auto& item) { return file.value(item.key(), json()) == item.value(); });
}

/// nullopt: no bytes in this form.
std::optional<std::vector<std::uint8_t>> bytes_of(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array()) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  for (const json& b : *found) {
    if (!b.is_number_unsigned() || b.get<std::uint64_t>() > 255) return std::nullopt;
    bytes.push_back(b.get<std::uint8_t>());
  }
  return bytes;
}

/// The files of runs in a folder and in the folders of it: a tuning keeps its runs in its own.
std::vector<std::string> files_around(const std::string& out) {
  std::vector<std::string> found;
  std::error_code error;
  fs::path folder = fs::path(out).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  std::size_t seen = 0;
  for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
       !error && at != end && seen < kMostFolders; at.increment(error)) {
    if (!at->is_directory(error)) continue;
    ++seen;
    if (at.depth() >= 1) at.disable_recursion_pending();
    if (fs::exists(at->path().string() + kFile, error)) found.push_back(at->path().string());
  }
  return found;
}

}  // namespace

ChangedObjects::ChangedObjects(canopen::SdoAccess& access, DriveMark mark, std::string folder)
    : access_(access), mark_(std::move(mark)), folder_(std::move(folder)) {}

std::string ChangedObjects::write_file() const {
  if (folder_.empty()) return {};
  std::error_code error;
  if (changed_.empty()) {
    fs::remove(folder_ + kFile, error);
    return error ? error.message() : std::string{};
  }
  json out = mark_json(mark_);
  for (const Changed& c : changed_)
    out["objects"].push_back({{"index", c.index}, {"before", c.before}, {"during", c.during}});
  return report::write_file(folder_ + kFile, out.dump(1) + "\n");
}

std::string ChangedObjects::change(std::uint16_t index, std::int64_t value) {
  const SdoOutcome before = access_.read(mark_.node, index, 0);
  // A drive without its own limit of the torque is watched by the bench alone; anything else must be there.
  if (before.abort == canopen::AbortCode::object_does_not_exist && index == canopen::object::kMaxTorque) {
    complain(kNoTorqueLimit, {std::to_string(mark_.node)});
    return {};
  }
  if (!before.ok()) return before.why();
  if (before.data.size() > 4) return text::both("it is longer than 4 bytes", "он длиннее 4 байтов");
  std::vector<std::uint8_t> bytes(before.data.size());
  canopen::store_le(static_cast<std::uint64_t>(value), bytes);
  changed_.push_back({index, before.data, bytes});
  std::string why = write_file();
  if (why.empty()) {
    const SdoOutcome outcome = access_.write(mark_.node, index, 0, bytes);
    if (outcome.ok()) return {};
    why = outcome.why();
  }
  changed_.pop_back();
  write_file();
  return why;
}

void ChangedObjects::restore() {
  std::vector<Changed> left;
  for (auto c = changed_.rbegin(); c != changed_.rend(); ++c) {
    const SdoOutcome outcome = access_.write(mark_.node, c->index, 0, c->before);
    if (outcome.ok()) continue;
    complain(kNotRestored, {address_text(c->index, 0), std::to_string(mark_.node), outcome.why()});
    left.insert(left.begin(), *c);
  }
  changed_ = std::move(left);
  write_file();
}

bool put_right(canopen::SdoAccess& access, const DriveMark& mark, const std::string& out) {
  bool all = true;
  for (const std::string& run : files_around(out)) {
    std::string why;
    const auto text = files::read_file(run + kFile, files::kMostOfSettings, why);
    const json file = text ? json::parse(*text, nullptr, false) : json();
    if (!file.is_object() || !same_drive(file, mark)) continue;
    const json objects = file.value("objects", json::array());
    bool whole = true;
    for (auto o = objects.rbegin(); o != objects.rend(); ++o) {
      if (!o->is_object() || !o->value("index", json()).is_number_unsigned()) continue;
      const auto before = bytes_of(*o, "before"), during = bytes_of(*o, "during");
      const auto index = (*o)["index"].get<std::uint16_t>();
      if (!before || !during) continue;
      const SdoOutcome now = access.read(mark.node, index, 0);
      if (now.ok() && now.data != *during) continue;
      const SdoOutcome outcome = now.ok() ? access.write(mark.node, index, 0, *before) : now;
      const std::string node = std::to_string(mark.node);
      if (outcome.ok())
        complain(kPutRight, {run, address_text(index, 0), node, std::to_string(canopen::load_le(*before))});
      else
        complain(kNotRestored, {address_text(index, 0), node, outcome.why()});
      whole = whole && outcome.ok();
    }
    std::error_code error;
    if (whole) fs::remove(run + kFile, error);
    all = all && whole;
  }
  return all;
}

}  // namespace servogate::gateway::command
