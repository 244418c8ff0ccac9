// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/cyclictest.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace servogate::gateway::command {
namespace {

std::optional<double> figure(std::string_view line, std::string_view name) {
  const std::size_t at = line.find(name);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string rest(line.substr(at + name.size()));
  char* end = nullptr;
  const double value = std::strtod(rest.c_str(), &end);
  return end == rest.c_str() ? std::nullopt : std::optional(value);
}

}  // namespace

std::optional<CyclicTest> read_cyclictest(std::string_view output) {
  std::optional<CyclicTest> found;
  while (!output.empty()) {
    const std::size_t end = output.find('\n');
    const std::string_view line = output.substr(0, end);
    const auto min = figure(line, "Min:"), mean = figure(line, "Avg:"), max = figure(line, "Max:");
    if (min && mean && max) found = CyclicTest{*min, *mean, *max};
    if (end == std::string_view::npos) break;
    output.remove_prefix(end + 1);
  }
  return found;
}

std::optional<CyclicTest> run_cyclictest(double cycle_us, double seconds, int priority) {
  const long loops = std::lround(seconds * 1e6 / cycle_us);
  char command[160];
  std::snprintf(command, sizeof command, "cyclictest -m -q -t 1 -p %d -i %ld -l %ld 2>/dev/null </dev/null",
                priority, std::lround(cycle_us), loops);
  std::FILE* pipe = popen(command, "r");
  if (pipe == nullptr) return std::nullopt;
  std::string output;
  char part[512];
  for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) output.append(part, n);
  pclose(pipe);
  return read_cyclictest(output);
}

}  // namespace servogate::gateway::command
