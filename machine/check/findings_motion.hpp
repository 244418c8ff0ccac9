// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Texts of what the checks of axes, spindles, safety and control can find.
namespace servogate::machine::finding {

// Axes
inline constexpr text::Entry kNoAxes{"machine.no_axes", "the machine has no axis",
                                     "у станка нет ни одной оси"};
inline constexpr text::Entry kTooMany{"machine.too_many", "{0} {1}: at most {2} are possible",
                                      "{1}: {0}, возможно не больше {2}"};
inline constexpr text::Entry kNoSuchProcess{"machine.no_such_process",
                                            "{0} is of process {1}, and control.processes is {2}",
                                            "{0} принадлежит процессу {1}, а control.processes равно {2}"};
inline constexpr text::Entry kAuxiliaryProcess{
    "machine.auxiliary_process", "{0}: an auxiliary axis has no process: no program moves it",
    "{0}: у вспомогательной оси нет процесса: программы её не перемещают"};
inline constexpr text::Entry kAuxiliaryOrder{
    "machine.auxiliary_order", "{0}: axes of programs stand before the auxiliary ones, {1} is auxiliary",
    "{0}: оси программ стоят до вспомогательных, а {1} вспомогательная"};
inline constexpr text::Entry kAuxiliaryDiameter{"machine.auxiliary_diameter",
                                                "{0}: an auxiliary axis has no diameter: no program moves it",
                                                "{0}: у вспомогательной оси нет диаметра: программы её не "
                                                "перемещают"};
inline constexpr text::Entry kAuxiliaryPacket{
    "machine.auxiliary_packet",
    "{0}: the places of an auxiliary axis here need control.k_size = {1}, it is {2}",
    "{0}: ячейкам этой вспомогательной оси нужно control.k_size = {1}, сейчас {2}"};
inline constexpr text::Entry kAuxiliaryAlone{"machine.auxiliary_alone",
                                             "{0}: a machine needs an axis that is not auxiliary",
                                             "{0}: станку нужна хотя бы одна не вспомогательная ось"};
inline constexpr text::Entry kTravelOrder{"machine.travel_order",
                                          "{0}: travel_min {1} is not below travel_max {2}",
                                          "{0}: travel_min {1} не меньше travel_max {2}"};
inline constexpr text::Entry kTravelCounts{
    "machine.travel_counts",
    "{0}: {1} are {2} counts of the drive, and at most {3} are exact; look at lead, gear and counts_per_rev",
    "{0}: {1} — это {2} дискрет привода, а точны не более {3}; проверьте lead, gear и counts_per_rev"};
inline constexpr text::Entry kHomeOutside{"machine.home_outside",
                                          "{0}: {1} {2} is outside the travel {3} to {4}",
                                          "{0}: {1} {2} вне хода от {3} до {4}"};
inline constexpr text::Entry kNoHoming{"machine.no_homing",
                                       "{0}: no [axis.home]: the zero is where the axis is switched on",
                                       "{0}: нет [axis.home]: нулём будет место, где ось включена"};
inline constexpr text::Entry kHomeSwitchMissing{"machine.home_switch_missing",
                                                "{0}: homing by {1} needs `home.switch`",
                                                "{0}: для способа {1} нужен `home.switch`"};
inline constexpr text::Entry kHomeMethodMissing{
    "machine.home_method_missing",
    "{0}: homing by the drive needs `home.drive_method`, a number of CiA 402-2",
    "{0}: для выхода в ноль силами привода нужен `home.drive_method`, номер метода CiA 402-2"};
inline constexpr text::Entry kHomeMethodUnknown{"machine.home_method_unknown",
                                                "{0}: the drive {2} has no homing method {1}; it has {3}",
                                                "{0}: у привода {2} нет метода выхода в ноль {1}; есть {3}"};
inline constexpr text::Entry kHomeDriveOnly{"machine.home_drive_only",
                                            "{0}: {1} acts with home.method = \"drive\" only",
                                            "{0}: {1} действует только при home.method = \"drive\""};
inline constexpr text::Entry kHomingNumber{
    "machine.homing_number", "\"{0}\" is no number of a homing method; written as \"17\", -128 to 127 but 0",
    "«{0}» не номер метода выхода в ноль; пишется \"17\", от -128 до 127, кроме 0"};
inline constexpr text::Entry kIpRecord{"machine.ip_record",
                                       "position_mode ip: no rpdo has {0}, the {1} of the record",
                                       "position_mode ip: ни в одном rpdo нет {0} ({1} записи)"};
inline constexpr text::Entry kIpNoPosition{"machine.ip_no_position", "ip_record has no position",
                                           "в ip_record нет position"};
inline constexpr text::Entry kHomeSpeedMissing{"machine.home_speed_missing",
                                               "{0}: homing by {1} needs `home.{2}` above 0",
                                               "{0}: для способа {1} нужен `home.{2}` больше 0"};
inline constexpr text::Entry kHomeSpeedOrder{"machine.home_speed_order",
                                             "{0}: home.slow {1} is above home.fast {2}",
                                             "{0}: home.slow {1} больше home.fast {2}"};
inline constexpr text::Entry kSpeedAboveLimit{"machine.speed_above_limit",
                                              "{0}: {1} {2} is above max_velocity {3}",
                                              "{0}: {1} {2} больше max_velocity {3}"};
inline constexpr text::Entry kNoLimitSwitch{
    "machine.no_limit_switch", "{0}: no {1}: only the software limit stops the axis at that end",
    "{0}: нет {1}: на этом конце ось остановит только программный предел"};
inline constexpr text::Entry kLimitInside{"machine.limit_inside",
                                          "{0}: {1} {2} lies inside the travel {3} to {4}",
                                          "{0}: {1} {2} лежит внутри хода от {3} до {4}"};
inline constexpr text::Entry kEndInside{"machine.end_inside",
                                        "{0}: {1} {2} does not lie behind {3}, where its switch works or its "
                                        "travel ends",
                                        "{0}: {1} {2} должен лежать за {3}, где срабатывает концевик или "
                                        "кончается ход"};
inline constexpr text::Entry kEndTooNear{
    "machine.end_too_near",
    "{0}: the mechanical end is only {2} beyond the limit switch {0}{1}: before homing the axis arrives at "
    "{3} and needs {4} to stop; reduce home.fast and jog_velocity_not_homed to {5} or less",
    "{0}: упор всего в {2} за концевиком {0}{1}: до выхода в ноль ось подходит на {3} и тормозит на пути "
    "{4}; уменьшите home.fast и jog_velocity_not_homed до {5} или ниже"};
inline constexpr text::Entry kSamePoint{"machine.same_point",
                                        "{0}: `{1}` and `{2}` are the same point \"{3}\"",
                                        "{0}: «{1}» и «{2}» — один и тот же сигнал «{3}»"};
inline constexpr text::Entry kHomeSwitchAtOnce{
    "machine.home_switch_at_once",
    "{0} and {1} would home at the same time (`home.order` {3}) on the same switch \"{2}\", which cannot "
    "tell the axes apart: give one of them another `home.order`",
    "{0} и {1} выходили бы в ноль одновременно (`home.order` {3}) по одному датчику «{2}», а он не "
    "различает оси: задайте одной из них другой `home.order`"};
inline constexpr text::Entry kHomeSwitchShared{
    "machine.home_switch_shared",
    "{0} and {1} share the home switch \"{2}\": while one axis is on it, homing the other finds a wrong zero "
    "or none; choose `home.final_position` so that the axis leaves the switch",
    "У осей {0} и {1} общий датчик нуля «{2}»: пока одна ось стоит на нём, другая найдёт неверный ноль или "
    "не найдёт его; задайте `home.final_position` так, чтобы ось сходила с датчика"};
inline constexpr text::Entry kHomeIsLimit{
    "machine.home_is_limit",
    "{0}: `{1}` is the home switch \"{3}\" of {2}: {2} driving over it would stop {0} as at its limit; give "
    "each of them a switch of its own",
    "{0}: «{1}» — датчик нуля «{3}» оси {2}: проходя по нему, {2} останавливала бы {0}, как на концевике; "
    "нужны отдельные датчики"};
inline constexpr text::Entry kLimitShared{
    "machine.limit_shared",
    "{0}: `{1}` and `{3}` of {2} are the same switch \"{4}\": it stops both axes, each of them moves off it "
    "in "
    "its own direction only, and no message can tell which one is on it",
    "{0}: «{1}» и «{3}» оси {2} — один и тот же концевик «{4}»: он останавливает обе оси, каждая сходит с "
    "него "
    "только в свою сторону, и ни одно сообщение не скажет, какая из них на нём"};
inline constexpr text::Entry kVerticalBrake{
    "machine.vertical_without_brake",
    "{0} is vertical and has no brake: it falls when its power is switched off",
    "{0}: вертикальная ось без тормоза: при снятии питания она упадёт"};
inline constexpr text::Entry kBrakeModbus{
    "machine.brake_over_modbus", "{0}: the brake \"{1}\" is switched over Modbus, up to {2} ms late",
    "{0}: тормоз «{1}» переключается через Modbus с опозданием до {2} мс"};
inline constexpr text::Entry kBrakeLoss{
    "machine.brake_loss",
    "{0}: if its station is lost, the brake \"{1}\" does not close: set loss = {2}, hold = false",
    "{0}: при потере станции тормоз «{1}» не наложится: нужно loss = {2}, hold = false"};
inline constexpr text::Entry kBrakeDelay{
    "machine.brake_delay",
    "{0}: brake.engage_delay is {1} ms, less than a cycle of {2} ms: the power is off before the brake holds",
    "{0}: brake.engage_delay равен {1} мс, меньше такта {2} мс: питание снимется раньше, чем тормоз удержит "
    "ось"};
inline constexpr text::Entry kFallsWithControl{
    "machine.falls_with_control", "{0}: if the control dies at {1}: {2}; {3}; {4}. Remedy: {5}",
    "{0}: если управление прекратит работу на {1}: {2}; {3}; {4}. Что сделать: {5}"};
inline constexpr text::Entry kRelayWatchesNothing{
    "machine.relay_watches_nothing",
    "{0}: brake.relay_delay describes a relay that watches safety.control_alive, but no such output is "
    "declared",
    "{0}: brake.relay_delay — время реле, следящего за safety.control_alive, а этот выход не задан"};
inline constexpr text::Entry kRelayTooQuick{
    "machine.relay_too_quick",
    "{0}: brake.relay_delay is {1} ms, but safety.control_alive changes only every {2} ms: the relay would "
    "drop out while the control is alive",
    "{0}: brake.relay_delay равен {1} мс, а safety.control_alive "
    "меняется лишь каждые {2} мс: реле отпускало бы "
    "при живом управлении"};
inline constexpr text::Entry kBrakeTwo{"machine.brake_twice",
                                       "{0}: the brake has both `point` and `drive_output`",
                                       "{0}: у тормоза заданы и `point`, и `drive_output`"};
inline constexpr text::Entry kPitchOrder{"machine.pitch_order",
                                         "{0}: pitch_table: coordinate {1} does not rise above {2}",
                                         "{0}: pitch_table: координата {1} не больше предыдущей {2}"};
inline constexpr text::Entry kPitchSteep{
    "machine.pitch_steep", "{0}: pitch_table: error changes by {1} over {2}; a screw is not that bad",
    "{0}: pitch_table: погрешность меняется на {1} на пути {2}; настолько плохих винтов не бывает"};
inline constexpr text::Entry kWarnAboveStop{
    "machine.warn_above_stop", "{0}: following_error_warn {1} is not below following_error_stop {2}",
    "{0}: following_error_warn {1} не меньше following_error_stop {2}"};
inline constexpr text::Entry kFollowingBeyondTravel{
    "machine.following_beyond_travel",
    "{0}: following_error_stop {1} is more than the whole travel of {2}: it would stop nothing",
    "{0}: following_error_stop {1} больше всего хода {2}: он ничего не остановит"};
inline constexpr text::Entry kWindowBeyondFollowing{
    "machine.window_beyond_following",
    "{0}: in_position_window {1} is above following_error_stop {2}: an exact stop would not wait at all",
    "{0}: in_position_window {1} больше following_error_stop {2}: точный останов вообще не ждал бы"};
inline constexpr text::Entry kCoarseBelowFine{
    "machine.coarse_below_fine", "{0}: in_position_window_coarse {1} is below in_position_window {2}",
    "{0}: in_position_window_coarse {1} меньше in_position_window {2}"};
inline constexpr text::Entry kCoarseBeyondFollowing{
    "machine.coarse_beyond_following",
    "{0}: in_position_window_coarse {1} is above following_error_stop {2}: a coarse stop would not wait at "
    "all",
    "{0}: in_position_window_coarse {1} больше following_error_stop {2}: грубый останов вообще не ждал бы"};
inline constexpr text::Entry kDiameter{"machine.diameter",
                                       "{0}: only a linear axis can be shown as a diameter",
                                       "{0}: в диаметрах показывается только линейная ось"};
inline constexpr text::Entry kWindowBelowCount{"machine.window_below_count",
                                               "{0}: in_position_window {1} is below one count ({2})",
                                               "{0}: in_position_window {1} меньше одной дискреты ({2})"};
inline constexpr text::Entry kEndlessHoming{"machine.endless_travel",
                                            "{0}: an endless axis has no limit switches",
                                            "{0}: у бесконечной оси не бывает концевых выключателей"};
// Spindles
inline constexpr text::Entry kSpindleSource{
    "machine.spindle_source", "spindle {0}: one of `drive`, `inverter` and `speed_output` is needed",
    "шпиндель {0}: нужно одно из `drive`, `inverter` и `speed_output`"};
inline constexpr text::Entry kSpindleSpeeds{"machine.spindle_speeds",
                                            "spindle {0}: min_speed {1} is not below max_speed {2}",
                                            "шпиндель {0}: min_speed {1} не меньше max_speed {2}"};
inline constexpr text::Entry kSpindleRelay{"machine.spindle_relay",
                                           "spindle {0}: `{1}` belongs to a spindle with `speed_output`",
                                           "шпиндель {0}: «{1}» бывает только вместе с `speed_output`"};
inline constexpr text::Entry kSpindleNoFeedback{
    "machine.spindle_no_feedback",
    "spindle {0}: `{1}` needs a drive; with `speed_output` nothing comes back, at speed is the command",
    "шпиндель {0}: для «{1}» нужен привод; при `speed_output` обратной связи нет, частота достигнута по "
    "команде"};
inline constexpr text::Entry kSpindleOnlyCcw{
    "machine.spindle_only_ccw", "spindle {0}: `ccw_output` without `cw_output`: who turns it clockwise?",
    "шпиндель {0}: `ccw_output` без `cw_output`: чем включается вращение по часовой стрелке?"};
inline constexpr text::Entry kSpindleLoss{
    "machine.spindle_loss",
    "spindle {0}: a lost station has to stop it, but \"{1}\" does not go to its rest (loss = {2}, hold = "
    "false)",
    "шпиндель {0}: при потере станции он должен остановиться, но «{1}» не переходит в покой (loss = {2}, "
    "hold = false)"};
inline constexpr text::Entry kSpindleScale{
    "machine.spindle_scale",
    "spindle {0}: \"{1}\" would be {2} at rest and {3} at max_speed; a register holds {4}: see scale and "
    "shift",
    "шпиндель {0}: «{1}» был бы {2} в покое и {3} на max_speed; регистр вмещает {4}: см. scale и shift"};
inline constexpr text::Entry kSpindleWord{
    "machine.spindle_word", "spindle {0}: {1} rpm do not fit into {2}: a place of form .LI or .RE is needed",
    "шпиндель {0}: {1} об/мин не помещается в {2}: нужен адрес вида .LI или .RE"};
// Outputs of the control itself
inline constexpr text::Entry kControlWrites{
    "machine.control_writes", "`{0}`: the control itself writes \"{1}\"; its writer cannot be {2}",
    "«{0}»: сигнал «{1}» пишет само управление; писать его не может {2}"};
inline constexpr text::Entry kControlWritesTwice{"machine.control_writes",
                                                 "`{0}`: \"{1}\" is already the output of `{2}`",
                                                 "«{0}»: «{1}» уже служит выходом «{2}»"};
// Safety
inline constexpr text::Entry kEstopModbus{"machine.estop_over_modbus",
                                          "the emergency-stop chain \"{0}\" comes over Modbus ({1}): a line "
                                          "that is polled and may be lost; use GPIO or a drive input",
                                          "цепь аварийного останова «{0}» приходит через Modbus ({1}): линия "
                                          "опрашивается и может пропасть; нужен GPIO или вход привода"};
inline constexpr text::Entry kEstopSlow{
    "machine.estop_not_with_sync",
    "the emergency-stop chain \"{0}\" comes in tpdo {1} of \"{2}\", which is not sent with every SYNC: "
    "transmission = 1",
    "цепь аварийного останова «{0}» приходит в tpdo {1} файла «{2}», который передаётся не с каждым SYNC: "
    "нужен "
    "transmission = 1"};
inline constexpr text::Entry kEstopInverted{
    "machine.estop_inverted",
    "\"{0}\" is inverted: a broken wire would read as a closed emergency-stop chain",
    "«{0}» инвертирован: обрыв провода читался бы как замкнутая цепь аварийного останова"};
inline constexpr text::Entry kEstopLoss{
    "machine.estop_loss", "\"{0}\": on loss the emergency-stop chain must read 0 (loss = 0, hold = false)",
    "«{0}»: при потере станции цепь аварийного останова должна читаться как 0 (loss = 0, hold = false)"};
inline constexpr text::Entry kMockGuard{
    "machine.mock_guards_real_drive",
    "\"{0}\" is a mock input ({1}) that no wire can open, but {2} is real: name a real input, or, "
    "for a bench without a machine, set safety.mock_inputs_guard_real_drives = true",
    "«{0}»: имитируемый вход ({1}), его не разомкнёт никакой провод, а {2} — настоящее устройство: укажите "
    "настоящий вход либо, для стенда без станка, safety.mock_inputs_guard_real_drives = true"};
inline constexpr text::Entry kMockGuardDeclared{
    "machine.mock_guard_declared",
    "safety.mock_inputs_guard_real_drives: no emergency stop and no limit switch of this file stops a real "
    "drive",
    "safety.mock_inputs_guard_real_drives: аварийный останов и концевики этого файла настоящий привод не "
    "остановят"};
inline constexpr text::Entry kNoEstop{"machine.no_estop",
                                      "no emergency-stop chain is declared (safety.estop)",
                                      "цепь аварийного останова не описана (safety.estop)"};
inline constexpr text::Entry kLimitModbus{
    "machine.limit_over_modbus",
    "{0}: limit switch \"{1}\" comes over Modbus: up to {2} mm further at full speed",
    "{0}: концевик «{1}» приходит через Modbus: до {2} мм лишнего пути на полной скорости"};
inline constexpr text::Entry kLimitSlow{"machine.limit_not_with_sync",
                                        "{0}: limit switch \"{1}\" comes in tpdo {2} of \"{3}\", which is "
                                        "not sent with every SYNC: transmission = 1",
                                        "{0}: концевик «{1}» приходит в tpdo {2} файла «{3}», который "
                                        "передаётся не с каждым SYNC: нужен transmission = 1"};
inline constexpr text::Entry kNoStartPoint{
    "machine.no_start_point", "real buses and no run.start_point: programs start only by `servogate start`",
    "настоящие шины без run.start_point: программу запустит только `servogate start`"};
inline constexpr text::Entry kStartNow{
    "machine.start_now", "run.allow_start_now: a command can move real drives without the operator's button",
    "run.allow_start_now: команда сможет двигать настоящие приводы без кнопки оператора"};
// Control, transports
inline constexpr text::Entry kCycleStep{"machine.cycle_step", "cycle_time {0} ms is no multiple of {1} us",
                                        "cycle_time {0} мс не кратно {1} мкс"};
inline constexpr text::Entry kBadUrl{"machine.bad_url", "`{0}`: \"{1}\" is no transport; expected {2}",
                                     "«{0}»: «{1}» не транспорт; ожидалось {2}"};
inline constexpr text::Entry kBitRate{"machine.bit_rate", "bit_rate {0} bit/s is none of CiA 301: {1} kbit/s",
                                      "bit_rate {0} бит/с нет в CiA 301: {1} кбит/с"};
inline constexpr text::Entry kUnknownDialect{"machine.unknown_dialect", "dialect \"{0}\" is not one of {1}",
                                             "язык «{0}» не входит в список: {1}"};
inline constexpr text::Entry kKeyNotHere{"machine.key_not_here", "`{0}` has no meaning for a {1} station",
                                         "«{0}» не имеет смысла для станции вида {1}"};
inline constexpr text::Entry kProbeLatchAlone{
    "machine.probe_latch_alone",
    "probe_latch = \"{0}\" needs `probe`: its input says that the probe is free before it measures",
    "для probe_latch = \"{0}\" нужен `probe`: его вход сообщает, что щуп свободен перед измерением"};
inline constexpr text::Entry kKeyNeeded{"machine.key_needed", "a {1} station needs `{0}`",
                                        "для станции вида {1} нужен `{0}`"};
inline constexpr text::Entry kSwitchZone{"machine.switch_zone", "\"{0}\": from {1} is not below to {2}",
                                         "«{0}»: from {1} не меньше to {2}"};
inline constexpr text::Entry kSwitchZoneMissing{"machine.switch_zone", "\"{0}\" needs `from`, `to` or both",
                                                "«{0}»: нужен `from`, `to` или оба"};
inline constexpr text::Entry kBadObject{"machine.bad_object",
                                        "\"{0}\" is no object; expected a form like {1}",
                                        "«{0}» не объект; ожидался вид {1}"};
inline constexpr text::Entry kObjectValue{"machine.object_value",
                                          "object {0}: {1} does not fit into {2} bits",
                                          "объект {0}: {1} не помещается в {2} бит"};
inline constexpr text::Entry kObjectCommand{
    "machine.object_command",
    "object {0} is a command, which the control gives in its cycle or the device carries out at once; it is "
    "no "
    "setting",
    "объект {0} — команда, которую управление даёт в цикле или устройство выполняет сразу, а не настройка"};
inline constexpr text::Entry kObjectOwned{
    "machine.object_owned", "object {0} is written by the control itself; this value would be lost: {1}",
    "объект {0} записывает само управление, это значение пропало бы: {1}"};
inline constexpr text::Entry kHeartbeatShort{
    "machine.heartbeat_short",
    "heartbeat {0} of node \"{1}\" is shorter than the cycle of {2}: the control could not keep up with it",
    "heartbeat {0} узла «{1}» короче цикла {2}: управление не успевало бы"};
inline constexpr text::Entry kHeartbeatLong{
    "machine.heartbeat_long",
    "heartbeat {0} of node \"{1}\" is not below its boot_timeout of {2}: its start would not be seen in time",
    "heartbeat {0} узла «{1}» не короче его boot_timeout {2}: его пуск не был бы замечен вовремя"};
inline constexpr text::Entry kSlowCommand{
    "machine.slow_command",
    "{0}: RPDO {1} of {2} goes with every {3}th SYNC only; controlword and position of an axis go with each "
    "one",
    "{0}: RPDO {1} устройства {2} идёт лишь с каждым {3}-м SYNC; слово управления и положение оси нужны с "
    "каждым"};
inline constexpr text::Entry kSlowFeedback{
    "machine.slow_feedback",
    "{0}: TPDO {1} of {2} comes with every {3}th SYNC only; statusword and position of an axis come with "
    "each "
    "one",
    "{0}: TPDO {1} устройства {2} приходит лишь с каждым {3}-м SYNC; слово состояния и положение оси нужны с "
    "каждым"};
inline constexpr text::Entry kGuardShort{
    "machine.guard_short",
    "node \"{0}\": guard_time {1} of device file \"{2}\" is shorter than the cycle of {3}: the control could "
    "not keep up with it",
    "узел «{0}»: guard_time {1} файла устройства «{2}» короче цикла {3}: управление не успевало бы"};
inline constexpr text::Entry kGuardLong{
    "machine.guard_long",
    "boot_timeout {0} of node \"{1}\" is not above the guard_time of {2}: its start would not be seen in "
    "time",
    "boot_timeout {0} узла «{1}» не больше его guard_time {2}: его пуск не был бы замечен вовремя"};
inline constexpr text::Entry kDeadlineShort{
    "machine.deadline_short",
    "node \"{0}\": rpdo {1} of device file \"{2}\" is missed after `event` {3}, and it goes every {4} only",
    "узел «{0}»: rpdo {1} файла устройства «{2}» считается пропавшим через `event` {3}, а передаётся лишь "
    "каждые {4}"};
inline constexpr text::Entry kWindowShort{
    "machine.sync_window",
    "sync_window {0} of bus \"{1}\": SYNC and the process data of a cycle need {2} on the wire; what comes "
    "later would be thrown away",
    "sync_window {0} шины «{1}»: SYNC и данные процесса одного цикла занимают {2}; всё более позднее "
    "отбрасывалось бы"};
inline constexpr text::Entry kWindowLong{"machine.sync_window",
                                         "sync_window {0} of bus \"{1}\" is longer than the cycle of {2}",
                                         "sync_window {0} шины «{1}» длиннее цикла {2}"};
inline constexpr text::Entry kTimeShort{
    "machine.time_period",
    "time_period {0} of bus \"{1}\" is shorter than {2}: TIME goes at most once in a cycle and a millisecond",
    "time_period {0} шины «{1}» меньше {2}: TIME передаётся не чаще раза за цикл и за миллисекунду"};
inline constexpr text::Entry kObjectTwice{
    "machine.object_twice", "object {0} stands here already, as \"{1}\"; one of the two values would be lost",
    "объект {0} здесь уже есть: «{1}»; одно из двух значений пропало бы"};
inline constexpr text::Entry kQuickStopCoasts{
    "machine.quick_stop_coasts",
    "object {0} = 0: a quick stop would only take the torque away, and the axis would coast",
    "объект {0} = 0: быстрый останов лишь снимал бы момент, и ось катилась бы дальше"};
inline constexpr text::Entry kPdoWidth{"machine.pdo_width", "{0}: object {1} has {2} bits",
                                       "{0}: у объекта {1} бит: {2}"};
inline constexpr text::Entry kInhibitAboveEvent{"machine.pdo_inhibit",
                                                "tpdo {0}: `inhibit` {1} lets it come less often than its "
                                                "`event` of {2} says; nothing could keep to both",
                                                "tpdo {0}: `inhibit` {1} не даёт передавать его так часто, "
                                                "как велит `event` {2}; оба условия невыполнимы"};
// Devices
inline constexpr text::Entry kMotorTooFast{
    "machine.motor_too_fast", "{0}: {1} needs {2} rpm of the motor; {3} allows {4} rpm",
    "{0}: для {1} двигатель должен вращаться {2} об/мин; {3} допускает {4} об/мин"};
inline constexpr text::Entry kDeviceCounts{
    "machine.device_counts", "{0}: counts_per_rev {1} differs from {2} of the device file {3}",
    "{0}: counts_per_rev {1} отличается от {2} в файле устройства {3}"};
inline constexpr text::Entry kSpindleCounts{"machine.spindle_counts",
                                            "spindle {0}: nobody says what its drive counts: "
                                            "`counts_per_rev` here for an encoder at the spindle, or under "
                                            "[motor] of the device file {1}",
                                            "шпиндель {0}: не сказано, сколько отсчётов на оборот: "
                                            "`counts_per_rev` здесь для датчика на шпинделе либо в "
                                            "[motor] файла устройства {1}"};
inline constexpr text::Entry kNoBrakeOutput{"machine.no_brake_output",
                                            "{0}: brake.drive_output, but {1} has no brake output",
                                            "{0}: задан brake.drive_output, но у {1} нет выхода тормоза"};
inline constexpr text::Entry kNoErrorStates{
    "machine.no_error_states",
    "node {0}: device file \"{1}\" says that the state of its outputs cannot be set for when the control "
    "falls silent (connection_loss = \"none\"), and rpdo {2} has no deadline: give it one (event), or set "
    "unsupervised = true",
    "узел {0}: по файлу устройства «{1}» поведение выходов при молчании управления не задаётся "
    "(connection_loss = \"none\"), а у rpdo {2} нет срока: задайте его (event) либо unsupervised = true"};
inline constexpr text::Entry kLossIsTheModules{
    "machine.loss_is_the_modules",
    "{0}: device file \"{1}\" has connection_loss = \"none\": the module itself decides what its outputs do, "
    "hold and loss cannot be set",
    "{0}: в файле устройства «{1}» connection_loss = \"none\": "
    "выходы ведёт сам модуль, hold и loss задать нельзя"};
inline constexpr text::Entry kUnsupervised{
    "machine.unsupervised",
    "{0}: the drive {1} would not detect a dead control (no heartbeat consumer or guarding with a reaction, "
    "no RPDO deadline); unsupervised = true accepts that",
    "{0}: привод {1} не обнаружит, что управление прекратило работу (нет контроля heartbeat или опроса с "
    "реакцией, нет срока RPDO); с этим можно согласиться ключом unsupervised = true"};
inline constexpr text::Entry kUnsupervisedModule{
    "machine.unsupervised",
    "{0}: the module {1} would not detect a dead control and would keep its outputs (no heartbeat consumer, "
    "no guarding, no RPDO deadline); unsupervised = true accepts that",
    "{0}: модуль {1} не обнаружит, что управление прекратило работу, и сохранит выходы (нет контроля "
    "heartbeat, опроса, срока RPDO); с этим можно согласиться ключом unsupervised = true"};
inline constexpr text::Entry kPdoSize{"machine.pdo_size", "{0} {1} maps {2} bits; 64 fit",
                                      "{0} {1}: отображено {2} бит; помещается 64"};
inline constexpr text::Entry kPdoTwice{"machine.pdo_twice", "{0} {1} is already declared in line {2}",
                                       "{0} {1}: повторяет описание из строки {2}"};
inline constexpr text::Entry kPdoNoWord{"machine.pdo_no_word", "no {0} maps {1} ({2})",
                                        "ни один {0} не содержит {1} ({2})"};
inline constexpr text::Entry kPdoTransmission{"machine.pdo_transmission",
                                              "transmission {0} is reserved: 0 to 240, 252 to 255",
                                              "тип передачи {0} зарезервирован: 0-240, 252-255"};
inline constexpr text::Entry kPdoRemoteRpdo{
    "machine.pdo_remote", "transmission {0} is for a tpdo: only what a device sends can be asked for",
    "тип передачи {0} только для tpdo: запросить можно лишь то, что передаёт устройство"};
inline constexpr text::Entry kPdoRemotePeriod{
    "machine.pdo_remote",
    "tpdo {0}: with transmission {1} it comes when the control asks for it; `event` has to say how often "
    "that "
    "is",
    "tpdo {0}: при типе {1} он передаётся по запросу управления; ключ `event` задаёт период запросов"};
inline constexpr text::Entry kNobodyWrites{"machine.pdo_nobody_writes",
                                           "{0} in rpdo {1}: the control has no value for it and would send "
                                           "0; take it out, or give it a value under "
                                           "`objects`, which is sent then",
                                           "{0} в rpdo {1}: у управления нет для него значения, передавался "
                                           "бы 0; уберите его или задайте значение в "
                                           "`objects`, оно и будет передаваться"};
inline constexpr text::Entry kNobodyReads{
    "machine.pdo_nobody_reads", "{0} in tpdo {1}: nobody reads it, and it loads the bus in every cycle of it",
    "{0} в tpdo {1}: его никто не читает, а шину он загружает"};
inline constexpr text::Entry kSdoOnlyPdo{"machine.sdo_only_pdo",
                                         "sdo_only: a drive that only answers SDO has no {0}",
                                         "sdo_only: у привода, отвечающего только по SDO, нет {0}"};
inline constexpr text::Entry kSdoOnlyMode{
    "machine.sdo_only_mode",
    "sdo_only: set-points come too seldom for a mode with one in every cycle; {0} has to be one of {1}",
    "sdo_only: задания приходят слишком редко для режима с заданием в каждом цикле; {0} должен быть: {1}"};
inline constexpr text::Entry kSdoOnlyBrake{
    "machine.sdo_only_brake",
    "sdo_only: a brake that is worked over SDO would be late; brake_bit has to be -1",
    "sdo_only: тормоз, управляемый по SDO, срабатывал бы с опозданием; brake_bit должен быть -1"};
inline constexpr text::Entry kOwnMotion{
    "machine.own_motion",
    "{0}: the drive {1} {2}, so it forms the motion between two set-points by itself and leaves the path; "
    "that "
    "is for an axis with auxiliary = true, or a spindle",
    "{0}: привод {1} {2}, поэтому сам строит движение между заданиями и сходит с траектории; он годится для "
    "оси с auxiliary = true или шпинделя"};
inline constexpr text::Entry kOwnMotionLag{
    "machine.own_motion_lag",
    "{0}: the drive {1} follows by up to {2} behind at {3}, which following_error_stop and "
    "following_error_velocity do not allow ({4}): the axis would stop with a following error",
    "{0}: привод {1} отстаёт до {2} на {3}, а following_error_stop и following_error_velocity допускают {4}: "
    "ось остановится по рассогласованию"};
inline constexpr text::Entry kTorqueAuxiliary{
    "machine.torque_auxiliary",
    "{0}: torque_max is for MC_TorqueControl, which moves axes with auxiliary = true only",
    "{0}: torque_max нужен для MC_TorqueControl, который перемещает только оси с auxiliary = true"};
inline constexpr text::Entry kTorqueUnmapped{"machine.torque_unmapped",
                                             "{0}: torque_max needs {2} in a {3} of {1}",
                                             "{0}: для torque_max нужен {2} в {3} устройства {1}"};
inline constexpr text::Entry kTorqueAbovePeak{
    "machine.torque_above_peak", "{0}: torque_max = {1} % is above the {2} % that the motor of {3} can give",
    "{0}: torque_max = {1} % выше {2} %, которые даёт двигатель {3}"};
inline constexpr text::Entry kSilentStatus{
    "machine.silent_status",
    "{0}: the statusword of {3} (tpdo {1}, transmission {2}) is sent on event only, so that silence cannot "
    "be told from loss. Use 1 to 240, or give the tpdo an `event` time; silent_status = true accepts that",
    "{0}: слово состояния (tpdo {1}, тип {2}) устройства {3} передаётся только по событию: молчание не "
    "отличить "
    "от потери. Возьмите тип 1-240 или задайте для tpdo `event`; silent_status = true снимает это "
    "требование"};
inline constexpr text::Entry kPdosTooLate{
    "machine.pdos_late",
    "bus {0}: the busiest cycle takes up to {1} %, so that {2}, due with every SYNC, would come a cycle late "
    "(the average of {3} % hides this). Use a longer cycle, or a lower PDO number for it",
    "шина {0}: самый загруженный цикл занимает до {1} %: {2}, нужный с каждым SYNC, опоздает на цикл (в "
    "среднем {3} %, и этого не видно). Поможет больший такт или меньший номер PDO"};

inline constexpr text::Entry kPdoNeverComes{"machine.pdo_never_comes",
                                            "tpdo {0}: with transmission {1} and no `event` it need never "
                                            "come, and its loss would not be seen: 1 to 240, or "
                                            "`event`",
                                            "tpdo {0}: при типе {1} без `event` он может не приходить, и его "
                                            "потеря не видна: нужен тип 1-240 или `event`"};
inline constexpr text::Entry kObjectOfPoints{
    "machine.object_of_points",
    "object {0}: `loss`, `hold` and `inverted` of the points say that; the control writes it at boot",
    "объект {0}: это задают `loss`, `hold` и `inverted` сигналов; управление записывает его при запуске"};
inline constexpr text::Entry kModbusBehindEnd{"machine.modbus_behind_end",
                                              "`{0}`: {1} from address {2} on end behind address 65535",
                                              "«{0}»: {1} начиная с адреса {2} выходят за адрес 65535"};
inline constexpr text::Entry kModbusOverlap{
    "machine.modbus_overlap",
    "digital inputs in the input registers {0} to {1} lie on the analog inputs {2} to {3}",
    "дискретные входы во входных регистрах {0}-{1} лежат на аналоговых входах {2}-{3}"};

}  // namespace servogate::machine::finding
