// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

template <>
std::span<const std::string_view> choices_of<GearSource>() {
  static constexpr std::string_view kNames[] = {"setpoint", "measured"};
  return kNames;
}

template <>
const Section& section_of<ElectronicGearConfig>() {
  using C = ElectronicGearConfig;
  static constexpr double kMostTurns = 1e6;
  static const Key keys[] = {
      key<&C::follower>("follower", {.required = true, .refers = Refers::axis},
                        "letter of the axis that follows", "буква ведомой оси"),
      key<&C::master>("master", {.required = true},
                      "what it follows: the letter of an axis, or S or S2 for the first or second spindle",
                      "за чем она следует: буква оси либо S или S2 — первый или второй шпиндель"),
      key<&C::ratio>(
          "ratio", {.min = -kMostTurns, .max = kMostTurns, .required = true},
          "[follower, master], whole numbers: in turns of spindles and rotary axes, in mm of linear ones; "
          "[1, 40] is one turn of the follower for 40 of its master, [-1, 40] the other way",
          "[ведомая, ведущая], целые: в оборотах шпинделей и поворотных осей, в мм линейных; [1, 40] — один "
          "оборот ведомой на 40 оборотов ведущей, [-1, 40] — в обратную сторону"),
      key<&C::source>("source", {},
                      "what it follows: the set-point of its master, or what the master's encoder measures",
                      "за чем следует: за заданием ведущей или за показаниями её датчика"),
      key<&C::window>(
          "window",
          {.unit = Unit::axis_length, .min = 0, .max = kLongest, .above_min = true, .required = true},
          "so far the measured place of the follower may be off its master's; further off it is "
          "alarm 1301",
          "на столько измеренное положение ведомой может отстоять от заданного ведущей; дальше — "
          "авария 1301"),
      key<&C::in_phase>("in_phase", {},
                        "true: the follower goes to its place at `phase`; false: it goes on from where it is "
                        "when it has reached its speed",
                        "true: ведомая выходит в положение по `phase`; false: продолжает с того места, где "
                        "набрала скорость"),
      key<&C::phase>("phase", {.unit = Unit::axis_length, .min = -kLongest, .max = kLongest},
                     "with in_phase: position of the follower where its master is at zero",
                     "с in_phase: положение ведомой, когда ведущая в нуле"),
  };
  static const Section section{
      "an electronic gear: an axis that follows another axis or a spindle; the PLC engages the n-th gear of "
      "axis C by `C.gear` = n",
      "электронный редуктор: ось следует за другой осью или шпинделем; n-й редуктор оси C включает ПЛК: "
      "`C.gear` = n",
      keys, &default_object<C>};
  return section;
}

}  // namespace servogate::machine
