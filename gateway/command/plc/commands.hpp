// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/cli/plc_options.hpp"

/// The commands of `servogate plc`; each returns its exit code.
namespace servogate::gateway::command {

int plc_run(const PlcRunOptions& options);
int plc_check(const PlcCheckOptions& options);
int plc_test(const PlcTestOptions& options);
int plc_list(const PlcListOptions& options);
int plc_watch(const PlcWatchOptions& options);
int plc_step(const PlcStepOptions& options);
int plc_force(const PlcForceOptions& options);
int plc_load(const PlcLoadOptions& options);

}  // namespace servogate::gateway::command
