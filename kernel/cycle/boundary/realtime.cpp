// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/boundary/realtime.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::cycle {

namespace {

/// The command that gives this very program its rights; quoted where the shell would take its path apart.
std::string grant() {
  std::error_code error;
  std::string program = std::filesystem::read_symlink("/proc/self/exe", error).string();
  if (error) program = "servogate";
  if (program.find_first_of(" \t'\"\\$&;()<>|*?`") != std::string::npos) {
    for (std::size_t at = 0; (at = program.find('\'', at)) != std::string::npos; at += 4)
      program.replace(at, 1, "'\\''");
    program = "'" + program + "'";
  }
  return "sudo setcap cap_sys_nice,cap_ipc_lock=ep " + program;
}

void prefault_stack() {
  constexpr std::size_t kBytes = 256 * 1024;
  volatile unsigned char pages[kBytes];
  for (std::size_t i = 0; i < kBytes; i += 4096) pages[i] = 0;
  (void)pages[0];
}

}  // namespace

RealtimeThread::RealtimeThread(const RealtimeSettings& settings) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    refusals_.push_back(
        {text::both("locked memory", "закрепление памяти"), text::words_of(errno), grant(), true});
  prefault_stack();
  if (settings.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(settings.cpu), &set);
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set); error != 0)
      refusals_.push_back(
          {text::both("processor " + std::to_string(settings.cpu),
                      "процессор " + std::to_string(settings.cpu)),
           text::words_of(error),
           text::both("set [realtime] cpu in the machine file to one that `nproc --all` knows",
                      "задайте в файле станка [realtime] cpu из тех, что знает `nproc --all`"),
           true});
  }
  sched_param param{};
  param.sched_priority = settings.priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &param); error != 0)
    refusals_.push_back({text::both("SCHED_FIFO priority " + std::to_string(settings.priority),
                                    "SCHED_FIFO с приоритетом " + std::to_string(settings.priority)),
                         text::words_of(error), grant(), true});
  latency_file_ = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t zero = 0;
  if (latency_file_ < 0 || write(latency_file_, &zero, sizeof zero) != sizeof zero)
    refusals_.push_back(
        {"/dev/cpu_dma_latency", text::words_of(errno), "sudo chmod o+w /dev/cpu_dma_latency", false});
}

RealtimeThread::~RealtimeThread() {
  if (latency_file_ >= 0) close(latency_file_);
}

bool RealtimeThread::granted() const {
  return std::none_of(refusals_.begin(), refusals_.end(), [](const RealtimeRefusal& r) { return r.needed; });
}

}  // namespace servogate::cycle
