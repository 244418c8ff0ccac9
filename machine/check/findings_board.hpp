// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Findings about boards and the axes on them.
namespace servogate::machine::finding {

inline constexpr text::Entry kAxisSource{
    "machine.axis_source",
    "{0}: an axis has either `drive`, a drive on a bus, or [axis.board], an amplifier on a board",
    "{0}: у оси либо `drive`, привод на шине, либо [axis.board], усилитель на плате"};
inline constexpr text::Entry kNoBoard{"machine.no_board",
                                      "{0}: there is no station of kind board called '{1}'",
                                      "{0}: нет станции вида board с именем «{1}»"};
inline constexpr text::Entry kChannelTwice{"machine.board_channel_twice",
                                           "{0}: channel {1} of board '{2}' is that of axis {3} already",
                                           "{0}: канал {1} платы «{2}» уже занят осью {3}"};
inline constexpr text::Entry kBoardKey{"machine.board_key", "{0}: `{1}` belongs to output {2}",
                                       "{0}: `{1}` бывает только при output {2}"};
inline constexpr text::Entry kBoardNeeds{"machine.board_needs", "{0}: output {1} needs `{2}`",
                                         "{0}: для output {1} нужен `{2}`"};
inline constexpr text::Entry kStepsFeedback{
    "machine.board_steps_feedback",
    "{0}: position by steps goes with output step alone: an amplifier of speed needs the encoder of the "
    "channel",
    "{0}: положение по шагам бывает только при output step: усилителю скорости нужен датчик канала"};
inline constexpr text::Entry kStepsCounts{"machine.board_steps_counts",
                                          "{0}: position by steps counts in steps: steps_per_rev is {1}, "
                                          "counts_per_rev {2}; leave steps_per_rev out",
                                          "{0}: положение по шагам считается в шагах: steps_per_rev {1}, "
                                          "counts_per_rev {2}; не указывайте steps_per_rev"};
inline constexpr text::Entry kStepRate{"machine.board_step_rate",
                                       "{0}: {1} need {2} steps/s; levels of {3} us permit {4} steps/s: take "
                                       "a smaller step_time, or fewer steps a turn",
                                       "{0}: для {1} нужно {2} шагов/с; уровни по {3} мкс допускают {4} "
                                       "шагов/с: уменьшите step_time или число шагов на "
                                       "оборот"};
inline constexpr text::Entry kFullSpeed{"machine.board_full_speed",
                                        "{0}: {1} are {2} rpm of the motor, and the full set-point gives {3} "
                                        "rpm: nothing is left for the position loop",
                                        "{0}: {1} — это {2} об/мин двигателя, а полное задание даёт {3} "
                                        "об/мин: для контура положения ничего не остаётся"};
inline constexpr text::Entry kGainTooHigh{
    "machine.board_gain",
    "{0}: position_gain {1} 1/s is not stable with a dead time of two cycles: at most {2} 1/s at this cycle "
    "time",
    "{0}: position_gain {1} 1/с неустойчив при запаздывании в два цикла: при этом цикле не больше {2} 1/с"};
inline constexpr text::Entry kNotOnBoard{
    "machine.not_on_board", "{0}: `{1}` needs a drive on a bus: an amplifier on a board has no such thing",
    "{0}: для `{1}` нужен привод на шине: у усилителя на плате этого нет"};
inline constexpr text::Entry kOpenLoop{"machine.board_open_loop",
                                       "{0}: nothing measures where the axis is (feedback steps): steps that "
                                       "the motor loses go unnoticed until it is homed again",
                                       "{0}: положение оси ничем не измеряется (feedback steps): потерянные "
                                       "шаги останутся незамеченными до выхода в ноль"};
inline constexpr text::Entry kBoardWatchdog{
    "machine.board_watchdog",
    "station '{0}': a watchdog of {1} ms is shorter than three cycles ({2} ms): it would drop everything "
    "without a fault",
    "станция «{0}»: сторожевой таймер {1} мс короче трёх циклов ({2} мс): он сработает без неисправности"};

}  // namespace servogate::machine::finding
