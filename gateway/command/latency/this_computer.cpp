// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/this_computer.hpp"

#include <fstream>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway::command {
namespace {

using text::both;

/// The first line of a file; "": there is none.
std::string line_of(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

}  // namespace

Fit fit_of(std::int64_t worst, std::int64_t cycle) noexcept {
  return 5 * worst <= cycle ? Fit::good : 2 * worst <= cycle ? Fit::doubtful : Fit::no;
}

const char* fit_name(Fit fit) noexcept {
  return fit == Fit::good ? "good" : fit == Fit::doubtful ? "doubtful" : "no";
}

// Sources: Documentation/admin-guide/kernel-parameters.rst, pm/cpufreq.rst and scheduler/sched-rt-group.rst
// of Linux.
std::vector<Advice> advice_for(const std::string& root) {
  std::vector<Advice> out;
  if (line_of(root + "/sys/kernel/realtime") != "1")
    out.push_back({both("the kernel is not PREEMPT_RT", "ядро без PREEMPT_RT"),
                   both("install a real-time kernel: on Debian `apt install linux-image-rt-amd64`",
                        "установите ядро реального времени: в Debian `apt install linux-image-rt-amd64`")});
  const std::string governor = line_of(root + "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (!governor.empty() && governor != "performance")
    out.push_back({both("the processor changes its frequency (" + governor + ")",
                        "процессор меняет частоту (" + governor + ")"),
                   "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"});
  if (line_of(root + "/sys/devices/system/cpu/isolated").empty())
    out.push_back(
        {both("no processor is kept free for the cycle", "ни один процессор не выделен для цикла"),
         both("boot with isolcpus=N nohz_full=N and set [realtime] cpu = N in the machine file",
              "загрузите ядро с isolcpus=N nohz_full=N и задайте в файле станка [realtime] cpu = N")});
  const std::string runtime = line_of(root + "/proc/sys/kernel/sched_rt_runtime_us");
  if (!runtime.empty() && runtime != "-1")
    out.push_back({both("real-time threads are held back (sched_rt_runtime_us = " + runtime + ")",
                        "потоки реального времени ограничиваются (sched_rt_runtime_us = " + runtime + ")"),
                   "sudo sysctl kernel.sched_rt_runtime_us=-1"});
  const std::string source =
      line_of(root + "/sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (source == "hpet" || source == "acpi_pm")
    out.push_back(
        {both("the clock is slow (" + source + ")", "часы медленные (" + source + ")"),
         both("use the clock of the processor: boot with clocksource=tsc tsc=reliable, if it is steady",
              "используйте часы процессора: clocksource=tsc tsc=reliable, если они устойчивы")});
  if (line_of(root + "/sys/devices/system/cpu/smt/active") == "1")
    out.push_back({both("two threads share a core (SMT)", "два потока делят ядро (SMT)"),
                   both("switch it off in the firmware, or boot with nosmt",
                        "отключите в BIOS или загрузите с nosmt")});
  return out;
}

}  // namespace servogate::gateway::command
