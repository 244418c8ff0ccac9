// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/cycles/roughing.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// G70 to G73: a contour that stands in the program between two block numbers (specification 18.4 to 18.7).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kMostPasses = 9999;

[[noreturn]] void fail_in(Wrong wrong, std::uint32_t line, int column, std::vector<std::string> arguments) {
  throw ProgramError{&entry(wrong), column, std::move(arguments), static_cast<int>(line) + 1};
}

struct Lines {
  std::uint32_t first, last;
  bool both_axes = false;  ///< the first block names both
};

Lines lines_of(const Execution& run, const BlockWords& words) {
  const std::string name = g_word(run, words);
  for (const char letter : {'P', 'Q'})
    if (find(run.block(), letter) == nullptr)
      fail(Wrong::letter_missing, column(words), {name, std::string(1, letter)});
  const Source& source = run.flow().source();
  const auto line = [&](char letter) {
    const int number = whole(run, letter, 0);
    const std::uint32_t found = source.find_number(number, 0, source.lines() - 1);
    if (found == Source::kNone)
      fail(Wrong::contour_block, find(run.block(), letter)->column, {name, std::to_string(number)});
    return found;
  };
  const Lines lines{line('P'), line('Q')};
  if (lines.last < lines.first)
    fail(Wrong::contour_order, column(words),
         {name, std::to_string(whole(run, 'P', 0)), std::to_string(whole(run, 'Q', 0))});
  return lines;
}

/// Reads the blocks of a contour without executing them.
class Reader {
 public:
  Reader(Execution& run, const BlockWords& words) : run_(run), name_(g_word(run, words)) {
    const FramesState& frames = run.state().frames;
    x_ = run.axes().find('X');
    z_ = run.axes().find('Z');
    if (frames.axis1 != z_ || frames.axis2 != x_ || x_ < 0 || z_ < 0)
      fail(Wrong::alone, column(words),
           {name_, text::both("another plane than G18", "плоскость, кроме G18")});
    at_ = {frames.programmed[at(z_)], frames.programmed[at(x_)]};
    motion_ = run.state().modes.motion;
    dimension_ = run.state().modes.dimension;
  }

  std::vector<TurnedElement> read(Lines& lines) {
    const Source& source = run_.flow().source();
    for (line_ = lines.first; line_ <= lines.last; ++line_) {
      try {
        read_block(run_.dialect(), run_.axes(), source.line(line_), block_);
        if (block_.kind != BlockKind::words) continue;
        take(lines);
      } catch (ProgramError& error) {
        if (error.line == 0) error.line = static_cast<int>(line_) + 1;
        throw;
      }
    }
    if (corner_ != nullptr || corner_kind_ != 0) fail_in(Wrong::contour_last, lines.last, 1, {name_});
    return std::move(contour_);
  }

 private:
  const Word* word(char letter) const { return find(block_, letter); }

  double coordinate(const Word& w, double from) {
    Value v = w.value;
    if (setting(run_, "MD10884") == 0.0 && !v.fraction)
      v.number *= run_.state().modes.unit == Function::inch ? 0.0001 : 0.001;
    const double written = run_.numbers().length(w.axis, v);
    const bool adds = v.dimension == Dimension::as_modes ? dimension_ == Function::incremental
                                                         : v.dimension == Dimension::incremental;
    return adds ? from + written : written;
  }
  double size(const Word& w) const {
    const double unit = run_.state().modes.unit == Function::inch ? 25.4 : 1.0;
    const bool standard = setting(run_, "MD10884") == 0.0 && !w.value.fraction;
    return w.value.number * unit * (standard ? (unit == 1.0 ? 0.001 : 0.0001) : 1.0);
  }

  /// G words that may stand in a contour (specification 18.4): the motions, and what lasts.
  static bool in_contour(Function f) {
    switch (f) {
      case Function::rapid:
      case Function::line:
      case Function::arc_cw:
      case Function::arc_ccw:
      case Function::compensation_off:
      case Function::compensation_left:
      case Function::compensation_right:
      case Function::absolute:
      case Function::incremental:
      case Function::feed_minute:
      case Function::feed_revolution:
      case Function::surface_speed:
      case Function::revolutions:
        return true;
      default:
        return false;
    }
  }

  void take(Lines& lines) {
    Point to = at_;
    bool moves = false, both[2] = {false, false};
    for (std::size_t i = 0; i < block_.count; ++i) {
      const Word& w = block_.words[i];
      if (w.meaning == Meaning::g) {
        const Function f = w.g == nullptr ? Function::later : w.g->function;
        if (w.g != nullptr && w.g->motion == dwell) return;  // its words are a time
        if (!in_contour(f))
          fail_in(Wrong::contour_word, line_, w.column, {name_, word_text(run_.dialect(), block_, w)});
        if (f >= Function::rapid && f <= Function::arc_ccw) motion_ = f;
        if (f == Function::absolute || f == Function::incremental) dimension_ = f;
        continue;
      }
      if (w.meaning == Meaning::m && w.value.number != 98.0 && w.value.number != 99.0) continue;
      if (w.meaning == Meaning::axis && (w.axis == x_ || w.axis == z_)) {
        (w.axis == x_ ? to.y : to.x) = coordinate(w, w.axis == x_ ? at_.y : at_.x);
        both[w.axis == x_ ? 0 : 1] = moves = true;
        continue;
      }
      const std::string_view known = "IKRFST,";
      if (known.find(w.letter) == std::string_view::npos)
        fail_in(Wrong::contour_word, line_, w.column, {name_, word_text(run_.dialect(), block_, w)});
    }
    if (!moves) return;
    if (contour_.empty()) lines.both_axes = both[0] && both[1];
    element(to);
  }

  void element(Point to) {
    TurnedElement e;
    e.end = to;
    e.rapid = motion_ == Function::rapid;
    if (motion_ == Function::arc_cw || motion_ == Function::arc_ccw) arc(e, to);
    if (corner_kind_ != 0) round(e);
    contour_.push_back(e);
    at_ = to;
    corner_kind_ = 0;
    for (std::size_t i = 0; i < block_.count; ++i) {
      const Word& w = block_.words[i];
      if (w.letter != ',') continue;
      corner_kind_ = static_cast<char>(w.text_begin);
      corner_size_ = std::abs(size(w));
      if (corner_kind_ == 'A' || e.arc || e.rapid)
        fail_in(Wrong::contour_word, line_, w.column, {name_, word_text(run_.dialect(), block_, w)});
    }
  }

  void arc(TurnedElement& e, Point to) {
    const bool ccw = motion_ == Function::arc_ccw;
    e.arc = true;
    if (const Word* r = word('R'); r != nullptr) {
      if (!centre_by_radius(at_, to, size(*r), ccw, e.centre))
        fail(Fault::arc_too_small, r->column,
             {text::number(size(*r), 4), text::number(std::hypot(to.x - at_.x, to.y - at_.y), 4), "R"});
    } else {
      const Word *i = word('I'), *k = word('K');
      if (i == nullptr && k == nullptr) fail(Fault::arc_words, 1, {"I", "K", "R"});
      e.centre = {at_.x + (k == nullptr ? 0.0 : size(*k)), at_.y + (i == nullptr ? 0.0 : size(*i))};
    }
    const double r1 = std::hypot(at_.x - e.centre.x, at_.y - e.centre.y);
    const double r2 = std::hypot(to.x - e.centre.x, to.y - e.centre.y);
    if (std::abs(r1 - r2) > kRadiusTolerance)
      fail(Fault::not_congruent, 1, {text::number(r1, 4), text::number(r2, 4)});
    e.sweep_deg = sweep(at_, to, e.centre, ccw);
  }

  /// A chamfer or rounding between the last line and this one.
  void round(const TurnedElement& next) {
    if (next.arc || next.rapid || contour_.empty()) fail_in(Wrong::corner_open, line_, 1, {});
    TurnedElement& before = contour_.back();
    const Point from = contour_.size() > 1 ? contour_[contour_.size() - 2].end : begin_of_first();
    const auto unit = [](Point a, Point b) {
      const double l = std::hypot(b.x - a.x, b.y - a.y);
      return l > 0.0 ? Point{(b.x - a.x) / l, (b.y - a.y) / l} : Point{};
    };
    const Point in = unit(from, at_), out = unit(at_, next.end);
    const double cross = in.x * out.y - in.y * out.x, dot = in.x * out.x + in.y * out.y;
    const double turn = std::atan2(cross, dot);
    const double cut = corner_kind_ == 'C' ? corner_size_ : corner_size_ * std::tan(std::abs(turn) / 2.0);
    if (std::abs(cross) < 1e-9 || cut > std::hypot(at_.x - from.x, at_.y - from.y) ||
        cut > std::hypot(next.end.x - at_.x, next.end.y - at_.y))
      fail_in(Wrong::corner_open, line_, 1, {});
    before.end = {at_.x - in.x * cut, at_.y - in.y * cut};
    TurnedElement corner;
    corner.end = {at_.x + out.x * cut, at_.y + out.y * cut};
    if (corner_kind_ == 'R') {
      const double side = cross > 0.0 ? 1.0 : -1.0;
      corner.arc = true;
      corner.centre = {before.end.x - side * in.y * corner_size_, before.end.y + side * in.x * corner_size_};
      corner.sweep_deg = turn * 57.295779513082320877;
    }
    contour_.push_back(corner);
  }
  Point begin_of_first() const {
    const FramesState& frames = run_.state().frames;
    return {frames.programmed[at(z_)], frames.programmed[at(x_)]};
  }

  Execution& run_;
  std::string name_;
  int x_ = -1, z_ = -1;
  Point at_;
  Function motion_ = Function::rapid, dimension_ = Function::absolute;
  Block block_;
  std::uint32_t line_ = 0;
  std::vector<TurnedElement> contour_;
  const Word* corner_ = nullptr;
  char corner_kind_ = 0;
  double corner_size_ = 0.0;
};

double word_mm(const Execution& run, char letter) {
  const Word* w = find(run.block(), letter);
  if (w == nullptr) return 0.0;
  const bool standard = setting(run, "MD10884") == 0.0 && !w->value.fraction && w->meaning != Meaning::axis;
  return length(run, *w) * (standard && w->meaning != Meaning::radius ? 0.001 : 1.0);
}

double across(const Execution& run, double value) {
  const int x = run.axes().find('X');
  return x >= 0 && run.machine().axes[at(x)].diameter ? value / 2.0 : value;
}

void begin(Execution& run, const BlockWords& words, std::string_view letters) {
  only(run, letters);
  if (run.flow().names()[at(run.flow().file())] == "MDI")
    fail(Wrong::contour_mdi, column(words), {g_word(run, words)});
  if (run.contour().engaged()) fail(Wrong::compensated, column(words), {g_word(run, words), "G41/G42"});
  run.motion().store_feed(words);
  run.motion().end_profile();
}

Point stands(const Execution& run) {
  const FramesState& frames = run.state().frames;
  return {frames.programmed[at(frames.axis1)], frames.programmed[at(frames.axis2)]};
}

/// A block without P and Q stores depth and retract.
bool stores(Execution& run, const BlockWords& words, char depth) {
  if (find(run.block(), 'P') != nullptr || find(run.block(), 'Q') != nullptr) return false;
  only(run, depth == 'U' ? "UR" : "WR");
  if (find(run.block(), depth) != nullptr) {
    const double value = std::abs(word_mm(run, depth));
    if (!(value > 0.0)) fail(Wrong::step, column(words), {g_word(run, words), text::number(value)});
    remember(run, own::turning_depth, value);
  }
  if (find(run.block(), 'R') != nullptr) remember(run, own::turning_retract, std::abs(word_mm(run, 'R')));
  return true;
}

/// A contour and where the cycle starts.
Roughing cycle_of(Execution& run, const BlockWords& words, Lines& lines) {
  Roughing work;
  work.name = g_word(run, words);
  work.column = column(words);
  work.start = stands(run);
  work.contour = Reader(run, words).read(lines);
  if (work.contour.empty()) fail(Wrong::axis_alone, work.column, {work.name});
  run.flow().pass_over(lines.first, lines.last);
  return work;
}

/// The start is judged before anything moves: from inside of the contour the way back would cut.
void judge_start(const Execution& run, const Roughing& work) {
  const StartInside start = check_start(work);
  if (!start.inside) return;
  const FramesState& frames = run.state().frames;
  const MachineModel::Axis& axis = run.machine().axes[at(start.axis == 0 ? frames.axis1 : frames.axis2)];
  const double shown = axis.diameter ? 2.0 : 1.0;
  fail(Wrong::start_inside, work.column,
       {work.name, axis.letter, text::number(shown * (start.axis == 0 ? work.start.x : work.start.y)),
        text::number(shown * start.reach)});
}

void rough(Execution& run, const BlockWords& words, bool along) {
  if (stores(run, words, along ? 'U' : 'W')) return;
  begin(run, words, "PQUWFSTM");
  Lines lines = lines_of(run, words);
  Roughing work = cycle_of(run, words, lines);
  work.along_first = along;
  work.depth = memory(run, own::turning_depth, "ZSFI30", 0.001);
  work.retract = memory(run, own::turning_retract, "ZSFI31", 0.001);
  work.allowance = {word_mm(run, 'W'), across(run, word_mm(run, 'U'))};
  work.pockets = lines.both_axes;
  if (const RoughingFault fault = check_roughing(work); fault.turns_back)
    fail(Wrong::contour_pocket, work.column, {work.name, fault.axis == 0 ? "Z" : "X"});
  judge_start(run, work);
  rough_contour(run, work);
}

}  // namespace

void rough_along(Execution& run, const BlockWords& words) { rough(run, words, true); }
void rough_across(Execution& run, const BlockWords& words) { rough(run, words, false); }

/// Passes along the whole contour, each nearer to it.
void repeat_pattern(Execution& run, const BlockWords& words) {
  if (find(run.block(), 'P') == nullptr && find(run.block(), 'Q') == nullptr) {
    only(run, "UWR");
    if (find(run.block(), 'U') != nullptr) remember(run, own::pattern_x, word_mm(run, 'U'));
    if (find(run.block(), 'W') != nullptr) remember(run, own::pattern_z, word_mm(run, 'W'));
    if (const Word* r = find(run.block(), 'R'); r != nullptr) {
      const double passes = run.numbers().resolve(r->value);
      if (!(passes >= 1.0 && passes <= kMostPasses))
        fail(Wrong::letter_range, r->column, {g_word(run, words), "R", text::number(passes), "1-9999"});
      remember(run, own::pattern_passes, std::floor(passes));
    }
    return;
  }
  begin(run, words, "PQUWFSTM");
  Lines lines = lines_of(run, words);
  const Roughing work = cycle_of(run, words, lines);
  judge_start(run, work);
  const Point start = work.start;
  const std::vector<TurnedElement>& contour = work.contour;
  const double x = memory(run, own::pattern_x, "ZSFI32", 0.001),
               z = memory(run, own::pattern_z, "ZSFI33", 0.001);
  const int passes = static_cast<int>(memory(run, own::pattern_passes, "ZSFI34", 1.0));
  const Point allowance{word_mm(run, 'W'), across(run, word_mm(run, 'U'))};
  for (int pass = 1; pass <= passes; ++pass) {
    const double share = passes == 1 ? 0.0 : static_cast<double>(passes - pass) / (passes - 1);
    const Point shift{z * share + allowance.x, x * share + allowance.y};
    follow_contour(run, {{{start.x, start.y}, false, true, {}, 0.0}}, shift);
    follow_contour(run, contour, shift);
  }
  follow_contour(run, {{{stands(run).x, start.y}, false, true, {}, 0.0}, {start, false, true, {}, 0.0}}, {});
}

/// The blocks of the contour are executed as they stand; the second time this one leads back.
void finish(Execution& run, const BlockWords& words) {
  begin(run, words, "PQ");
  State& state = run.state();
  const int a1 = state.frames.axis1, a2 = state.frames.axis2;
  run.frames().need_plane(column(words));
  if (value(state, own::finishing) != 0.0) {
    value(state, own::finishing) = 0.0;
    run.contour().settle();
    state.motion.feed = value(state, own::finish_feed);
    const Point start{state.own[own::finish_at], state.own[own::finish_at + 1]};
    follow_contour(run, {{{stands(run).x, start.y}, false, true, {}, 0.0}, {start, false, true, {}, 0.0}},
                   {});
    return;
  }
  Lines lines = lines_of(run, words);
  judge_start(run, cycle_of(run, words, lines));
  value(state, own::finishing) = 1.0;
  value(state, own::finish_feed) = state.motion.feed;
  state.own[own::finish_at] = state.frames.programmed[at(a1)];
  state.own[own::finish_at + 1] = state.frames.programmed[at(a2)];
  run.flow().run_part(lines.first, lines.last);
  state.flow.part->back = run.flow().line();
}

}  // namespace servogate::program::sinumerik::iso
