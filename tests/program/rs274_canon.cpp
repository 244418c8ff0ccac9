// SPDX-License-Identifier: Apache-2.0
#include "tests/program/rs274_canon.hpp"

#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

namespace servogate::program::tests {
namespace {

using nlohmann::json;
using Point = std::array<double, 3>;

constexpr double kInch = 25.4, kTolerance = 2.5e-4, kDegree = std::numbers::pi / 180.0;
constexpr const char* kLetters = "XYZ";

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.4f", value);
  std::string s = text.data();
  s.erase(s.find_last_not_of('0') + 1);
  if (s.back() == '.') s.pop_back();
  return s == "-0" ? "0" : s;
}

std::string words(const Point& p) {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) text += std::string(" ") + kLetters[i] + number(p[i]);
  return text;
}

/// Its calls of the canonical interface, one a line, as steps.
class Reading {
 public:
  std::vector<std::string> read(const std::string& printed) {
    std::istringstream in(printed);
    for (std::string line; std::getline(in, line);) {
      std::istringstream columns(line);  // its number, that of the block, the call
      std::string own, block, call;
      columns >> own >> block >> std::ws;
      std::getline(columns, call);
      const auto open = call.find('(');
      if (open == std::string::npos || !block.starts_with('N')) continue;
      take(call.substr(0, open), call.substr(open + 1, call.rfind(')') - open - 1));
      if (ended_) break;
    }
    return std::move(steps_);
  }

 private:
  static std::vector<double> numbers(std::string arguments) {
    for (char& c : arguments)
      if (c == ',') c = ' ';
    std::istringstream in(arguments);
    std::vector<double> values;
    for (double value = 0.0; in >> value;) values.push_back(value);
    return values;
  }

  void take(const std::string& name, const std::string& arguments) {
    static const std::set<std::string> kNothing = {"SET_FEED_REFERENCE",
                                                   "ON_RESET",
                                                   "SET_NAIVECAM_TOLERANCE",
                                                   "COMMENT",
                                                   "MESSAGE",
                                                   "SET_MOTION_CONTROL_MODE",
                                                   "SELECT_TOOL",
                                                   "START_CHANGE",
                                                   "CHANGE_TOOL",
                                                   "SET_SPINDLE_MODE",
                                                   "ENABLE_FEED_OVERRIDE",
                                                   "ENABLE_SPEED_OVERRIDE",
                                                   "DISABLE_FEED_OVERRIDE",
                                                   "DISABLE_SPEED_OVERRIDE",
                                                   "FLOOD_ON",
                                                   "FLOOD_OFF",
                                                   "MIST_ON",
                                                   "MIST_OFF",
                                                   "CHANGE_TOOL_NUMBER",
                                                   "UPDATE_TAG",
                                                   "PALLET_SHUTTLE"};
    if (kNothing.contains(name)) return;
    const std::vector<double> n = numbers(arguments);
    if (name == "USE_LENGTH_UNITS") {
      unit_ = arguments == "CANON_UNITS_INCHES" ? kInch : 1.0;
    } else if (name == "SET_G5X_OFFSET") {
      g5x_ = point(n, 1);
    } else if (name == "SET_G92_OFFSET") {
      g92_ = point(n, 0);
    } else if (name == "SET_XY_ROTATION") {
      rotation_ = n.at(0) * kDegree;
    } else if (name == "USE_TOOL_LENGTH_OFFSET") {
      tool_ = point(n, 0);
    } else if (name == "SELECT_PLANE") {
      const std::string plane = arguments.substr(arguments.size() - 2);
      first_ = plane == "XY" ? 0 : plane == "YZ" ? 1 : 2;
    } else if (name == "SET_FEED_MODE") {
      per_turn_ = n.at(1) != 0.0;
    } else if (name == "SET_FEED_RATE") {
      feed_ = n.at(0) * unit_;
    } else if (name == "STRAIGHT_TRAVERSE") {
      straight("rapid", n, "");
    } else if (name == "STRAIGHT_FEED") {
      straight("line", n, feed());
    } else if (name == "ARC_FEED") {
      arc(n);
    } else if (name == "DWELL") {
      if (n.at(0) > 0.0) steps_.push_back("dwell " + number(n.at(0)));
    } else if (name == "SET_SPINDLE_SPEED") {
      speed_ = n.back();
    } else if (name == "START_SPINDLE_CLOCKWISE" || name == "START_SPINDLE_COUNTERCLOCKWISE") {
      steps_.push_back(std::string("spindle ") + (name.ends_with("_COUNTERCLOCKWISE") ? "ccw " : "cw ") +
                       number(speed_));
    } else if (name == "STOP_SPINDLE_TURNING") {
      steps_.push_back("spindle stop");
    } else if (name == "PROGRAM_STOP") {
      steps_.push_back("stop");
    } else if (name == "OPTIONAL_PROGRAM_STOP") {
      steps_.push_back("optional stop");
    } else if (name == "PROGRAM_END") {
      ended_ = true;
      if (!steps_.empty() && steps_.back() == "spindle stop") steps_.pop_back();  // by the end itself
      steps_.push_back("end");
    } else {
      throw std::runtime_error("rs274 calls " + name);
    }
  }

  Point point(const std::vector<double>& n, std::size_t at) const {
    return {n.at(at) * unit_, n.at(at + 1) * unit_, n.at(at + 2) * unit_};
  }
  /// Program coordinates as those of the machine.
  Point on_machine(Point p) const {
    for (std::size_t i = 0; i < 3; ++i) p[i] += g92_[i];
    const double c = std::cos(rotation_), s = std::sin(rotation_);
    Point q = {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
    for (std::size_t i = 0; i < 3; ++i) q[i] += g5x_[i] + tool_[i];
    return q;
  }
  std::string feed() const { return " feed " + number(feed_) + (per_turn_ ? " feed_unit mm/rev" : ""); }

  void straight(const char* word, const std::vector<double>& n, const std::string& more) {
    steps_.push_back(word + words(on_machine(point(n, 0))) + more);
    at_ = point(n, 0);
  }

  void arc(const std::vector<double>& n) {
    const std::size_t i = first_, j = (i + 1) % 3, k = (i + 2) % 3;
    Point to{}, centre{};
    to[i] = n.at(0) * unit_;
    to[j] = n.at(1) * unit_;
    centre[i] = n.at(2) * unit_;
    centre[j] = n.at(3) * unit_;
    to[k] = n.at(5) * unit_;
    centre[k] = to[k];
    const int turns = static_cast<int>(n.at(4));
    const auto angle = [&](const Point& p) { return std::atan2(p[j] - centre[j], p[i] - centre[i]); };
    double sweep = (angle(to) - angle(at_)) / kDegree;
    if (turns > 0) {
      while (sweep <= 1e-3) sweep += 360.0;
      sweep += 360.0 * (turns - 1);
    } else {
      while (sweep >= -1e-3) sweep -= 360.0;
      sweep += 360.0 * (turns + 1);
    }
    const Point about = on_machine(centre);
    std::string text = "arc" + words(on_machine(to)) + " centre";
    for (const std::size_t a : {std::min(i, j), std::max(i, j)})
      text += std::string(" ") + kLetters[a] + number(about[a]);
    steps_.push_back(text + " sweep " + number(sweep) + " plane " + kLetters[i] + kLetters[j] + feed());
    at_ = to;
  }

  std::vector<std::string> steps_;
  double unit_ = 1.0, rotation_ = 0.0, feed_ = 0.0, speed_ = 0.0;
  bool per_turn_ = false, ended_ = false;
  std::size_t first_ = 0;
  Point g5x_{}, g92_{}, tool_{}, at_{};
};

std::string of_json(const json& c) {
  const std::string cmd = c.at("cmd");
  const auto place = [&](const char* key) {
    std::string text;
    for (const char* letter : {"X", "Y", "Z"})
      if (c.at(key).contains(letter))
        text += std::string(" ") + letter + number(c.at(key).at(letter).get<double>());
    return text;
  };
  const auto feed = [&] {
    const std::string unit = c.at("feed_unit");
    return " feed " + number(c.at("feed").get<double>()) + (unit == "mm/min" ? "" : " feed_unit " + unit);
  };
  if (cmd == "rapid") return cmd + place("to");
  if (cmd == "line") return cmd + place("to") + feed();
  if (cmd == "arc")
    return cmd + place("to") + " centre" + place("center") + " sweep " + number(c.at("sweep").get<double>()) +
           " plane " + c.at("plane").get<std::string>() + feed();
  if (cmd == "dwell") return cmd + " " + number(c.at("seconds").get<double>());
  if (cmd == "spindle") {
    const std::string mode = c.at("mode");
    return mode == "stop" ? "spindle stop" : "spindle " + mode + " " + number(c.at("speed").get<double>());
  }
  if (cmd == "stop") return c.at("optional").get<bool>() ? "optional stop" : "stop";
  if (cmd == "end") return cmd;
  return {};
}

/// Where a step goes to; nothing if it is none that moves.
std::optional<Point> end_of(const std::string& step) {
  std::istringstream in(step);
  std::string word;
  Point p{};
  in >> word;
  if (word != "rapid" && word != "line" && word != "arc") return std::nullopt;
  for (double& x : p) {
    in >> word;
    x = std::stod(word.substr(1));
  }
  return p;
}

/// Rapids that go on along one line are one: a way back by the R plane is the way back.
std::vector<std::string> joined(std::vector<std::string> steps) {
  std::vector<std::string> all;
  std::optional<Point> before, at;  // the last two ends
  for (std::string& step : steps) {
    const std::optional<Point> to = end_of(step);
    if (to && before && at && step.starts_with("rapid") && all.back().starts_with("rapid")) {
      double square = 0.0, along = 0.0, length = 0.0, other = 0.0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double u = (*at)[i] - (*before)[i], v = (*to)[i] - (*at)[i];
        along += u * v;
        length += u * u;
        other += v * v;
      }
      square = length * other - along * along;
      if (along > 0.0 && square < 1e-9 * length * other) all.pop_back(), at = before;
    }
    if (to) before = at, at = to;
    all.push_back(std::move(step));
  }
  return all;
}

std::string printed_by(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error(command + ": cannot be started");
  std::array<char, 4096> block{};
  while (const std::size_t n = fread(block.data(), 1, block.size(), pipe)) text.append(block.data(), n);
  if (pclose(pipe) != 0) throw std::runtime_error(command + ": failed\n" + text);
  return text;
}

}  // namespace

std::vector<std::string> rs274_steps(const std::string& printed) { return joined(Reading().read(printed)); }

std::vector<std::string> canon_steps(const std::vector<std::string>& lines) {
  std::vector<std::string> steps;
  for (const std::string& line : lines)
    if (std::string step = of_json(json::parse(line)); !step.empty()) steps.push_back(std::move(step));
  return joined(std::move(steps));
}

bool same_step(const std::string& one, const std::string& other) {
  std::istringstream a(one), b(other);
  std::string x, y;
  while (a >> x) {
    if (!(b >> y)) return false;
    if (x == y) continue;
    const auto value = [](const std::string& word) -> std::pair<std::string, std::optional<double>> {
      const auto digit = word.find_first_of("-0123456789");
      if (digit == std::string::npos || digit > 1) return {word, std::nullopt};
      char* end = nullptr;
      const double v = std::strtod(word.c_str() + digit, &end);
      return *end == '\0' ? std::pair(word.substr(0, digit), std::optional(v))
                          : std::pair(word, std::optional<double>());
    };
    const auto [letter, number] = value(x);
    const auto [other_letter, other_number] = value(y);
    if (letter != other_letter || !number || !other_number) return false;
    if (!(std::abs(*number - *other_number) <= kTolerance * std::max(1.0, 0.02 * std::abs(*number))))
      return false;
  }
  return !(b >> y);
}

std::string rs274_program() {
  if (const char* given = std::getenv("SERVOGATE_RS274")) return given;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/rs274").c_str(), X_OK) == 0) return folder + "/rs274";
  return {};
}

std::string run_rs274(const std::string& rs274, const CaseFile& c) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("rs274-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  // Without a machine its table of tools is in inches.
  std::ofstream tools(folder / "tool.tbl");
  tools.precision(12);
  for (const auto& [index, corrector] : c.tables.correctors) {
    tools << "T" << index << " P" << index << " D" << 2.0 * corrector.radius / kInch;
    for (const auto& [letter, length] : corrector.length) tools << " " << letter << length / kInch;
    tools << " ;\n";
  }
  tools.close();
  std::ofstream(folder / "program.ngc") << c.program;
  for (const auto& [name, text] : c.subprograms) std::ofstream(folder / (name + ".ngc")) << text;
  std::string printed = printed_by("cd " + folder.string() + " && " + rs274 +
                                   " -t tool.tbl -g program.ngc 2>errors; code=$?; cat errors; exit $code");
  std::filesystem::remove_all(folder);
  return printed;
}

}  // namespace servogate::program::tests
