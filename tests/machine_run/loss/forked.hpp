// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

namespace servogate::machine_run {

/// Carries `work` out in a copy of this process, so that whatever it does to the state here has not happened.
/// What it returns, or that the copy broke down. Only while this process has one thread.
std::string in_copy(const std::function<std::string()>& work);

}  // namespace servogate::machine_run
