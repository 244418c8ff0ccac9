// SPDX-License-Identifier: Apache-2.0
#include "tests/program/case_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "kernel/program/languages/languages.hpp"
#include "tests/places/places.hpp"

namespace servogate::program::tests {
namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// "X10 Y-2.5" as letter and number.
std::map<std::string, double> axis_values(const std::string& text) {
  std::map<std::string, double> values;
  for (const auto& word : words_of(text)) values[word.substr(0, 1)] = std::stod(word.substr(1));
  return values;
}

class Reader {
 public:
  explicit Reader(const std::string& path) {
    case_.path = path;
    case_.name = std::filesystem::path(path).stem().string();
    const std::filesystem::path below =
        std::filesystem::relative(path, servogate::tests::source_dir() + "/tests/program");
    case_.dialect = below.begin()->string();
    for (const std::string& name : dialects())
      if (name.starts_with(case_.dialect)) case_.dialect = name;
    case_.machine = mill();
    if (case_.dialect == "nc110") return;
    case_.machine.power_on.clear();  // those of the language
    case_.machine.variables.clear();
  }

  CaseFile read() {
    std::ifstream in(case_.path);
    if (!in) throw std::runtime_error(case_.path + ": cannot be opened");
    for (std::string line; std::getline(in, line);) {
      ++number_;
      if (line.size() > 2 && line.front() == '[' && line.back() == ']')
        section_ = line.substr(1, line.size() - 2);
      else
        take(line);
    }
    return std::move(case_);
  }

 private:
  [[noreturn]] void bad(const std::string& what) const {
    throw std::runtime_error(case_.path + ":" + std::to_string(number_) + ": " + what);
  }

  void take(const std::string& line) {
    if (section_ == "program") {
      case_.program += line + "\n";
      return;
    }
    if (section_.starts_with("subprogram ")) {
      case_.subprograms[section_.substr(11)] += line + "\n";
      return;
    }
    const std::string text = trimmed(line);
    if (text.empty() || text.front() == '#') return;
    if (section_ == "machine") return setting(text);
    if (section_ == "rows") {
      for (const auto& row : words_of(text)) case_.rows.push_back(row);
      return;
    }
    const std::map<std::string, std::vector<CaseFile::Line>*> lists = {
        {"expect", &case_.expected},  {"contains", &case_.contained}, {"motions", &case_.motions},
        {"error", &case_.errors},     {"rs274", &case_.rs274},        {"differs", &case_.differs},
        {"findings", &case_.findings}};
    const auto list = lists.find(section_);
    if (list == lists.end()) bad("no section [" + section_ + "]");
    list->second->push_back({number_, text});
  }

  void setting(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) bad("NAME = VALUE expected");
    const auto name = words_of(text.substr(0, equals));
    const std::string value = trimmed(text.substr(equals + 1));
    if (name.empty()) bad("NAME = VALUE expected");
    if (name[0] == "axes") {
      case_.machine.axes.clear();
      for (const auto& letter : words_of(value)) case_.machine.axes.push_back(axis(letter));
    } else if (name[0] == "travel" || name[0] == "reference" || name[0] == "rapid" ||
               name[0] == "acceleration" || name[0] == "window_max" || name[0] == "window_coarse") {
      limits(name, words_of(value));
    } else if (name[0] == "arc_feed") {
      const std::map<std::string, ArcFeed> names = {
          {"tool-centre", ArcFeed::tool_centre}, {"contour", ArcFeed::contour}, {"inside", ArcFeed::inside}};
      case_.machine.arc_feed = names.at(value);
    } else if (name[0] == "machine") {
      case_.machine.kind = value == "turning" ? MachineModel::Kind::turning : MachineModel::Kind::milling;
    } else if (name[0] == "quadrant" && name.size() == 2) {
      case_.tables.correctors[std::stoi(name[1])].quadrant = std::stoi(value);
    } else if (name[0] == "power_on") {
      case_.machine.power_on = words_of(value);
    } else if (name[0] == "start") {
      for (const auto& [letter, number] : axis_values(value))
        for (std::size_t a = 0; a < case_.machine.axes.size(); ++a)
          if (case_.machine.axes[a].letter == letter) case_.start[a] = number;
    } else if (name[0] == "coupled") {
      case_.machine.coupled_max_rpm = std::stod(value);
    } else if (name[0] == "spindle_angle") {
      case_.machine.spindle_angle = value == "measured";
    } else if (name[0] == "spindle_axis") {
      const auto words = words_of(value);
      for (std::size_t a = 0; a < case_.machine.axes.size(); ++a)
        if (case_.machine.axes[a].letter == words.at(0)) case_.machine.spindle_axis = static_cast<int>(a);
      case_.machine.spindle_axis_on_m = std::stoi(words.at(1));
      case_.machine.spindle_axis_off_m = std::stoi(words.at(2));
    } else if (name[0] == "spindles") {
      case_.machine.spindles = std::stoi(value);
    } else if (name[0] == "spindle") {
      const auto range = words_of(value);
      case_.machine.spindle_min_rpm = std::stod(range.at(0));
      case_.machine.spindle_max_rpm = std::stod(range.at(1));
    } else if (name[0] == "tool_places") {
      case_.machine.tool_places = std::stoi(value);
    } else if (name[0] == "k_bytes") {
      case_.machine.k_bytes = static_cast<std::uint32_t>(std::stoul(value));
    } else if (name[0] == "syvar_bytes") {
      case_.machine.syvar_bytes = static_cast<std::uint32_t>(std::stoul(value));
    } else if (name[0] == "contour_tolerance") {
      case_.machine.contour_tolerance_mm = std::stod(value);
    } else if (name[0] == "origin" && name.size() == 2) {
      case_.tables.origins[std::stoi(name[1])] = axis_values(value);
    } else if (name[0] == "corrector" && name.size() == 2) {
      auto& corrector = case_.tables.correctors[std::stoi(name[1])];
      corrector.length = axis_values(value);
      if (const auto diameter = corrector.length.extract("K")) corrector.radius = diameter.mapped() / 2.0;
    } else if (name[0] == "wear_limit" && name.size() == 2) {
      auto& corrector = case_.tables.correctors[std::stoi(name[1])];
      corrector.wear_limit = axis_values(value);
      if (const auto diameter = corrector.wear_limit.extract("K"))
        corrector.radius_wear_limit = diameter.mapped() / 2.0;
    } else if (name[0] == "own" && name.size() == 2) {
      own_code(name[1], words_of(value));
    } else if (name[0] == "alternate" && name.size() == 2) {
      case_.tables.correctors[std::stoi(name[1])].alternate = std::stoi(value);
    } else if (name[0] == "protected" && name.size() == 2) {
      case_.machine.protected_places.push_back({*image::parse_place(name[1]), value});
    } else if (name.size() == 1) {
      case_.machine.variables[name[0]] = std::stod(value);
    } else {
      bad("no setting " + name[0]);
    }
  }

  /// "X", "X:diameter", "C:rotary" or "C:endless" (rotary).
  static MachineModel::Axis axis(const std::string& text) {
    MachineModel::Axis axis;
    axis.letter = text.substr(0, 1);
    axis.endless = text.ends_with(":endless");
    axis.rotary = text.ends_with(":rotary") || axis.endless;
    axis.diameter = text.ends_with(":diameter");
    axis.travel_min = axis.rotary ? -1e6 : -300.0;
    axis.travel_max = -axis.travel_min;
    axis.rapid = 500.0;
    return axis;
  }

  /// own G50 = POCKET X100 Y101
  void own_code(const std::string& code, const std::vector<std::string>& words) {
    MachineModel::OwnCode row{code, words.at(0), {}};
    for (std::size_t i = 1; i < words.size(); ++i)
      row.words[words[i].substr(0, 1)] = std::stod(words[i].substr(1));
    case_.machine.own_codes.push_back(row);
  }

  void limits(const std::vector<std::string>& name, const std::vector<std::string>& values) {
    for (auto& axis : case_.machine.axes) {
      if (name.size() != 2 || axis.letter != name[1]) continue;
      if (name[0] == "rapid") axis.rapid = std::stod(values.at(0));
      if (name[0] == "window_max") axis.window_max = std::stod(values.at(0));
      if (name[0] == "window_coarse") axis.window_coarse = std::stod(values.at(0));
      if (name[0] == "acceleration") {
        axis.acceleration = std::stod(values.at(0));
        axis.jerk = std::stod(values.at(1));
      }
      if (name[0] == "reference") axis.reference = std::stod(values.at(0));
      if (name[0] == "travel") {
        axis.travel_min = std::stod(values.at(0));
        axis.travel_max = std::stod(values.at(1));
      }
      return;
    }
    bad("no such axis");
  }

  CaseFile case_;
  std::string section_;
  int number_ = 0;
};

}  // namespace

MachineModel mill() {
  MachineModel machine;
  for (const char* letter : {"X", "Y", "Z"}) {
    MachineModel::Axis axis;
    axis.letter = letter;
    axis.travel_min = -300.0;
    axis.travel_max = 300.0;
    axis.rapid = 500.0;
    machine.axes.push_back(axis);
  }
  machine.contour_tolerance_mm = 0.01;
  machine.power_on = {"G94", "G97", "G90", "G71", "G27"};
  machine.variables = {{"ERF", 0.01}, {"MCD", 2.0}};
  return machine;
}

ProgramLoader CaseFile::loader() const {
  return [this](std::string_view called) -> std::optional<LoadedProgram> {
    const auto at = subprograms.find(std::string(called));
    if (at == subprograms.end()) return std::nullopt;
    return LoadedProgram(at->second);
  };
}

CaseFile read_case(const std::string& path) { return Reader(path).read(); }

std::vector<std::string> case_paths(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".test") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace servogate::program::tests
