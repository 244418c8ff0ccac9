// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/drive/measurement/guard.hpp"
#include "gateway/command/bench/recorded_object.hpp"

/// A run in its directory: meta.json, samples.csv, report.html, bus.log. Not real-time safe.
namespace servogate::gateway::command {

/// Makes the directory. False: it is there already or cannot be made, which has been said.
bool make_run_directory(const std::string& path);
/// Writes what was measured, in the units of the command line (revolutions, N m), with the recorded objects
/// of the same cycles. False: said.
bool write_run(const std::string& path, const bench::Guard& guard, const ObjectRecorder& recorder,
               const nlohmann::json& meta);
/// The same of recorded objects alone, from row `first` on.
bool write_objects(const std::string& path, const ObjectRecorder& recorder, std::size_t first,
                   double period_s, const nlohmann::json& meta);

/// "travel", "speed" ...; why a run ended, for a program.
const char* trip_name(bench::Trip trip) noexcept;
/// The same for people, with value and limit in the units of the command line.
std::string trip_words(const bench::Guard& guard);

}  // namespace servogate::gateway::command
