// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/gains_file.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/object_walk.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/command/bench/toml_file.hpp"

namespace servogate::gateway::command {
namespace {

using bench::LoopGains;
using canopen::address_text;
using canopen::SdoOutcome;

const text::Entry kNoGain{"bench.gains-none", "the table [velocity_gain] is missing",
                          "нет таблицы [velocity_gain]"};
const text::Entry kForm{
    "bench.gains-form",
    "[{0}]: expected object = \"INDEX:SUB\", unit = NUMBER above 0, and inverse = true or not",
    "[{0}]: нужно object = \"INDEX:SUB\", unit = ЧИСЛО больше 0 и, если надо, inverse = true"};
const text::Entry kUnread{"bench.gain-unread", "{0} ({1}) of node {2} cannot be read: {3}",
                          "{0} ({1}) узла {2} не читается: {3}"};
const text::Entry kUnwritten{"bench.gain-unwritten", "{0} ({1}) of node {2} cannot be written: {3}",
                             "{0} ({1}) узла {2} не записывается: {3}"};
const text::Entry kLength{"bench.gain-length", "{0} bytes are no gain", "байтов: {0} — не коэффициент"};
const text::Entry kNotWhole{
    "bench.gain-not-whole",
    "it holds {0}, which is no gain of whole numbers: objects of REAL are not written",
    "в нём {0} — это не целый коэффициент: объекты REAL не записываются"};
const text::Entry kUnknownKey{"bench.gains-key", "{0} is no table or key of a gains file",
                              "{0} — не таблица и не ключ файла коэффициентов"};
const text::Entry kHalfNotch{"bench.gains-notch",
                             "a notch needs both tables, [notch_frequency] and [notch_depth]",
                             "режекторному фильтру нужны обе таблицы: [notch_frequency] и [notch_depth]"};
const text::Entry kRange{"bench.gain-range", "{0} does not fit into the object",
                         "{0} не помещается в объект"};

struct Known {
  const char* name;
  double LoopGains::*gain;
};
constexpr std::uint64_t kMostWhole = 1u << 24;  ///< the bits of a REAL32 are more
constexpr Known kGains[] = {{"velocity_gain", &LoopGains::velocity_gain},
                            {"velocity_integral", &LoopGains::velocity_integral},
                            {"position_gain", &LoopGains::position_gain},
                            {"notch_frequency", &LoopGains::notch_hz},
                            {"notch_depth", &LoopGains::notch_depth}};

/// "": that is its value.
std::string take_value(const SdoOutcome& outcome, const GainObject& o, LoopGains& gains) {
  if (!outcome.ok()) return outcome.why();
  if (outcome.data.empty() || outcome.data.size() > 8)
    return text::render(kLength, std::vector<std::string>{std::to_string(outcome.data.size())},
                        text::user_language());
  const std::uint64_t number = canopen::load_le(outcome.data);
  if (number >= kMostWhole)
    return text::render(kNotWhole, std::vector<std::string>{std::to_string(number)}, text::user_language());
  const double value = static_cast<double>(number) * o.unit;
  gains.*o.gain = !o.inverse ? value : value > 0.0 ? 1.0 / value : 0.0;
  return {};
}

/// "": it was written, and read back into `gains`.
std::string write_one(canopen::SdoAccess& access, canopen::NodeId node, const GainObject& o,
                      std::size_t length, LoopGains& gains) {
  const double gain = gains.*o.gain;
  const double number = std::round((o.inverse ? 1.0 / gain : gain) / o.unit);
  if (!(number >= 0.0) || number >= std::ldexp(1.0, static_cast<int>(8 * std::min<std::size_t>(length, 4))))
    return text::render(kRange, std::vector<std::string>{text::number(gain)}, text::user_language());
  std::vector<std::uint8_t> bytes(length);
  canopen::store_le(static_cast<std::uint64_t>(number), bytes);
  const SdoOutcome outcome = access.write(node, o.at.index, o.at.subindex, bytes);
  return outcome.ok() ? take_value(access.read(node, o.at.index, o.at.subindex), o, gains) : outcome.why();
}

void complain_of(const text::Entry& entry, const GainObject& o, canopen::NodeId node,
                 const std::string& why) {
  complain(entry, {o.name, address_text(o.at.index, o.at.subindex), std::to_string(node), why});
}

}  // namespace

bool GainsFile::has(double LoopGains::*gain) const {
  return std::any_of(objects.begin(), objects.end(), [&](const GainObject& o) { return o.gain == gain; });
}

bool GainsFile::has_notch() const { return has(&LoopGains::notch_hz) && has(&LoopGains::notch_depth); }

std::optional<GainsFile> read_gains_file(const std::string& path) {
  const auto document = read_toml(path);
  if (!document) return std::nullopt;
  using Kind = machine::Element::Kind;
  GainsFile file{path, {}};
  constexpr std::string_view kKeys[] = {"object", "unit", "inverse"};
  for (const machine::Element& table : document->root.children) {
    if (std::none_of(std::begin(kGains), std::end(kGains),
                     [&](const Known& k) { return table.key == k.name; }))
      return wrong_line(path, table.key_at.line, kUnknownKey, {table.key});
    for (const machine::Element& key : table.children)
      if (std::find(std::begin(kKeys), std::end(kKeys), key.key) == std::end(kKeys))
        return wrong_line(path, key.key_at.line, kUnknownKey, {key.key});
  }
  for (const Known& known : kGains) {
    const machine::Element* table = document->root.find(known.name);
    if (table == nullptr) continue;
    const machine::Element* object = table->find("object");
    const machine::Element* unit = table->find("unit");
    const machine::Element* inverse = table->find("inverse");
    const auto at = object != nullptr && object->kind == Kind::string ? canopen::parse_address(object->string)
                                                                      : std::nullopt;
    const bool good = at && unit != nullptr && unit->numeric() && unit->number() > 0.0 &&
                      (inverse == nullptr || inverse->kind == Kind::boolean);
    if (!good) return wrong_line(path, table->key_at.line, kForm, {known.name});
    file.objects.push_back(
        {known.name, *at, unit->number(), inverse != nullptr && inverse->boolean, known.gain});
  }
  if (!file.has(&LoopGains::velocity_gain)) return wrong_line(path, 1, kNoGain, {});
  if (file.has(&LoopGains::notch_hz) != file.has(&LoopGains::notch_depth))
    return wrong_line(path, 1, kHalfNotch, {});
  return file;
}

std::optional<StandingGains> read_gains(canopen::SdoAccess& access, canopen::NodeId node,
                                        const GainsFile& file) {
  StandingGains standing;
  for (const GainObject& o : file.objects) {
    SdoOutcome outcome = access.read(node, o.at.index, o.at.subindex);
    if (const std::string why = take_value(outcome, o, standing.gains); !why.empty()) {
      complain_of(kUnread, o, node, why);
      return std::nullopt;
    }
    standing.bytes.push_back(std::move(outcome.data));
  }
  return standing;
}

bool write_gains(canopen::SdoAccess& access, canopen::NodeId node, const GainsFile& file,
                 const StandingGains& standing, LoopGains& gains) {
  for (std::size_t n = 0; n < file.objects.size(); ++n) {
    const std::string why = write_one(access, node, file.objects[n], standing.bytes[n].size(), gains);
    if (why.empty()) continue;
    complain_of(kUnwritten, file.objects[n], node, why);
    return false;
  }
  return true;
}

bool restore_gains(canopen::SdoAccess& access, canopen::NodeId node, const GainsFile& file,
                   const StandingGains& standing) {
  bool all = true;
  for (std::size_t n = 0; n < file.objects.size(); ++n) {
    const GainObject& o = file.objects[n];
    const SdoOutcome outcome = access.write(node, o.at.index, o.at.subindex, standing.bytes[n]);
    if (outcome.ok()) continue;
    complain_of(kUnwritten, o, node, outcome.why());
    all = false;
  }
  return all;
}

std::string gains_dcf(canopen::SdoAccess& access, canopen::NodeId node, const GainsFile& file) {
  std::vector<canopen::ReadObject> objects;
  for (std::uint8_t sub = 0; sub <= 4; ++sub)
    objects.push_back(
        {canopen::object::kIdentity, sub, access.read(node, canopen::object::kIdentity, sub), true});
  std::erase_if(objects, [](const auto& o) { return !o.outcome.ok(); });
  for (const GainObject& o : file.objects) {
    objects.push_back(
        {o.at.index, o.at.subindex, access.read(node, o.at.index, o.at.subindex), o.at.subindex != 0});
    if (!objects.back().outcome.ok()) return {};
  }
  std::vector<std::string> not_saved;
  return canopen::write_dcf(canopen::saved_configuration(objects, nullptr, node, 1'000'000, not_saved));
}

}  // namespace servogate::gateway::command
