// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {
namespace {

/// Bytes of the well-formed UTF-8 character at `pos`, 0: none stands there (programs may be written in older
/// codes).
std::size_t character_length(std::string_view text, std::size_t pos) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char c = byte(pos);
  const std::size_t length = c < 0x80                ? 1
                             : c >= 0xC2 && c < 0xE0 ? 2
                             : c >= 0xE0 && c < 0xF0 ? 3
                             : c >= 0xF0 && c < 0xF5 ? 4
                                                     : 0;
  if (length == 0 || pos + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(pos + i) & 0xC0) != 0x80) return 0;
  if ((c == 0xE0 && byte(pos + 1) < 0xA0) || (c == 0xED && byte(pos + 1) > 0x9F)) return 0;
  if ((c == 0xF0 && byte(pos + 1) < 0x90) || (c == 0xF4 && byte(pos + 1) > 0x8F)) return 0;
  return length;
}

/// Appends one JSON object piece by piece.
class Writer {
 public:
  Writer(std::string& out, const std::vector<std::string>& letters) : out_(out), letters_(letters) {}

  void key(std::string_view name) {
    out_ += ",\"";
    out_ += name;
    out_ += "\":";
  }
  void number(double value) {
    char buffer[32];
    if (!std::isfinite(value)) value = 0.0;
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value == 0.0 ? 0.0 : value);
    out_.append(buffer, error == std::errc{} ? end : buffer);
  }
  void whole(long long value) {
    char buffer[24];
    out_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  }
  void text(std::string_view value) {
    static constexpr char kHex[] = "0123456789abcdef";
    out_ += '"';
    for (std::size_t i = 0; i < value.size();) {
      const char c = value[i];
      const auto u = static_cast<unsigned char>(c);
      const std::size_t length = character_length(value, i);
      if (c == '"' || c == '\\') {
        out_ += '\\';
        out_ += c;
      } else if (u < 0x20) {
        out_ += "\\u00";
        out_ += kHex[u >> 4];
        out_ += kHex[u & 15];
      } else if (length == 0) {
        out_ += "\\ufffd";
      } else {
        out_ += value.substr(i, length);
      }
      i += std::max<std::size_t>(length, 1);
    }
    out_ += '"';
  }
  void field(std::string_view name, double value) { key(name), number(value); }
  void field(std::string_view name, std::string_view value) { key(name), text(value); }
  void flag(std::string_view name, bool value) { key(name), out_ += value ? "true" : "false"; }
  void count(std::string_view name, long long value) { key(name), whole(value); }

  void position(std::string_view name, const Position& position) {
    key(name);
    char separator = '{';
    for (std::size_t a = 0; a < letters_.size(); ++a) {
      axis(separator, a, position[a]);
      separator = ',';
    }
    out_ += letters_.empty() ? "{}" : "}";
  }
  void axis(char separator, std::size_t index, double value) {
    out_ += separator;
    text(letters_[index]);
    out_ += ':';
    number(value);
  }
  void windows(const InPosition& c) {
    key("window");
    char separator = '{';
    for (std::size_t a = 0; a < letters_.size(); ++a) {
      if ((c.axes >> a & 1u) == 0) continue;
      axis(separator, a, c.window[a]);
      separator = ',';
    }
    out_ += separator == '{' ? "{}" : "}";
  }
  void raw(std::string_view text) { out_ += text; }
  const std::string& letter(std::size_t axis) const { return letters_[axis]; }

 private:
  std::string& out_;
  const std::vector<std::string>& letters_;
};

std::string_view feed_unit(FeedUnit unit) {
  constexpr std::string_view kUnits[] = {"mm/min", "mm/rev", "1/min"};
  return kUnits[static_cast<int>(unit)];
}

void motion_fields(Writer& w, const Feed& feed, const CornerRule& corner) {
  constexpr std::string_view kTransitions[] = {"exact_stop", "continuous", "corner_limited"};
  w.field("feed", feed.value);
  w.field("feed_unit", feed_unit(feed.unit));
  w.field("transition", kTransitions[static_cast<int>(corner.transition)]);
  if (corner.transition == Transition::corner_limited) {
    w.field("corner_error", corner.corner_error_mm);
    w.field("max_angle", corner.max_angle_deg);
  }
}

/// One overload a command: its name and what follows the line.
struct Fields {
  Writer& w;

  void operator()(const Rapid& c) const { w.position("to", c.to); }
  void operator()(const Line& c) const {
    w.position("to", c.to);
    motion_fields(w, c.feed, c.corner);
  }
  void operator()(const Arc& c) const {
    w.position("to", c.to);
    w.key("center");
    w.axis('{', c.axis1, c.center1);
    w.axis(',', c.axis2, c.center2);
    w.raw("}");
    w.field("plane", w.letter(c.axis1) + w.letter(c.axis2));
    w.field("sweep", c.sweep_deg);
    motion_fields(w, c.feed, c.corner);
  }
  void operator()(const Thread& c) const {
    w.position("to", c.to);
    w.field("lead", c.lead);
    w.field("lead_change", c.lead_change);
    w.field("start_angle", c.start_angle_deg);
    if (c.tap) w.flag("tap", true);
  }
  void operator()(const Dwell& c) const { w.field("seconds", c.seconds); }
  void operator()(const Spindle& c) const {
    constexpr std::string_view kModes[] = {"keep", "cw", "ccw", "stop", "orient", "turn"};
    if (c.number != 0) w.count("number", c.number);
    w.field("mode", kModes[static_cast<int>(c.mode)]);
    w.field("speed", c.speed);
    w.field("unit", c.surface_speed ? "m/min" : "rpm");
    if (c.limit_rpm > 0.0) w.field("limit", c.limit_rpm);
    if (c.center != 0.0) w.field("center", c.center);
    if (c.mode == SpindleMode::turn) w.field("angle", c.turn_deg);
  }
  void operator()(const Tool& c) const {
    w.count("number", c.number);
    w.count("corrector", c.corrector);
  }
  void operator()(const MFunction& c) const { w.count("code", c.code); }
  void operator()(const HFunction& c) const { w.count("code", c.code); }
  void operator()(const Message& c) const { w.field("text", c.text); }
  void operator()(const WritePlace& c) const {
    w.field("place", image::to_string(c.place));
    if (c.place.format == image::Format::ch)
      w.field("text", c.characters);
    else
      w.field("value", c.value);
    w.flag("synchronous", c.synchronous);
  }
  void operator()(const Wait& c) const {
    constexpr std::string_view kCompare[] = {"=", "#", "<", "<=", ">", ">="};
    w.field("place", image::to_string(c.place));
    w.field("compare", kCompare[static_cast<int>(c.compare)]);
    w.field("value", c.value);
  }
  void operator()(const Stop& c) const { w.flag("optional", c.optional); }
  void operator()(const Probe& c) const {
    w.position("to", c.to);
    w.field("feed", c.feed_mm_min);
    w.field("feed_unit", "mm/min");
  }
  void operator()(const End& c) const { w.flag("rewind", c.rewind); }
  void operator()(const SpindleMark&) const {}
  void operator()(const ProcessOrder& c) const {
    constexpr std::string_view kActions[] = {"start", "release", "restart", "wait"};
    w.field("action", kActions[static_cast<int>(c.action)]);
    if (c.process != 0) w.count("of", c.process);
    if (!c.program.empty()) w.field("program", c.program);
    w.flag("after_motion", c.after_motion);
  }
  void operator()(const InPosition& c) const { w.windows(c); }
  void operator()(const FeedOverride& c) const { w.flag("effective", c.effective); }
  void operator()(const SpindleCoupling& c) const {
    w.flag("on", c.on);
    if (!c.on) return;
    w.count("leader", c.leader);
    w.count("follower", c.follower);
    w.field("phase", c.phase_deg);
  }
  void operator()(const SpindleAxis& c) const { w.flag("on", c.on); }
};

/// In the order of Command::what.
constexpr std::string_view kNames[] = {"rapid",       "line",        "arc",           "thread",
                                       "dwell",       "spindle",     "tool",          "m",
                                       "h",           "message",     "write",         "wait",
                                       "stop",        "probe",       "end",           "spindle_mark",
                                       "process",     "in_position", "feed_override", "spindle_coupling",
                                       "spindle_axis"};
static_assert(std::size(kNames) == std::variant_size_v<decltype(Command::what)>);

}  // namespace

void append_json(std::string& out, const Command& command, const std::vector<std::string>& letters,
                 const std::vector<std::string>& files) {
  Writer w(out, letters);
  w.raw("{\"cmd\":\"");
  w.raw(kNames[command.what.index()]);
  w.raw("\"");
  w.count("line", command.line);
  const auto file = static_cast<std::size_t>(command.file);
  if (command.file != 0 && file < files.size()) w.field("file", files[file]);
  if (command.process != 0) w.count("process", command.process);
  std::visit(Fields{w}, command.what);
  w.raw("}");
}

std::string to_json(const Command& command, const std::vector<std::string>& letters,
                    const std::vector<std::string>& files) {
  std::string out;
  append_json(out, command, letters, files);
  return out;
}

}  // namespace servogate::program
