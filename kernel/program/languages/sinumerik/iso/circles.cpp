// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

namespace servogate::program::sinumerik::iso {
namespace {

constexpr std::string_view kAxes = "XYZ";
constexpr unsigned kXy = 1u | 2u, kZx = 4u | 1u, kYz = 2u | 4u;

/// Bits of X, Y and Z.
struct Named {
  unsigned centres = 0, ends = 0;
};

Named named(const Execution& run, const BlockWords& words) {
  Named found;
  const Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i)
    if (block.words[i].meaning == Meaning::centre_of) found.centres |= 1u << (block.words[i].letter - 'I');
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (const int axis = run.axes().find(kAxes[i]); axis >= 0 && words.axis[at(axis)] != nullptr)
      found.ends |= 1u << i;
  return found;
}

Function plane_of(unsigned axes) {
  return axes == kXy   ? Function::plane_12
         : axes == kZx ? Function::plane_31
         : axes == kYz ? Function::plane_23
                       : Function::nothing;
}

}  // namespace

/// Two centres name a plane; a single one does with the axes of the end. What names none is refused later, as
/// a word without meaning.
void arrange_circle(Execution& run, BlockWords& words) {
  const Function motion = run.state().modes.motion;
  if (!words.has_centres || (motion != Function::arc_cw && motion != Function::arc_ccw)) return;
  const FramesState& frames = run.state().frames;
  if (run.state().virtual_axes.kind != VirtualAxes::Kind::none) return;
  const Named found = named(run, words);
  unsigned selected = 0;
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (const int axis = run.axes().find(kAxes[i]);
        axis >= 0 && (axis == frames.axis1 || axis == frames.axis2))
      selected |= 1u << i;
  if ((found.centres & ~selected) == 0) return;
  Function plane = plane_of(found.centres);
  if (plane == Function::nothing) plane = plane_of(found.centres | found.ends);
  if (plane == Function::nothing) return;
  const int place = static_cast<int>(run.block().body) + 1;
  const State& state = run.state();
  if (run.contour().engaged() || state.contour.shifted() ||
      state.modes.compensation != Function::compensation_off)
    fail(Wrong::circle_plane, place, {"G41/G42"});
  if (frames.frame.rotation() != 0.0) fail(Wrong::circle_plane, place, {"G68"});
  if (value(run.state(), own::polar) != 0.0) fail(Wrong::circle_plane, place, {"G16"});
  if (run.state().contour.coming.kind != CornerWord::Kind::none) fail(Wrong::circle_plane, place, {",C ,R"});
  words.plane_behind = frames.plane;
  run.frames().select_plane(plane, true, place);
}

}  // namespace servogate::program::sinumerik::iso
