// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/profile/profile_words.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"

namespace servogate::program::nc110 {
namespace {

using Item = ProfileState::Item;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
double distance(Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y); }
double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }

[[noreturn]] void fail_at(Wrong wrong, const Place& place, std::vector<std::string> arguments = {}) {
  throw ProgramError{&entry(wrong), place.column, std::move(arguments), place.line};
}

/// Works on the profile of a run.
class Profile {
 public:
  explicit Profile(Execution& run) : run_(run), state_(run.state().profile), frames_(run.state().frames) {}

  void take(Item item, bool opens, bool closes) {
    if (opens) return open(std::move(item));
    if (closes) return close(std::move(item));
    if (item.point) fail_at(Wrong::profile_point, item.place);
    if (!state_.begun) {
      begin(item);
    } else if (!state_.held) {
      need_on(item, state_.from);
    } else {
      join(item);
    }
    if (!state_.opening) state_.opening = item;
    state_.held = std::move(item);
  }

  void corner(CornerWord word) {
    if (!state_.held || state_.corner.kind != CornerWord::Kind::none) fail_at_corner(word);
    state_.corner = std::move(word);
  }

  void across(Item item) {
    if (!state_.begun || state_.held) {
      state_.behind.emplace_back(std::move(item));
    } else {
      move_across(item);
    }
  }

 private:
  [[noreturn]] static void fail_at_corner(const CornerWord& word) {
    throw ProgramError{&program::entry(Fault::corner_place), word.place.column, {}, word.place.line};
  }

  void open(Item item) {
    state_ = ProfileState{};
    state_.open = true;
    state_.closed_form = !item.point;
    state_.first = item;
    if (!item.point) return;
    approach(item, item.element.centre);
  }

  /// The way to the first point of the profile, always at the feed.
  void approach(const Item& item, Point to) {
    ContourElement line = element_of(item);
    const Position& stands = frames_.machine;
    line.start = {stands[at(frames_.axis1)], stands[at(frames_.axis2)]};
    line.end = machine(to);
    run_.contour().take(line);
    arrive(to, line.to);
    state_.begun = true;
    state_.from = to;
  }

  void begin(const Item& item) {
    const Item& last = *state_.first;
    const Point start = joint(last, item);
    run_.contour().begin_behind(tail(last, start));
    approach(last, start);
    for (auto& between : std::exchange(state_.behind, {}))
      if (const auto* other = std::get_if<Item>(&between)) move_across(*other);
  }

  void close(Item item) {
    if (!state_.begun) fail_at(Wrong::profile_empty, item.place);
    if (item.point == state_.closed_form) fail_at(Wrong::profile_end, item.place);
    if (state_.corner.kind != CornerWord::Kind::none) fail_at_corner(state_.corner);
    if (!state_.held) fail_at(Wrong::profile_empty, item.place);
    const Item last = *state_.held;
    Point end = item.element.centre;
    if (item.point)
      need_on(last, end, &item.place);
    else
      end = joint(last, item);
    run_element(last, end);
    if (item.to != last.to) move_across(item);
    if (!item.point) run_.contour().close(head(item, end));
    state_ = ProfileState{};
  }

  /// The element kept back ends where it meets the next one.
  void join(const Item& next) {
    const Item last = *state_.held;
    const CornerWord word = std::exchange(state_.corner, CornerWord{});
    if (word.kind == CornerWord::Kind::radius) {
      const AtMostTwo<Joining> found = joining_circles(last.element, next.element, word.value);
      if (found.count == 0)
        throw ProgramError{&program::entry(Fault::corner_none),
                           word.place.column,
                           {text::number(word.value, 4)},
                           word.place.line};
      run_element(last, found[0].first);
      Item arc = last;
      arc.element = found[0].circle;
      arc.place = word.place;
      run_element(arc, found[0].second);
      return;
    }
    const Point corner = joint(last, next);
    if (word.kind == CornerWord::Kind::chamfer) {
      if (last.element.circle || next.element.circle)
        throw ProgramError{&program::entry(Fault::chamfer_lines), word.place.column, {}, word.place.line};
      const Point a = last.element.along, b = next.element.along;
      const Point first{corner.x - word.value * a.x, corner.y - word.value * a.y},
          second{corner.x + word.value * b.x, corner.y + word.value * b.y};
      run_element(last, first);
      Item cut = last;
      cut.element = line_through(first, second);
      cut.place = word.place;
      run_element(cut, second);
      return;
    }
    run_element(last, corner);
    if (word.kind == CornerWord::Kind::rolled && run_.contour().compensates()) run_.contour().corner(word);
  }

  Point joint(const Item& a, const Item& b) const {
    if (const auto touching = contact(a.element, b.element, kRadiusTolerance)) return *touching;
    const AtMostTwo<Point> common = common_points(a.element, b.element, kRadiusTolerance);
    if (common.count == 0) fail_at(Wrong::profile_apart, b.place);
    return common[a.second && common.count == 2 ? 1 : 0];
  }

  void need_on(const Item& item, Point point, const Place* place = nullptr) const {
    const Directed& e = item.element;
    const double off = e.circle ? distance(e.centre, point) - std::abs(e.radius) : distance_left(e, point);
    if (std::abs(off) > kRadiusTolerance)
      fail_at(Wrong::profile_off, place != nullptr ? *place : item.place, {text::number(std::abs(off), 4)});
  }

  void run_element(const Item& item, Point to) {
    ContourElement e = element_of(item);
    e.start = machine(state_.from);
    e.end = machine(to);
    if (item.element.circle) {
      const double scale1 = frames_.frame.scale(frames_.axis1), scale2 = frames_.frame.scale(frames_.axis2);
      if (std::abs(scale1) != std::abs(scale2))
        throw ProgramError{
            &program::entry(Fault::arc_scaled),
            item.place.column,
            {run_.machine().axes[at(frames_.axis1)].letter, run_.machine().axes[at(frames_.axis2)].letter},
            item.place.line};
      e.arc = true;
      e.centre = machine(item.element.centre);
      const bool ccw = (item.element.radius > 0.0) == (frames_.frame.sense(frames_.axis1, frames_.axis2) > 0);
      e.sweep_deg = sweep(e.start, e.end, e.centre, ccw);
    } else if (dot({to.x - state_.from.x, to.y - state_.from.y}, item.element.along) < -kRadiusTolerance) {
      fail_at(Wrong::profile_backwards, item.place);
    }
    run_.contour().take(e);
    arrive(to, e.to);
    state_.from = to;
    for (auto& between : std::exchange(state_.behind, {})) {
      if (auto* command = std::get_if<Command>(&between))
        run_.contour().follow(std::move(*command));
      else
        move_across(std::get<Item>(between));
    }
  }

  void move_across(const Item& item) {
    ContourElement e = element_of(item);
    e.in_plane = false;
    e.start = e.end = machine(state_.from);
    run_.contour().take(e);
    arrive(state_.from, e.to);
  }

  ContourElement element_of(const Item& item) const {
    ContourElement e;
    e.in_plane = true;
    e.feed = item.feed;
    e.corner = item.corner;
    e.to = item.to;
    e.place = item.place;
    return e;
  }

  /// An element that ends, and one that begins at a point; only their directions there count.
  ContourElement tail(const Item& item, Point point) const {
    ContourElement e = head(item, point);
    if (!e.arc) e = shift_back(e);
    e.end = machine(point);
    return e;
  }
  static ContourElement shift_back(ContourElement e) {
    e.start = {2.0 * e.start.x - e.end.x, 2.0 * e.start.y - e.end.y};
    return e;
  }
  ContourElement head(const Item& item, Point point) const {
    ContourElement e = element_of(item);
    e.start = machine(point);
    e.end = machine({point.x + item.element.along.x, point.y + item.element.along.y});
    e.arc = item.element.circle;
    e.centre = machine(item.element.centre);
    e.sweep_deg = std::copysign(1.0, item.element.radius) * frames_.frame.sense(frames_.axis1, frames_.axis2);
    return e;
  }

  Point machine(Point p) const {
    Position programmed = frames_.programmed;
    programmed[at(frames_.axis1)] = p.x;
    programmed[at(frames_.axis2)] = p.y;
    return {frames_.frame.to_machine(programmed, frames_.axis1),
            frames_.frame.to_machine(programmed, frames_.axis2)};
  }

  void arrive(Point programmed, const Position& to) {
    frames_.machine = to;
    const Point there = machine(programmed);
    frames_.machine[at(frames_.axis1)] = there.x;
    frames_.machine[at(frames_.axis2)] = there.y;
    frames_.programmed[at(frames_.axis1)] = programmed.x;
    frames_.programmed[at(frames_.axis2)] = programmed.y;
  }

  Execution& run_;
  ProfileState& state_;
  FramesState& frames_;
};

/// What a block of a profile asks for beside its element.
Item item_of(Execution& run, const BlockWords& words, const Word& word) {
  const State& state = run.state();
  if (state.modes.dimension == Function::incremental) fail(Wrong::element_incremental, word.column);
  run.frames().need_plane(word.column);
  run.refuse_words_but_axes(words);
  run.motion().store_feed(words);
  Item item;
  item.place = run.contour().place(word.column, run.block().number);
  item.to = run.motion().across(words, state.profile.open ? state.profile.to : state.frames.machine);
  item.feed = run.motion().feed(words);
  item.corner = run.motion().corner_of(words);
  return item;
}

Directed element_at(Execution& run, const Word& word, std::string_view written) {
  const int number = run.numbers().whole(word.value, "");
  const bool reverses = written[0] == '-';
  const char kind = written[reverses ? written.find_first_of("lc") : 0];
  if (kind == 'p') return point_circle(point_of(run, number, word.column));
  const Directed& e = kind == 'l' ? line_of(run, number, word.column) : circle_of(run, number, word.column);
  return reverses ? reversed(e) : e;
}

/// A point stands for the coordinates of the plane.
void move_to_point(Execution& run, const BlockWords& words, Point point) {
  const FramesState& frames = run.state().frames;
  run.frames().need_plane(words.instead_word->column);
  Word coordinates[2];
  BlockWords moved = words;
  moved.instead = nullptr;
  const int axes[2] = {frames.axis1, frames.axis2};
  const double values[2] = {point.x, point.y};
  for (std::size_t i = 0; i < 2; ++i) {
    if (words.axis[at(axes[i])] != nullptr)
      fail(Fault::word_without_function, words.axis[at(axes[i])]->column,
           {word_text(run.dialect(), run.block(), *words.axis[at(axes[i])])});
    const MachineModel::Axis& axis = run.machine().axes[at(axes[i])];
    const bool halves = axis.diameter && run.state().modes.across == Function::diameter;
    coordinates[i].column = words.instead_word->column;
    coordinates[i].value.column = words.instead_word->column;
    coordinates[i].value.number = values[i] * (halves ? 2.0 : 1.0) / run.numbers().unit_factor(axes[i]);
    coordinates[i].value.dimension = Dimension::absolute;
    moved.axis[at(axes[i])] = &coordinates[i];
    ++moved.axes;
  }
  profile(run, moved);
  run.motion().store_feed(moved);
  run.motion().move(moved);
}

}  // namespace

void element(Execution& run, const BlockWords& words) {
  const Word& word = *words.instead_word;
  const std::string_view written = run.block().text(word);
  ProfileState& state = run.state().profile;
  const bool on = run.state().modes.profile == Function::profile_on;
  const Directed e = element_at(run, word, written);
  const bool point = written[0] == 'p';
  if (!on && !state.open) {
    if (!point) fail(Wrong::profile_none, word.column, {std::string(written)});
    return move_to_point(run, words, e.centre);
  }
  Item item = item_of(run, words, word);
  item.point = point;
  item.element = e;
  item.second = written.ends_with("s2");
  const Position to = item.to;
  Profile(run).take(std::move(item), on && !state.open, !on);
  if (state.open) state.to = to;
}

void corner(Execution& run, const BlockWords& words) {
  const Word& word = *words.instead_word;
  run.frames().need_plane(word.column);
  run.refuse_all_but(words, {});
  const FramesState& frames = run.state().frames;
  const bool in_profile = run.state().profile.open;
  const bool cuts = run.block().text(word)[0] == 'b';
  CornerWord corner;
  corner.place = run.contour().place(word.column, run.block().number);
  corner.value = run.numbers().length(frames.axis1, word.value, false);
  if (cuts && !(corner.value > 0.0))
    run.numbers().refuse_range("b", word.value, corner.value, "0.0001", "99999.9999");
  corner.kind = cuts                  ? CornerWord::Kind::chamfer
                : corner.value == 0.0 ? CornerWord::Kind::rolled
                                      : CornerWord::Kind::radius;
  if (in_profile) return Profile(run).corner(std::move(corner));
  corner.value *= std::abs(frames.frame.scale(frames.axis1));
  if (!cuts) corner.value *= frames.frame.sense(frames.axis1, frames.axis2);
  run.contour().corner(std::move(corner));
}

void across(Execution& run, const BlockWords& words) {
  const Word* word = nullptr;
  for (const Word* axis : words.axis)
    if (word == nullptr) word = axis;
  if (word == nullptr)
    word = words.centre1 != nullptr ? words.centre1 : words.centre2 != nullptr ? words.centre2 : words.radius;
  Item item = item_of(run, words, *word);
  run.state().profile.to = item.to;
  Profile(run).across(std::move(item));
}

}  // namespace servogate::program::nc110
