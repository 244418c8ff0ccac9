// SPDX-License-Identifier: Apache-2.0
#include "plc/run/run.hpp"

#include <algorithm>
#include <charconv>

#include "plc/engine/engine.hpp"
#include "plc/terms/texts.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/variables/places.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc {

namespace {

struct Set {
  std::int64_t cycle;
  std::optional<Handle> handle;  ///< none: `value` stands at `place` before the scan
  std::string value;
  std::optional<image::Place> place;
  std::string name;
};
struct Print {
  std::string name;
  std::optional<Handle> handle;  ///< none: what stands at `place`
  image::Place place;
};

void refuse(RunResult& out, const text::Entry& entry, std::vector<std::string> arguments) {
  text::Finding f;
  f.file = "plc run";
  f.entry = &entry;
  f.arguments = std::move(arguments);
  out.findings.push_back(std::move(f));
  out.end = RunResult::End::wrong_use;
}

// A place that the program does not use: a symbol of the machine or an address.
std::optional<image::Place> place_in(const RunRequest& r, const image::Packets& packets,
                                     const std::string& name) {
  const std::optional<image::Place> place = place_of(r.symbols, name);
  return place && packets.contains(*place) ? place : std::nullopt;
}

// An address (%MW5) is a bit string, any other name of a place the number or characters there.
const Type& type_at(const TypeTable& types, const image::Place& place, const std::string& name) {
  const Type* const type =
      name.starts_with('%') ? bit_string_type(types, place.format) : number_type(types, place.format);
  return type != nullptr ? *type : *types.elementary(Kind::string);
}

void refuse_value(RunResult& out, const RunSet& set, const Type& type) {
  const std::size_t at = set.value.rfind('@');
  std::vector<std::uint8_t> probe(std::max<std::size_t>(type.size, 8));
  if (at != std::string::npos && parse_value(type, set.value.substr(0, at), probe.data()))
    refuse(out, texts::kRunCycleNumber, {set.value.substr(at + 1)});
  else
    refuse(out, texts::kRunValue, {set.value, set.name, type.name});
}

std::vector<Set> resolve_sets(const RunRequest& r, const Engine& engine, const image::Packets& packets,
                              RunResult& out) {
  std::vector<Set> sets;
  for (const RunSet& s : r.sets) {
    const auto h = engine.find(s.name);
    const auto place = h ? std::nullopt : place_in(r, packets, s.name);
    if (!h && !place) {
      refuse(out, texts::kRunName, {s.name});
      continue;
    }
    const Type& type = h ? *h->type : type_at(*engine.image().types, *place, s.name);
    std::vector<std::uint8_t> probe(std::max<std::size_t>(type.size, 8));
    if (!parse_value(type, s.value, probe.data()))
      refuse_value(out, s, type);
    else if (s.cycle < 1 || s.cycle > r.cycles)
      refuse(out, texts::kRunCycle, {std::to_string(s.cycle), std::to_string(r.cycles)});
    else
      sets.push_back({s.cycle, h, s.value, place, s.name});
  }
  std::stable_sort(sets.begin(), sets.end(), [](const Set& a, const Set& b) { return a.cycle < b.cycle; });
  return sets;
}

void carry_out(const Set& set, Engine& engine, image::Packets& packets) {
  if (set.handle) {
    engine.write(packets, *set.handle, set.value);
    return;
  }
  const image::Place& place = *set.place;
  const Type& type = type_at(*engine.image().types, place, set.name);
  std::vector<std::uint8_t> value(std::max<std::size_t>(type.size, 8));
  parse_value(type, set.value, value.data());
  if (place.format == image::Format::bl)
    packets.set_bit(place, value[0] != 0);
  else if (place.format == image::Format::ch)
    packets.set_characters(place, {reinterpret_cast<const char*>(value.data()) + 1, value[0]});
  else
    std::copy_n(value.data(), place.bytes(), packets.data(place.packet) + place.byte());
}

std::vector<Print> resolve_prints(const RunRequest& r, const Engine& engine, const image::Packets& packets,
                                  RunResult& out) {
  std::vector<Print> prints;
  for (const std::string& name : r.prints.empty() ? variable_names(engine.image()) : r.prints) {
    if (const auto h = engine.find(name))
      prints.push_back({name, *h, {}});
    else if (const auto place = place_in(r, packets, name))
      prints.push_back({name, std::nullopt, *place});
    else
      refuse(out, texts::kRunName, {name});
  }
  return prints;
}

std::string place_text(const TypeTable& types, const image::Packets& packets, const Print& p) {
  const image::Place& place = p.place;
  if (place.format == image::Format::bl) return packets.bit(place) ? "true" : "false";
  const std::uint8_t* at = packets.data(place.packet) + place.byte();
  if (place.format == image::Format::ch) {
    std::vector<std::uint8_t> text(1 + std::min(place.bytes(), kMaxStringCapacity));
    std::copy(at, at + text.size() - 1, text.begin() + 1);
    text[0] = static_cast<std::uint8_t>(std::find(text.begin() + 1, text.end(), 0) - text.begin() - 1);
    return to_json(*types.elementary(Kind::string), text.data());
  }
  return to_json(type_at(types, place, p.name), at);
}

std::string escaped(std::string_view s) {
  std::string out;
  for (const char c : s) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

bool parse_set(std::string_view text, RunSet& out) {
  const std::size_t equal = text.find('=');
  if (equal == std::string_view::npos || equal == 0) return false;
  out.name = text.substr(0, equal);
  std::string_view value = text.substr(equal + 1);
  out.cycle = 1;
  const std::size_t at = value.rfind('@');
  if (at != std::string_view::npos && at + 1 < value.size()) {
    const auto [end, error] = std::from_chars(value.data() + at + 1, value.data() + value.size(), out.cycle);
    if (error == std::errc{} && end == value.data() + value.size())
      value = value.substr(0, at);
    else
      out.cycle = 1;
  }
  out.value = value;
  return true;
}

std::vector<std::string> parse_prints(std::string_view text) {
  std::vector<std::string> out(1);
  int depth = 0;
  for (const char c : text) {
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (c == ',' && depth == 0)
      out.emplace_back();
    else
      out.back() += c;
  }
  std::erase(out, "");
  return out;
}

RunResult run(const RunRequest& request, const std::function<bool(std::string_view)>& line) {
  RunResult out;
  Options options = request.options;
  options.cycle_ns = request.cycle_ns;
  CompileResult compiled = compile(request.files, request.symbols, options);
  out.findings = std::move(compiled.findings);
  if (compiled.image == nullptr) {
    out.end = RunResult::End::bad_source;
    return out;
  }
  Engine engine(compiled.image);
  image::Packets packets;
  packets.resize(request.options.k_bytes, request.options.v_bytes);
  const std::vector<Set> sets = resolve_sets(request, engine, packets, out);
  const std::vector<Print> prints = resolve_prints(request, engine, packets, out);
  if (out.end != RunResult::End::done) return out;
  std::size_t next = 0;
  for (std::int64_t cycle = 1; cycle <= request.cycles; ++cycle) {
    for (; next < sets.size() && sets[next].cycle == cycle; ++next) carry_out(sets[next], engine, packets);
    const ScanResult scan = engine.scan(packets, (cycle - 1) * request.cycle_ns);
    if (scan.fault != Fault::none) {
      out.findings.push_back(engine.describe(scan));
      out.end = RunResult::End::fault;
      return out;
    }
    out.cycles = cycle;
    std::string json = "{\"cycle\":" + std::to_string(cycle) + ",\"values\":{";
    for (std::size_t i = 0; i < prints.size(); ++i)
      json += (i == 0 ? "\"" : ",\"") + escaped(prints[i].name) + "\":" +
              (prints[i].handle ? engine.read(*prints[i].handle)
                                : place_text(*engine.image().types, packets, prints[i]));
    if (!line(json + "}}")) break;
  }
  return out;
}

bool check(const std::vector<SourceFile>& files, const std::vector<image::Symbol>& symbols,
           const Options& options, std::vector<text::Finding>& findings) {
  Options wanted = options;
  wanted.program_optional = true;
  CompileResult r = compile(files, symbols, wanted);
  findings = std::move(r.findings);
  return std::none_of(findings.begin(), findings.end(),
                      [](const text::Finding& f) { return f.severity == text::Severity::error; });
}

}  // namespace servogate::plc
