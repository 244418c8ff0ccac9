// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// What a pendant's client has to say. {0} is the pendant.
namespace servogate::gateway::pendant_says {

inline constexpr text::Entry kCame{"pendant.came", "pendant '{0}' is here ({1})",
                                   "пульт «{0}» подключён ({1})"};
inline constexpr text::Entry kWent{
    "pendant.went", "pendant '{0}' is unplugged: what it jogged stops. Plug it in again; it is waited for",
    "пульт «{0}» отключён: движение от него останавливается. Подключите его снова; его ждут"};
inline constexpr text::Entry kWaits{"pendant.waits",
                                    "pendant '{0}' ({1}) is waited for; the machine works without it",
                                    "пульт «{0}» ({1}) ожидается; станок работает без него"};
inline constexpr text::Entry kLooked{"pendant.looked", "{0} ({1}) is waited for; Ctrl+C ends",
                                     "ожидается {0} ({1}); завершить — Ctrl+C"};
inline constexpr text::Entry kNotAllowed{
    "pendant.not-allowed",
    "pendant '{0}' may not be opened: {1}. Install 70-servogate.rules for udev and plug it in again",
    "пульт «{0}» нельзя открыть: {1}. Установите правила udev 70-servogate.rules и подключите его снова"};
inline constexpr text::Entry kGarbage{
    "pendant.garbage",
    "pendant '{0}' sends reports that device file '{1}' does not know ({2} so far): they move nothing, and "
    "what "
    "it jogged stops. Compare its buttons and its firmware with the file",
    "пульт «{0}» шлёт отчёты, которых нет в файле устройства «{1}» (уже {2}): они ничего не двигают, "
    "начатое им движение останавливается. Сверьте кнопки и прошивку пульта с файлом"};
inline constexpr text::Entry kRefused{"pendant.refused", "pendant '{0}': {1}", "пульт «{0}»: {1}"};

}  // namespace servogate::gateway::pendant_says
