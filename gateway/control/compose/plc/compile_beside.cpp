// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/plc/compile_beside.hpp"

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "firmware_if/text/units.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kTooLong{"plc.compiles-too-long",
                           "the program was given up: compiling it took longer than {0} s",
                           "компиляция прервана: она заняла больше {0} с"};
const text::Entry kStillCompiles{
    "plc.still-compiles",
    "a program that was given up is still being compiled: try again later, or start the control anew",
    "прерванная программа всё ещё компилируется: повторите позже или перезапустите управление"};

std::atomic<int> given_up{0};

struct Shared {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::stop_source end;  ///< of the compiler, when it was given up
  bool done = false, given_up = false;
  plc::CompileResult result;
};

plc::CompileResult refused(const std::string& file, const text::Entry& entry,
                           std::vector<std::string> arguments) {
  plc::CompileResult result;
  result.findings.push_back({text::Severity::error, file, 1, 1, &entry, std::move(arguments)});
  return result;
}

}  // namespace

bool compiles_on() noexcept { return given_up.load() > 0; }

plc::CompileResult compile_beside(std::vector<plc::SourceFile> files, std::vector<image::Symbol> symbols,
                                  const plc::Options& options, const std::stop_token& stop,
                                  std::chrono::milliseconds patience) {
  const std::string first = files.empty() ? std::string() : files.front().name;
  if (compiles_on()) return refused(first, kStillCompiles, {});
  const auto shared = std::make_shared<Shared>();
  plc::Options ended = options;
  ended.stop = [end = shared->end.get_token()] { return end.stop_requested(); };
  std::thread([shared, ended, files = std::move(files), symbols = std::move(symbols)]() mutable {
    plc::CompileResult result = plc::compile(std::move(files), std::move(symbols), ended);
    const std::scoped_lock lock(shared->mutex);
    shared->result = std::move(result);
    shared->done = true;
    if (shared->given_up) --given_up;
    shared->wake.notify_all();
  }).detach();
  std::unique_lock lock(shared->mutex);
  shared->wake.wait_for(lock, stop, patience, [&] { return shared->done; });
  if (shared->done) return std::move(shared->result);
  shared->given_up = true;
  shared->end.request_stop();
  ++given_up;
  if (stop.stop_requested()) return {};
  return refused(first, kTooLong, {text::number(static_cast<double>(patience.count()) / 1000.0, 1)});
}

}  // namespace servogate::gateway
