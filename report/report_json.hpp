// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "report/report.hpp"

namespace servogate::report {

/// The report as a JSON value, for the page that carries it along. Only for this room's .cpp files.
nlohmann::ordered_json json_of(const Report& report, text::Language language);

}  // namespace servogate::report
