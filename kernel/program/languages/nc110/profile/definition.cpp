// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/profile/definition.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/expressions.hpp"

namespace servogate::program::nc110 {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

/// What stands between two commas of a definition.
struct Part {
  int column = 1;
  bool reversed = false;
  char element = 0;  ///< p, l or c, 0: none
  int number = 0;
  std::optional<double> across, up, i, j, a, m, r, d;  ///< across and up: along the axes of the plane
  std::optional<int> origin;
  bool second = false;  ///< s2

  bool cartesian() const { return across && up && !i && !j && !m; }
  bool polar() const { return m && a && !r && !across && !up && !i && !j; }
  bool is_point() const { return element == 'p' || (element == 0 && (cartesian() || polar()) && !r && !d); }
  bool is_circle() const {
    return element == 'c' || (element == 0 && r && ((i && j && !m) || (m && a && !i && !j)));
  }
  bool only(const std::optional<double> Part::*value) const {
    int given = element != 0 || second || origin ? 2 : 0;
    for (const auto one :
         {&Part::across, &Part::up, &Part::i, &Part::j, &Part::a, &Part::m, &Part::r, &Part::d})
      given += (this->*one).has_value() ? 1 : 0;
    return given == 1 && (this->*value).has_value();
  }
};

constexpr std::size_t kMostParts = 3;
struct Parts {
  std::array<Part, kMostParts + 1> items;
  std::size_t count = 0;
};

class Reader {
 public:
  Reader(Execution* run, const Dialect& dialect, const AxisLetters& axes, Block& block, std::size_t& pos)
      : run_(run),
        dialect_(dialect),
        axes_(axes),
        block_(block),
        line_(block.line.substr(0, block.end)),
        pos_(pos) {}

  int number() {
    std::size_t at = pos_;
    const Value value = this->value("");
    if (value.bare || value.fraction || value.negative)
      fail(Wrong::element_number, column(at), {std::to_string(kMostNumber)});
    const double number = run_ != nullptr        ? run_->numbers().resolve(value)
                          : value.parameter >= 0 ? 0.0
                                                 : value.number;
    if (!(number >= 0.0 && number <= kMostNumber) || number != std::floor(number))
      fail(Wrong::element_number, column(at), {std::to_string(kMostNumber)});
    return static_cast<int>(number);
  }

  void equals() {
    pos_ = skip_spaces(line_, pos_);
    if (pos_ >= line_.size() || line_[pos_] != '=')
      fail(Fault::equals_expected, column(pos_),
           {std::string(line_.substr(block_.body, pos_ - block_.body))});
    ++pos_;
  }

  Parts parts() {
    Parts parts;
    do {
      if (parts.count == kMostParts + 1) wrong(pos_);
      parts.items[parts.count] = part();
      if (parts.items[parts.count].second && parts.count == 0) wrong(pos_);
      ++parts.count;
      pos_ = skip_spaces(line_, pos_);
    } while (pos_ < line_.size() && line_[pos_++] == ',');
    return parts;
  }

  [[noreturn]] void wrong(std::size_t at) const {
    fail(Wrong::element_form, column(at), {std::string(line_.substr(block_.body))});
  }

 private:
  Value value(std::string_view word) {
    BlockText text{dialect_, axes_, block_, line_, pos_};
    const Value value = read_value(text, word);
    pos_ = text.pos;
    return value;
  }

  double length(int axis, const Value& value, bool halve) const {
    if (run_ == nullptr) return value.parameter >= 0 ? 1.0 : value.number;
    return run_->numbers().length(axis, value, halve);
  }
  double plain(const Value& value) const {
    return run_ != nullptr ? run_->numbers().resolve(value) : value.parameter >= 0 ? 1.0 : value.number;
  }

  Part part() {
    Part part;
    pos_ = skip_spaces(line_, pos_);
    part.column = column(pos_);
    const std::size_t start = pos_;
    while (pos_ < line_.size() && line_[pos_] != ',') {
      word(part);
      pos_ = skip_spaces(line_, pos_);
    }
    if (pos_ == start) wrong(start);
    return part;
  }

  void word(Part& part) {
    const std::size_t at = pos_;
    char c = line_[pos_];
    if (c == '-') {
      part.reversed = true;
      pos_ = skip_spaces(line_, pos_ + 1);
      c = pos_ < line_.size() ? line_[pos_] : '\0';
      if (c != 'l' && c != 'c') wrong(at);
    }
    ++pos_;
    if (c == 's') {
      if (pos_ >= line_.size() || line_[pos_] != '2' || part.second) wrong(at);
      ++pos_;
      part.second = true;
    } else if (c == 'o') {
      if (part.origin) wrong(at);
      part.origin = number();
    } else if (c == 'p' || c == 'l' || c == 'c') {
      if (part.element != 0) wrong(at);
      part.element = c;
      part.number = number();
    } else {
      given(part, c, at);
    }
  }

  void given(Part& part, char c, std::size_t at) {
    const auto take = [&](std::optional<double>& into, double number) {
      if (into) wrong(at);
      into = number;
    };
    const std::string_view name = line_.substr(at, 1);
    const bool halves = run_ != nullptr && dialect_.centre_as_diameter;
    if (c == 'a') return take(part.a, plain(value(name)));
    const int axis1 = run_ != nullptr ? run_->state().frames.axis1 : 0,
              axis2 = run_ != nullptr ? run_->state().frames.axis2 : 1;
    if (c == 'm' || c == 'r' || c == 'd')
      return take(c == 'm' ? part.m : c == 'r' ? part.r : part.d, length(axis1, value(name), false));
    if (c == 'I') return take(part.i, length(axis1, value(name), halves));
    if (c == 'J') return take(part.j, length(axis2, value(name), halves));
    const int axis = is_capital(c) ? axes_.find(c) : -1;
    if (axis < 0) wrong(at);
    if (run_ == nullptr) {
      value(name);
      (part.across ? part.up : part.across) = 1.0;
      return;
    }
    if (axis != axis1 && axis != axis2) fail(Wrong::element_axis, column(at), {std::string(name)});
    take(axis == axis1 ? part.across : part.up, length(axis, value(name), true));
  }

  Execution* run_;
  const Dialect& dialect_;
  const AxisLetters& axes_;
  Block& block_;
  std::string_view line_;
  std::size_t& pos_;
};

Point in_frame(const PlaneFrame& frame, Point p) {
  const double c = cos_deg(frame.angle_deg), s = sin_deg(frame.angle_deg);
  return {frame.origin.x + p.x * c - p.y * s, frame.origin.y + p.x * s + p.y * c};
}

/// Turns what a definition says into an element.
class Maker {
 public:
  Maker(Execution& run, const Parts& parts) : run_(run), parts_(parts) {}

  void make(char kind, int number) {
    GeometricElements& all = run_.state().elements;
    if (kind == 'o') {
      all.origins[number] = origin();
    } else if (kind == 'p') {
      all.points[number] = point();
    } else {
      const Directed element = kind == 'l' ? line() : circle();
      (kind == 'l' ? all.lines : all.circles)[number] = element;
    }
  }
  bool understood() const { return understood_; }

 private:
  const Part& part(std::size_t i) const { return parts_.items[i]; }
  bool second() const { return parts_.count > 1 && last().second && only_second(last()); }
  const Part& last() const { return parts_.items[parts_.count - 1]; }
  static bool only_second(const Part& p) {
    return p.element == 0 && !p.across && !p.up && !p.i && !p.r && !p.a && !p.m && !p.d;
  }
  std::size_t operands() const { return parts_.count - (second() ? 1 : 0); }
  [[noreturn]] void none(int column) const { fail(Wrong::element_none, column); }
  template <typename T>
  T some(const std::optional<T>& value) const {
    if (!value) none(part(0).column);
    return *value;
  }
  double turned(const Part& p, double angle) const {
    return p.origin ? angle + origin_of(run_, *p.origin, p.column).angle_deg : angle;
  }

  Point place(const Part& p, Point local) const {
    return p.origin ? in_frame(origin_of(run_, *p.origin, p.column), local) : local;
  }
  Point point_at(const Part& p) const {
    if (p.element == 'p') return point_of(run_, p.number, p.column);
    if (p.m) return place(p, {*p.m * cos_deg(*p.a), *p.m * sin_deg(*p.a)});
    return place(p, {*p.across, *p.up});
  }
  Directed circle_at(const Part& p) const {
    if (p.element == 'c') {
      const Directed& c = circle_of(run_, p.number, p.column);
      return p.reversed ? reversed(c) : c;
    }
    const Point centre =
        p.m ? place(p, {*p.m * cos_deg(*p.a), *p.m * sin_deg(*p.a)}) : place(p, {*p.i, *p.j});
    if (*p.r == 0.0) none(p.column);
    return circle_about(centre, *p.r);
  }
  Directed line_at_part(const Part& p) const {
    const Directed& l = line_of(run_, p.number, p.column);
    return p.reversed ? reversed(l) : l;
  }
  /// Line, circle, or a point as a circle of radius 0.
  Directed any(const Part& p) const {
    if (p.element == 'l') return line_at_part(p);
    return p.is_point() ? point_circle(point_at(p)) : circle_at(p);
  }
  static bool refers(const Part& p) { return p.element != 0; }

  PlaneFrame origin() {
    const Part& p = part(0);
    if (parts_.count != 1 || !p.across || !p.up || p.i || p.m || p.r || refers(p)) return wrong(PlaneFrame{});
    return {place(p, {*p.across, *p.up}), turned(p, p.a.value_or(0.0))};
  }

  Point point() {
    if (parts_.count == 1 && part(0).is_point() && part(0).element == 0) return point_at(part(0));
    if (operands() != 2 || !refers(part(0)) || !refers(part(1)) || part(0).element == 'p' ||
        part(1).element == 'p')
      return wrong(Point{});
    const AtMostTwo<Point> common = common_points(any(part(0)), any(part(1)), kRadiusTolerance);
    if (common.count == 0) none(part(0).column);
    return common[second() && common.count == 2 ? 1 : 0];
  }

  Directed line() {
    const Part &one = part(0), &two = part(1);
    if (parts_.count != 2) return wrong(Directed{});
    if (one.element == 'l' && two.only(&Part::d)) return shifted(line_at_part(one), *two.d);
    const bool starts = one.is_point() || one.is_circle();
    if (starts && two.only(&Part::a)) {
      const Directed line =
          program::line_at(one.is_point() ? point_at(one) : circle_at(one).centre, turned(one, *two.a));
      return one.is_point() ? line : shifted(line, -circle_at(one).radius);
    }
    if (!starts || !(two.is_point() || two.is_circle())) return wrong(Directed{});
    return some(common_tangent(any(one), any(two)));
  }

  Directed circle() {
    const Part &one = part(0), &two = part(1);
    if (parts_.count == 1 && one.element == 0 && one.is_circle()) return circle_at(one);
    if (parts_.count == 2 && one.element == 'p' && two.only(&Part::r)) {
      if (*two.r == 0.0) none(two.column);
      return circle_about(point_at(one), *two.r);
    }
    if (parts_.count == 2 && one.element == 'c' && two.only(&Part::d)) {
      const Directed c = shifted(circle_at(one), *two.d);
      if (c.radius * circle_at(one).radius <= 0.0) none(two.column);
      return c;
    }
    if (one.element == 'p' && operands() == 2 && two.element == 'l' && !second())
      return circle_about(point_at(one), distance_left(line_at_part(two), point_at(one)));
    if (one.element == 'p' && operands() == 2 && two.element == 'c')
      return about(point_at(one), circle_at(two));
    if (parts_.count == 3 && one.element == 'p' && two.element == 'p' && part(2).element == 'p')
      return some(circle_through(point_at(one), point_at(two), point_at(part(2))));
    if (parts_.count != 3 || !refers(one) || !refers(two) || !part(2).only(&Part::r))
      return wrong(Directed{});
    const AtMostTwo<Joining> joining = joining_circles(any(one), any(two), *part(2).r);
    if (joining.count == 0 || *part(2).r == 0.0) none(one.column);
    return joining[0].circle;
  }

  /// The smaller of the two circles about a centre that touch another one, with s2 the larger.
  Directed about(Point centre, const Directed& other) const {
    const double far = std::hypot(centre.x - other.centre.x, centre.y - other.centre.y);
    const double near = other.radius > 0.0 ? other.radius - far : other.radius + far;
    const double large = other.radius > 0.0 ? other.radius + far : other.radius - far;
    const double r = second() ? large : near;
    if (std::abs(r) < 1e-9) none(part(0).column);
    return circle_about(centre, r);
  }

  template <typename T>
  T wrong(T nothing) {
    understood_ = false;
    return nothing;
  }

  Execution& run_;
  const Parts& parts_;
  bool understood_ = true;
};

}  // namespace

bool defines_element(std::string_view line, std::size_t pos) {
  const char c = pos < line.size() ? line[pos] : '\0';
  if (c != 'o' && c != 'p' && c != 'l' && c != 'c') return false;
  return pos + 1 < line.size() && (is_digit(line[pos + 1]) || line[pos + 1] == 'E');
}

void define_element(Execution* run, const Dialect& dialect, const AxisLetters& axes, Block& block,
                    std::size_t& pos) {
  const std::size_t start = pos;
  const char kind = block.line[pos++];
  Reader reader(run, dialect, axes, block, pos);
  const int number = reader.number();
  reader.equals();
  const Parts parts = reader.parts();
  if (run == nullptr) return;
  run->frames().need_plane(column(start));
  if (run->state().modes.dimension == Function::incremental) fail(Wrong::element_incremental, column(start));
  Maker maker(*run, parts);
  maker.make(kind, number);
  if (!maker.understood()) reader.wrong(start);
}

}  // namespace servogate::program::nc110
