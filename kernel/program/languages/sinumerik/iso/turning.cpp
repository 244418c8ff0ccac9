// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/cycles/threading.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// The cycles of one pass that last over blocks: longitudinal, facing, thread (specification 18.1 to 18.3).
namespace servogate::program::sinumerik::iso {
namespace {

enum Kind { none, longitudinal, thread_kind, facing };

void begin(Execution& run, Kind kind) {
  State& state = run.state();
  value(state, own::turning_cycle) = kind;
  value(state, own::turning_taper) = 0.0;
  value(state, own::turning_x) = state.frames.programmed[at(std::max(0, run.axes().find('X')))];
  value(state, own::turning_z) = state.frames.programmed[at(std::max(0, run.axes().find('Z')))];
  value(state, own::hole) = 0.0;
}

struct Plane {
  Execution& run;
  int x, z;
  double x0, z0;
  void go(double to_x, double to_z, bool rapid) const {
    Position to = run.state().frames.programmed;
    to[at(x)] = to_x;
    to[at(z)] = to_z;
    run.motion().go(to, rapid);
  }
};

void pass(Execution& run, const BlockWords& words) {
  State& state = run.state();
  const auto kind = static_cast<Kind>(value(state, own::turning_cycle));
  only(run, kind == thread_kind ? "XZUWRFQSMT" : "XZUWRFSMT");
  const int place = static_cast<int>(run.block().body) + 1;
  const std::string name = kind == longitudinal ? "G90" : kind == facing ? "G94" : "G92";
  if (run.contour().engaged()) fail(Wrong::compensated, place, {name, "G41/G42"});
  const Plane plane{run, run.axes().find('X'), run.axes().find('Z'),
                    state.frames.programmed[at(run.axes().find('X'))],
                    state.frames.programmed[at(run.axes().find('Z'))]};
  if (words.axis[at(plane.x)] != nullptr) value(state, own::turning_x) = target(run, words, plane.x);
  if (words.axis[at(plane.z)] != nullptr) value(state, own::turning_z) = target(run, words, plane.z);
  if (const Word* r = find(run.block(), 'R'); r != nullptr)
    value(state, own::turning_taper) = length(run, *r);
  const double x = value(state, own::turning_x), z = value(state, own::turning_z),
               taper = value(state, own::turning_taper);
  run.motion().store_feed(words);
  run.motion().end_profile();
  if (kind == thread_kind) {
    Threading thread;
    thread.name = name;
    thread.along = plane.z;
    thread.across = plane.x;
    thread.along_end = z;
    thread.across_end = x;
    thread.taper = taper;
    thread.lead = state.motion.feed * (state.modes.unit == Function::inch ? 25.4 : 1.0);
    if (!(thread.lead > 0.0)) fail(Wrong::thread_lead, place, {name});
    if (run.machine().spindles == 0) fail(Fault::no_spindle, place, {name});
    thread.run_out = memory(run, own::thread_chamfer, "ZSFI26") * 0.1 * thread.lead;
    if (!(thread.run_out > 0.0)) fail(Wrong::chamfer_zero, place, {name});
    thread.start_angle_deg = start_angle(run);
    return thread_pass(run, thread, x);
  }
  if (kind == longitudinal) {
    plane.go(x + taper, plane.z0, true);
    plane.go(x, z, false);
    plane.go(plane.x0, z, false);
  } else {
    plane.go(plane.x0, z + taper, true);
    plane.go(x, z, false);
    plane.go(x, plane.z0, false);
  }
  plane.go(plane.x0, plane.z0, true);
}

}  // namespace

void begin_longitudinal(Execution& run, BlockWords&, const Word&) { begin(run, longitudinal); }
void begin_thread_cycle(Execution& run, BlockWords&, const Word&) { begin(run, thread_kind); }
void begin_facing(Execution& run, BlockWords&, const Word&) { begin(run, facing); }

void arrange_turning(Execution& run, BlockWords& words) {
  if (value(run.state(), own::turning_cycle) == 0.0 || words.instead != nullptr) return;
  if (words.axes == 0 && words.radius == nullptr) return;
  for (const char letter : {'X', 'Z'})
    if (run.axes().find(letter) < 0)
      fail(Fault::axis_missing, static_cast<int>(run.block().body) + 1, {std::string(1, letter)});
  words.instead = pass;
  words.instead_word = &run.block().words[0];
}

}  // namespace servogate::program::sinumerik::iso
