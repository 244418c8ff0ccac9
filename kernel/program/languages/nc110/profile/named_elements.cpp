// SPDX-License-Identifier: Apache-2.0
// Elements in use: by their numbers, as values, and as people see them.
#include <map>
#include <string>

#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"

namespace servogate::program::nc110 {
namespace {

template <typename T>
const T& found(const std::map<int, T>& all, char kind, int number, int column) {
  const auto at = all.find(number);
  if (at == all.end()) fail(Wrong::element_missing, column, {kind + std::to_string(number)});
  return at->second;
}

}  // namespace

bool names_element(std::string_view text) {
  return text.size() > 1 && (text[0] == 'o' || text[0] == 'p' || text[0] == 'l' || text[0] == 'c') &&
         is_digit(text[1]);
}

const Point& point_of(const Execution& run, int number, int column) {
  return found(run.state().elements.points, 'p', number, column);
}
const Directed& line_of(const Execution& run, int number, int column) {
  return found(run.state().elements.lines, 'l', number, column);
}
const Directed& circle_of(const Execution& run, int number, int column) {
  return found(run.state().elements.circles, 'c', number, column);
}

const PlaneFrame& origin_of(const Execution& run, int number, int column) {
  return found(run.state().elements.origins, 'o', number, column);
}

double element_value(const Execution& run, char function, int number, int item, int column) {
  const auto refuse = [&](int most) -> double {
    fail(Wrong::element_item, column,
         {std::string("FE") + function, std::to_string(item), std::to_string(most)});
  };
  if (function == 'P') {
    const Point& p = point_of(run, number, column);
    return item == 1 ? p.x : item == 2 ? p.y : refuse(2);
  }
  if (function == 'L') {
    const Directed& l = line_of(run, number, column);
    return item == 1 ? l.along.y : item == 2 ? l.along.x : item == 3 ? l.height : refuse(3);
  }
  const Directed& c = circle_of(run, number, column);
  return item == 1 ? c.centre.x : item == 2 ? c.centre.y : item == 3 ? c.radius : refuse(3);
}

std::string shown_element(const Execution& run, std::string_view name, int column) {
  std::size_t pos = 1;
  const int number = read_index(name, pos);
  if (number < 0 || pos != name.size()) fail(Wrong::element_number, column, {std::to_string(kMostNumber)});
  const auto part = [](const char* letter, double value) { return letter + text::number(value, 4); };
  std::string out(name);
  if (name[0] == 'p') {
    const Point& p = point_of(run, number, column);
    return out + "=" + part("X", p.x) + " " + part("Y", p.y);
  }
  if (name[0] == 'l') {
    const Directed& l = line_of(run, number, column);
    return out + "=" + part("d", l.height) + " " + part("a", angle_of(l));
  }
  if (name[0] == 'o') {
    const PlaneFrame& f = origin_of(run, number, column);
    return out + "=" + part("X", f.origin.x) + " " + part("Y", f.origin.y) + " " + part("a", f.angle_deg);
  }
  const Directed& c = circle_of(run, number, column);
  return out + "=" + part("I", c.centre.x) + " " + part("J", c.centre.y) + " " + part("r", c.radius);
}

}  // namespace servogate::program::nc110
