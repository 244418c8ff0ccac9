// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/cli/options.hpp"

/// The commands of `servogate`; each returns its exit code.
namespace servogate::gateway::command {

int version(bool json);
/// `command_line`: its words, for the report.
int run(const RunOptions& options, const std::vector<std::string>& command_line);
int up(const UpOptions& options);
int client(const ClientOptions& options);
int check(const CheckOptions& options);
int canon(const CanonOptions& options);
int replay(const ReplayOptions& options);
int capture(const CaptureOptions& options);
int test(const TestOptions& options);
int backup(const BackupOptions& options);
int restore(const BackupOptions& options);
int can_bus(const CanBusOptions& options);
int can_check(const CanCheckOptions& options);
int can_restart(const CanRestartOptions& options);
int scan(const ScanOptions& options);
int sdo(const SdoOptions& options);
int od(const OdOptions& options);
int lss(const LssOptions& options);
int nmt(const NmtOptions& options);
int modbus_read(const ModbusOptions& options);
int modbus_write(const ModbusOptions& options);
int modbus_scan(const ModbusOptions& options);
/// `bench NAME`.
int bench(const std::string& name, const BenchCommands& options);
int pendant_list(const PendantOptions& options);
int pendant_watch(const PendantOptions& options);
int drive(const DriveOptions& options);
int io(const IoOptions& options);
int sim(const SimOptions& options);
int dump(const DumpOptions& options);
int play(const PlayOptions& options);

}  // namespace servogate::gateway::command
