// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Findings about lines of GPIO chips and gear ranges.
namespace servogate::machine::finding {

inline constexpr text::Entry kGpioOnly{"machine.gpio_only", "`{0}`: '{1}' is no {2} of a gpio station",
                                       "`{0}`: «{1}» — не {2} станции gpio"};
inline constexpr text::Entry kEncoderKey{
    "machine.encoder_key",
    "'{0}' counts an encoder (`b_line`): it has no `{1}`; while the chip is lost its counts stand",
    "«{0}» считает датчик (`b_line`): `{1}` у него нет; при потере микросхемы счёт остаётся прежним"};
inline constexpr text::Entry kEncoderPlace{
    "machine.encoder_place",
    "'{0}': counts of an encoder go round in 32 bits and need a place of form .LI, not {1}",
    "«{0}»: отсчёты датчика занимают 32 бита, нужен адрес вида .LI, а не {1}"};
inline constexpr text::Entry kLineTwice{"machine.line_twice",
                                        "'{0}': line {1} of this chip is that of '{2}' already",
                                        "«{0}»: линия {1} этой микросхемы уже занята сигналом «{2}»"};
inline constexpr text::Entry kGearsAndOne{
    "machine.gears_and_one",
    "spindle {0}: `{1}` and `gears` exclude each other: each gear has its own `gear`",
    "шпиндель {0}: `{1}` и `gears` исключают друг друга: у каждой ступени свой `gear`"};
inline constexpr text::Entry kGearsEncoder{"machine.gears_encoder",
                                           "spindle {0}: `{1}` does not go with `gears`: behind a gearbox "
                                           "the drive counts at its motor, and the angle of the "
                                           "spindle is not known",
                                           "шпиндель {0}: `{1}` несовместим с `gears`: за редуктором привод "
                                           "считает на двигателе, угол шпинделя неизвестен"};
inline constexpr text::Entry kCouplingWindowAlone{
    "machine.coupling_window", "spindle {0}: `coupling_window` does nothing without `coupling`",
    "шпиндель {0}: `coupling_window` без `coupling` ни на что не влияет"};
inline constexpr text::Entry kCouplingFirst{
    "machine.coupling_first",
    "spindle {0}: `coupling` is for the second spindle of a process: the first one leads",
    "шпиндель {0}: `coupling` задаётся второму шпинделю процесса: первый — ведущий"};
inline constexpr text::Entry kCouplingEncoder{
    "machine.coupling_encoder",
    "spindle {0}: `coupling` needs the angle of both spindles, and spindle {1} has no drive with an encoder "
    "(`drive`, counts_per_rev)",
    "шпиндель {0}: для `coupling` нужен угол обоих шпинделей, а у шпинделя {1} нет привода с датчиком "
    "(`drive`, counts_per_rev)"};
inline constexpr text::Entry kThreadMasterFirst{
    "machine.thread_master_first",
    "spindle {0}: `thread_master` is for the first spindle of a process: threads go by that one",
    "шпиндель {0}: `thread_master` задаётся первому шпинделю процесса: резьба нарезается по нему"};
inline constexpr text::Entry kThreadMasterEncoder{"machine.thread_master_encoder",
                                                  "spindle {0}: it is held to its set-point by its angle: "
                                                  "`thread_master = \"setpoint\"` needs a drive with "
                                                  "an encoder (`drive`, counts_per_rev)",
                                                  "шпиндель {0}: по заданному углу он ведётся по датчику: "
                                                  "для `thread_master = \"setpoint\"` нужен привод с "
                                                  "датчиком (`drive`, counts_per_rev)"};
inline constexpr text::Entry kAxisMAlone{"machine.axis_m_alone",
                                         "spindle {0}: `axis_m` does nothing without `axis`",
                                         "шпиндель {0}: `axis_m` без `axis` ни на что не влияет"};
inline constexpr text::Entry kAxisMSame{
    "machine.axis_m_same", "spindle {0}: one M function cannot make it axis {1} and a spindle again",
    "шпиндель {0}: одна функция M не может и переводить его в режим оси {1}, и возвращать"};
inline constexpr text::Entry kAxisMTaken{"machine.axis_m_taken",
                                         "spindle {0}: {1} of `axis_m` has a meaning already (own code, or "
                                         "end of a subprogram): choose another one",
                                         "шпиндель {0}: у {1} из `axis_m` уже есть значение (собственный код "
                                         "или конец подпрограммы): выберите другую"};
inline constexpr text::Entry kSpindleAxisNone{
    "machine.spindle_axis_none", "spindle {0}: it is to become axis {1}, and the machine has no axis {1}",
    "шпиндель {0}: должен становиться осью {1}, но оси {1} на станке нет"};
inline constexpr text::Entry kSpindleAxisProcess{
    "machine.spindle_axis_process",
    "spindle {0}: only the first spindle of a process becomes an axis, and axis {1} belongs to that process",
    "шпиндель {0}: осью становится только первый шпиндель процесса, и ось {1} принадлежит тому же процессу"};
inline constexpr text::Entry kSpindleAxisDrive{
    "machine.spindle_axis_drive",
    "spindle {0}: to become axis {1} it needs a drive on a CAN bus with its encoder (`drive`, "
    "`counts_per_rev`), no `gears` and no `encoder_delay`",
    "шпиндель {0}: чтобы стать осью {1}, ему нужен привод на шине CAN с датчиком (`drive`, "
    "`counts_per_rev`), без `gears` и без `encoder_delay`"};
inline constexpr text::Entry kSpindleAxisType{
    "machine.spindle_axis_type",
    "axis {0}: spindle {1} becomes it: it is a rotary axis of the programs (type = \"rotary\", not "
    "auxiliary)",
    "ось {0}: в неё переходит шпиндель {1}: это поворотная ось программ (type = \"rotary\", не auxiliary)"};
inline constexpr text::Entry kSpindleAxisOther{
    "machine.spindle_axis_other", "axis {0}: spindle {1} becomes it: it has that spindle's drive, \"{2}\"",
    "ось {0}: в неё переходит шпиндель {1}: у неё привод этого шпинделя, «{2}»"};
inline constexpr text::Entry kSpindleAxisHome{
    "machine.spindle_axis_home",
    "axis {0}: spindle {1} becomes it and knows its zero mark: home.method = \"none\"",
    "ось {0}: в неё переходит шпиндель {1}, и нулевая метка ему известна: home.method = \"none\""};
inline constexpr text::Entry kSpindleAxisBrake{
    "machine.spindle_axis_brake",
    "axis {0}: spindle {1} becomes it, and would turn against its brake: leave the brake out",
    "ось {0}: в неё переходит шпиндель {1}, и он вращался бы с включённым тормозом: уберите тормоз"};
inline constexpr text::Entry kSpindleAxisCounts{
    "machine.spindle_axis_counts",
    "axis {0}: {1} counts in 360°, and spindle {2}, which becomes it, has counts_per_rev = {3}",
    "ось {0}: {1} дискрет на 360°, а у шпинделя {2}, который в неё переходит, counts_per_rev = {3}"};
inline constexpr text::Entry kSpindleAxisDevice{
    "machine.spindle_axis_device",
    "spindle {0}: to become axis {1} its drive needs speed_mode csv and position_mode csp, and the target "
    "position (607A) and the target velocity (60FF) in an rpdo: device \"{2}\"",
    "шпиндель {0}: чтобы стать осью {1}, приводу нужны speed_mode csv и position_mode csp, а в rpdo — "
    "заданное положение (607A) и заданная скорость (60FF): устройство «{2}»"};
inline constexpr text::Entry kGearOrder{
    "machine.gear_order",
    "spindle {0}: gear \"{1}\" reaches {2} rpm, no more than the gear before it: slow ones first",
    "шпиндель {0}: ступень «{1}» — до {2} об/мин, не больше предыдущей: сначала медленные"};
inline constexpr text::Entry kGearsTooSlow{
    "machine.gears_too_slow", "spindle {0}: max_speed is {1} rpm, and its fastest gear reaches {2} rpm",
    "шпиндель {0}: max_speed — {1} об/мин, а самая быстрая ступень — до {2} об/мин"};
inline constexpr text::Entry kGearTwice{"machine.gear_twice", "spindle {0}: two gears have {1}",
                                        "шпиндель {0}: у двух ступеней {1}"};
inline constexpr text::Entry kGearsOnly{"machine.gears_only",
                                        "spindle {0}: `{1}` belongs to a spindle with `gears`",
                                        "шпиндель {0}: `{1}` бывает только вместе с `gears`"};
inline constexpr text::Entry kGearNoOutput{
    "machine.gear_no_output",
    "spindle {0}: only one gear can be without `output`, the one that engages by itself; \"{1}\" is another",
    "шпиндель {0}: без `output` может быть только одна ступень, включаемая сама; «{1}» — ещё одна"};
inline constexpr text::Entry kGearChangeSpeed{
    "machine.gear_change_speed",
    "spindle {0}: gear_change_speed {1} rpm is above what its gear \"{2}\" reaches",
    "шпиндель {0}: gear_change_speed {1} об/мин больше предела ступени «{2}»"};

}  // namespace servogate::machine::finding
