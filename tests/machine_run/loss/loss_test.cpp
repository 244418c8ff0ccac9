// SPDX-License-Identifier: Apache-2.0
// Parts of the mill are lost in the middle of a program: reaction, path, place of the lost axis, words.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include "gateway/control/compose/reading_beside.hpp"
#include "tests/machine_run/loss/forked.hpp"
#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using image::RequestKind;

constexpr int kAxes = 3;
using Point = std::array<double, kAxes>;

// Lines and a helix: all axes move all the time, so that any of them shows where on the path it is.
constexpr const char* kProgram =
    "N10 G90 G94 G71\n"
    "N20 G1 X180 Y100 Z-50 F9000\n"
    "N30 X-20 Y140 Z-20\n"
    "N40 G2 X60 Y140 Z-60 I20 J140 F6000\n"
    "N50 G1 X-150 Y-100 Z-90 F9000\n"
    "N60 X0 Y0 Z0\n"
    "N70 M30\n";

/// What can be taken away.
enum class Part { unplugged, frozen, silent, heartbeat, process_data, left, restarted, bus_off };
constexpr std::array kParts = {Part::unplugged,    Part::frozen, Part::silent,    Part::heartbeat,
                               Part::process_data, Part::left,   Part::restarted, Part::bus_off};

struct Expected {
  const char* name;
  std::vector<image::AlarmNumber> first;  ///< any of them is the first fault
  int found_within;                       ///< cycles from the cut to the alarm
};
constexpr std::int64_t kStoodFor = 1000;  ///< cycles

Expected expected(Part part) {
  using namespace cycle::alarm;
  using axis::alarm::kPdoMissing;
  switch (part) {
    case Part::unplugged:
      return {"unplugged", {kPdoMissing}, 5};
    case Part::frozen:
      return {"frozen", {kPdoMissing}, 5};
    case Part::silent:
      return {"silent", {kPdoMissing}, 5};
    case Part::heartbeat:
      return {"heartbeat", {kNodeLost}, 303};
    case Part::process_data:
      return {"process data", {kPdoMissing}, 5};
    case Part::left:
      return {"left Operational", {kNodeLeft, kPdoMissing}, 6};
    case Part::restarted:
      return {"restarted", {kPdoMissing, kNodeRestarted}, 20};
    case Part::bus_off:
      return {"bus off", {kBusOff}, 2};
  }
  return {};
}

/// The set-points of every cycle of a run that nothing disturbs.
struct Undisturbed {
  std::int64_t start = 0, end = 0;
  std::vector<Point> command;
  const Point& at(std::int64_t cycle) const { return command[static_cast<std::size_t>(cycle)]; }
};

Point commands(const Mill& mill) {
  Point p{};
  for (int a = 0; a < kAxes; ++a)
    p[static_cast<std::size_t>(a)] = mill.image().axes[static_cast<std::size_t>(a)].command;
  return p;
}

/// Distance of `p` from the stretch `a`-`b`, seen by the axes in `seen`.
double distance(const Point& p, const Point& a, const Point& b, const std::array<bool, kAxes>& seen,
                double& along) {
  double ab = 0.0, ap = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (seen[i]) {
      ab += (b[i] - a[i]) * (b[i] - a[i]);
      ap += (b[i] - a[i]) * (p[i] - a[i]);
    }
  along = ab > 0.0 ? std::clamp(ap / ab, 0.0, 1.0) : 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (seen[i]) square += std::pow(p[i] - a[i] - along * (b[i] - a[i]), 2);
  return std::sqrt(square);
}

/// Cycles in which the axes that are seen may stand, in a corner, while the others go on.
constexpr std::int64_t kLag = 40;

/// Follows set-points along the undisturbed path, never back.
class OnPath {
 public:
  OnPath(const Undisturbed& run, std::int64_t from, const std::array<bool, kAxes>& seen)
      : run_(run), at_(from), seen_(seen) {}
  /// False: the set-points are not on the path at the place where they have come or behind it.
  bool take(const Point& p) {
    for (std::int64_t i = at_; i < std::min(at_ + kLag, run_.end - 1); ++i)
      if (distance(p, run_.at(i), run_.at(i + 1), seen_, along_) < 1e-4) {
        at_ = i;
        return true;
      }
    return false;
  }
  double place(int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return run_.at(at_)[a] + along_ * (run_.at(at_ + 1)[a] - run_.at(at_)[a]);
  }

 private:
  const Undisturbed& run_;
  std::int64_t at_;
  std::array<bool, kAxes> seen_;
  double along_ = 0.0;
};

bool some(const std::array<bool, kAxes>& axes) { return axes[0] || axes[1] || axes[2]; }

struct Case {
  Part part;
  int axis;  ///< that is cut off; of a bus: one of its axes
};

class Lossy {
 public:
  /// Without a thread beside it, as a forked copy has none.
  explicit Lossy(const machine::LoadResult& machine)
      : machine_(machine),
        mill_(machine, kProgram, nullptr,
              {.worker = [] { return std::make_unique<gateway::WorksAtOnce>(); }}) {
    ready_ = mill_.make_ready();
    if (!ready_) return;
    ready_ = mill_.ask(RequestKind::start) == cycle::Refusal::none;
  }
  bool ready() const { return ready_; }
  Mill& mill() { return mill_; }
  std::int64_t now() const { return mill_.image().now.number; }

  Undisturbed run_undisturbed() {
    Undisturbed run;
    run.command.resize(static_cast<std::size_t>(now()) + 1, commands(mill_));
    run.start = now();
    mill_.after_cycle = [&] { run.command.push_back(commands(mill_)); };
    EXPECT_TRUE(mill_.until([&] { return mill_.process().state == image::ProcessState::ended; }))
        << mill_.alarm_list();
    run.end = now();
    mill_.after_cycle = nullptr;
    return run;
  }

  /// Goes on from here with a part cut off; what is wrong with what the machine does.
  std::string judge(const Case& c, const Undisturbed& run, bool& strict);

 private:
  std::optional<image::AlarmRecord> first_fault() const;
  std::string found(const Case& c, const image::AlarmRecord& fault, std::int64_t at) const;
  std::string at_rest(const Case& c);
  std::string place(const Case& c, const OnPath& path);
  std::string words(const Case& c, const image::AlarmRecord& fault) const;
  const machine::BusConfig& bus_of(int axis, int& bus, int& node) const {
    const std::string& drive = machine_.machine.axes[static_cast<std::size_t>(axis)].drive;
    machine_.machine.node(drive, &bus, &node);
    return machine_.machine.buses[static_cast<std::size_t>(bus)];
  }
  bool on_bus(int axis, int bus) const {
    int its = -1, node = -1;
    bus_of(axis, its, node);
    return its == bus;
  }
  void cut(const Case& c);
  void mend(const Case& c);
  std::array<bool, kAxes> left(const Case& c) const;

  machine::LoadResult machine_;
  mutable Mill mill_;
  bool ready_ = false;
};

void Lossy::cut(const Case& c) {
  int bus = -1, node = -1;
  bus_of(c.axis, bus, node);
  const std::string& drive = machine_.machine.axes[static_cast<std::size_t>(c.axis)].drive;
  mock::CanSegment* wire = mill_.control().world().wire(static_cast<std::size_t>(bus));
  switch (c.part) {
    case Part::unplugged:
      return wire->set_connected(node + 1, false);
    case Part::bus_off:
      return wire->force_bus_off(0);
    case Part::frozen:
      return mill_.inject(drive, fault::Kind::freeze);
    case Part::silent:
      return mill_.inject(drive, fault::Kind::silent);
    case Part::heartbeat:
      return mill_.inject(drive, fault::Kind::heartbeat_lost);
    case Part::process_data:
      return mill_.inject(drive, fault::Kind::pdo_dropped);
    case Part::restarted:
      return mill_.inject(drive, fault::Kind::reset);
    case Part::left: {  // stopped by a frame that the control does not hear: that it hears is another fault
      image::CanFrame stop;
      stop.length = 2;
      stop.data[0] = 2;
      stop.data[1] = static_cast<std::uint8_t>(machine_.machine.node(drive)->id);
      mill_.control().world().drive(drive)->on_frame(stop);
      return;
    }
  }
}

void Lossy::mend(const Case& c) {
  int bus = -1, node = -1;
  bus_of(c.axis, bus, node);
  mock::CanSegment* wire = mill_.control().world().wire(static_cast<std::size_t>(bus));
  const std::string& drive = machine_.machine.axes[static_cast<std::size_t>(c.axis)].drive;
  wire->set_connected(node + 1, true);
  if (c.part == Part::bus_off) wire->restart(0);
  mill_.control().world().drive(drive)->clear_faults();
}

std::array<bool, kAxes> Lossy::left(const Case& c) const {
  std::array<bool, kAxes> seen{};
  int bus = -1, node = -1;
  bus_of(c.axis, bus, node);
  for (int a = 0; a < kAxes; ++a)
    seen[static_cast<std::size_t>(a)] = c.part == Part::bus_off ? !on_bus(a, bus) : a != c.axis;
  return seen;
}

/// Cycles within which a stop shows; 0: it need not, as the program itself slows the axes that are left down.
/// Out of a corner in which the axes speed up by all that they have it begins when they have room, and rests
/// sooner than any that would begin at once.
int shows_a_stop_within(const Undisturbed& run, std::int64_t cycle, const std::array<bool, kAxes>& seen) {
  const auto speed = [&](std::int64_t k) {
    double square = 0.0;
    for (std::size_t i = 0; i < kAxes; ++i) square += std::pow(run.at(k + 1)[i] - run.at(k)[i], 2);
    return std::sqrt(square);
  };
  double left_way = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (seen[i]) left_way = std::max(left_way, std::abs(run.at(cycle + 1)[i] - run.at(cycle)[i]));
  const double before = speed(cycle - 1), then = speed(cycle), after = speed(cycle + 1);
  constexpr int kAtOnce = 2, kOutOfCorner = 60;
  constexpr double kSpeedsUp = 1e-4;  // mm a cycle, in two cycles: 50 mm/s2
  if (!(left_way > 1e-3 && after > before - 1e-9 && after - 2.0 * then + before > -1e-9)) return 0;
  return after - before > kSpeedsUp ? kOutOfCorner : kAtOnce;
}

std::optional<image::AlarmRecord> Lossy::first_fault() const {
  for (const image::AlarmRecord& r : mill_.control().cycle().alarms().history())
    if (r.reaction > image::Reaction::warn) return r;
  return std::nullopt;
}

std::string Lossy::judge(const Case& c, const Undisturbed& run, bool& strict) {
  const std::array<bool, kAxes> seen = left(c);
  const std::int64_t at = now();
  OnPath path(run, at, seen);
  std::int64_t otherwise = -1, off = -1;
  mill_.after_cycle = [&] {
    const Point p = commands(mill_);
    bool same = true;
    for (std::size_t i = 0; i < kAxes; ++i)
      same = same && (!seen[i] || std::abs(p[i] - run.at(std::min(now(), run.end))[i]) < 1e-9);
    if (!same && otherwise < 0) otherwise = now();
    if (some(seen) && off < 0 && !path.take(p)) off = now();
  };
  cut(c);
  if (!mill_.until([&] { return first_fault().has_value(); }, 0.5)) return "was not found; ";
  const image::AlarmRecord fault = *first_fault();
  if (!mill_.until([&] { return mill_.process().state == image::ProcessState::stopped_by_alarm; }, 2.0))
    return "the process did not stop; ";
  std::ostringstream wrong;
  if (!mill_.until([&] { return mill_.standing(); }, 1.0)) wrong << "axes go on; ";
  mill_.after_cycle = nullptr;
  if (some(seen)) {
    const int within = shows_a_stop_within(run, fault.cycle, seen);
    strict = within > 0;
    if (otherwise < 0 || (strict && otherwise > fault.cycle + within))
      wrong << "reaction " << otherwise - fault.cycle << " cycles after detection; ";
    if (off >= 0) wrong << "off the path " << off - at << " cycles after the cut; ";
  }
  wrong << found(c, fault, at) << at_rest(c);
  mend(c);
  mill_.run(3.0);
  wrong << place(c, path) << words(c, fault);
  return wrong.str();
}

/// The alarm is the right one, and in time.
std::string Lossy::found(const Case& c, const image::AlarmRecord& fault, std::int64_t at) const {
  std::ostringstream wrong;
  const Expected wanted = expected(c.part);
  if (std::find(wanted.first.begin(), wanted.first.end(), fault.number) == wanted.first.end())
    wrong << "first fault " << fault.number << "; ";
  if (fault.cycle - at > wanted.found_within) wrong << "found after " << fault.cycle - at << " cycles; ";
  if (fault.reaction != image::Reaction::stop_on_path) wrong << "other reaction; ";
  return wrong.str();
}

/// Those that are left stand at their set-points, the lost one has stopped by itself.
std::string Lossy::at_rest(const Case& c) {
  std::ostringstream wrong;
  const std::array<bool, kAxes> seen = left(c);
  for (int a = 0; a < kAxes; ++a) {
    const double error = mill_.true_position(a) - mill_.image().axes[static_cast<std::size_t>(a)].command;
    if (seen[static_cast<std::size_t>(a)] && std::abs(error) > 0.05)
      wrong << "axis " << a << " stands " << error << " off its set-point; ";
  }
  mill_.run(1.0);
  Point rest{};
  for (int a = 0; a < kAxes; ++a) rest[static_cast<std::size_t>(a)] = mill_.true_position(a);
  mill_.run(0.2);
  for (int a = 0; a < kAxes; ++a)
    if (const double way = mill_.true_position(a) - rest[static_cast<std::size_t>(a)]; std::abs(way) > 0.01)
      wrong << "axis " << a << " still moves: " << way << " mm in 0.2 s; ";
  return wrong.str();
}

/// What is said of the place of a lost axis is true, once its drive is heard again.
std::string Lossy::place(const Case& c, const OnPath& path) {
  std::ostringstream wrong;
  const std::array<bool, kAxes> seen = left(c);
  for (int a = 0; a < kAxes && some(seen); ++a) {
    if (seen[static_cast<std::size_t>(a)]) continue;
    const double end = path.place(a), off = mill_.true_position(a) - end;
    bool said_where = false, said_unknown = false;
    for (const image::AlarmRecord& r : mill_.control().cycle().alarms().history()) {
      if (r.axis != a) continue;
      said_unknown = said_unknown || r.number == axis::alarm::kPlaceUnknown;
      if (r.number != axis::alarm::kOffPath) continue;
      said_where = true;
      if (std::abs(r.limit - end) > 0.01)
        wrong << "end of the path said " << r.limit << ", is " << end << "; ";
      if (std::abs(r.value - off) > 0.05) wrong << "deviation said " << r.value << ", is " << off << "; ";
    }
    const bool counts_on = c.part != Part::restarted;
    if (!counts_on && said_where) wrong << "a place is said that cannot be known; ";
    if (std::abs(off) > 0.06 && !(counts_on ? said_where : said_unknown))
      wrong << "nobody says that axis " << a << " is " << off << " mm off; ";
  }
  return wrong.str();
}

/// One fault with its consequences, in words that name the part.
std::string Lossy::words(const Case& c, const image::AlarmRecord& fault) const {
  std::ostringstream wrong;
  for (const image::AlarmRecord& r : mill_.control().cycle().alarms().history())
    // Where all axes have stood for long, what a drive tells when it is heard again is told for itself.
    if (r.reaction > image::Reaction::warn && r.first_fault != fault.sequence &&
        !(r.number == axis::alarm::kDriveFault && r.axis == c.axis && r.cycle > fault.cycle + kStoodFor))
      wrong << r.number << " is no consequence of the first fault; ";
  const image::AlarmNames names = mill_.control().alarm_names();
  int bus = -1, node = -1;
  const machine::BusConfig& its = bus_of(c.axis, bus, node);
  const machine::NodeConfig& n = its.nodes[static_cast<std::size_t>(node)];
  const std::string letter = machine_.machine.axes[static_cast<std::size_t>(c.axis)].letter;
  for (const auto language : {text::Language::english, text::Language::russian}) {
    const bool russian = language == text::Language::russian;
    const std::string of_bus = (russian ? "шина " : "bus ") + its.name;
    const std::string of_node = (russian ? "узел " : "node ") + std::to_string(n.id) + " (" + its.name + "." +
                                n.name + (russian ? ", ось " : ", axis ") + letter + ")";
    const std::string& part = c.part == Part::bus_off ? of_bus : of_node;
    const std::string said = image::render(fault, names, language);
    if (said.find(part) == std::string::npos) wrong << '"' << said << "\" does not name " << part << "; ";
    if (image::render_remedy(fault, names, language).empty()) wrong << "no remedy; ";
  }
  return wrong.str();
}

void drive_case(Lossy& machine, const Case& c, const Undisturbed& run, int& strict_cases) {
  const std::string words = in_copy([&] {
    bool strict = false;
    const std::string wrong = machine.judge(c, run, strict);
    return wrong + (strict ? "+" : "-");
  });
  if (words.ends_with("+")) ++strict_cases;
  EXPECT_EQ(words.substr(0, words.size() - 1), "")
      << expected(c.part).name << ", axis " << c.axis << ", cut in cycle " << machine.now();
}

void cut_at_random(const machine::LoadResult& file, unsigned seed, int cases) {
  ASSERT_TRUE(file.ok());
  Lossy whole(file);
  ASSERT_TRUE(whole.ready()) << whole.mill().alarm_list();
  const Undisturbed run = whole.run_undisturbed();
  ASSERT_GT(run.end - run.start, 3000);
  Lossy machine(file);
  ASSERT_TRUE(machine.ready());
  ASSERT_EQ(machine.now(), run.start) << "runs repeat";
  std::mt19937 random(seed);
  // The heartbeat is missed 300 ms late, and the program must not have ended then.
  std::vector<std::int64_t> at;
  for (int i = 0; i < cases; ++i)
    at.push_back(run.start + 150 +
                 static_cast<std::int64_t>(random() % static_cast<unsigned>(run.end - run.start - 900)));
  std::ranges::sort(at);
  int strict = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", case " << i);
    ASSERT_TRUE(machine.mill().until([&] { return machine.now() >= at[i]; }));
    const Case c{kParts[i % kParts.size()], static_cast<int>(random() % kAxes)};
    drive_case(machine, c, run, strict);
    if (::testing::Test::HasFailure() && i > 40) return;  // one kind of mistake is enough to read
  }
  EXPECT_GT(strict, cases / 2) << "the program brakes too often by itself to show when the machine reacts";
}

/// Z on a bus of its own, with the node-ID that X has on the other.
machine::LoadResult two_segments() {
  return changed_mill([](std::string& text) {
    const auto replace = [&text](std::string_view from, std::string_view to) {
      const auto place = text.find(from);
      ASSERT_NE(place, std::string::npos) << from;
      text.replace(place, from.size(), to);
    };
    replace("[[bus.node]]\nname = \"z\"\nid = 3\ndevice = \"servo-cia402-brake\"\n", "");
    replace("# ---------------------------------------------------------------- axes\n",
            "[[bus]]\nname = \"head\"\nurl = \"mock:head\"\nbit_rate = \"1 Mbit/s\"\n"
            "[[bus.node]]\nname = \"z\"\nid = 1\ndevice = \"servo-cia402-brake\"\n");
    replace("drive = \"can.z\"", "drive = \"head.z\"");
    replace("node = \"can.z\"", "node = \"head.z\"");
  });
}

TEST(Loss, of_any_part_at_any_time_stops_what_is_left_on_the_path_as_soon_as_its_axes_can) {
  cut_at_random(changed_mill([](std::string&) {}), 20260, 240);
}

TEST(Loss, on_one_of_two_segments_leaves_the_axes_of_the_other_on_the_path) {
  cut_at_random(two_segments(), 4711, 120);
}

}  // namespace
}  // namespace servogate::machine_run
