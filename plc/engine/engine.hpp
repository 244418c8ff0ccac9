// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/time.hpp"
#include "firmware_if/text/finding.hpp"
#include "plc/terms/scan_result.hpp"
#include "plc/variables/lookup.hpp"

namespace servogate::plc {

struct Image;
class ScanWatch;
struct Transfer;

/// A variable and the value that it is held at, made outside the cycle.
struct Forcing {
  Handle handle;
  std::array<std::uint8_t, 512> bytes{};
  std::uint32_t size = 0;
};

/// A retained elementary variable: full name, type name, value as Engine::write reads it.
struct Retained {
  std::string name;
  std::string type;
  std::string value;

  bool operator==(const Retained&) const = default;
};

/// Runs a compiled program. One engine belongs to one thread (the cycle's); the functions that are not marked
/// real-time safe are for the same thread outside the cycle, or for tools.
///
///     auto result = plc::compile({{"mill.st", text}}, symbols);
///     plc::Engine engine(result.image);
///     const plc::ScanResult scan = engine.scan(image.packets, image.now.t_ns);
///     if (scan.fault != plc::Fault::none) raise(...);
class Engine {
 public:
  explicit Engine(std::shared_ptr<const Image> image);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// One scan at virtual time `t_ns`: takes the packet places in, forces, runs the tasks that are due in
  /// order of priority, forces, puts the places that the program writes back. Time never runs backwards.
  /// real-time safe.
  ScanResult scan(image::Packets& packets, image::Nanoseconds t_ns) noexcept;

  /// The fault that stopped the program, or Fault::none. real-time safe.
  ScanResult fault() const noexcept;
  /// The sentence of a fault with file and line, for people. Not real-time safe.
  text::Finding describe(const ScanResult& result) const;
  std::string_view task_name(int task) const noexcept;
  std::string_view file_name(int file) const noexcept;
  /// Cold start: all variables take their initial values (retained ones too), faults are gone; forces stay.
  /// Not real-time safe.
  void restart();

  /// A variable by name without case: "Program.name", "Program.instance.member", "Program.list[3]", a global,
  /// a symbol of the machine ("NC.m_strobe"); a bare name when there is one single program. nullopt: no such
  /// variable. Not real-time safe.
  std::optional<Handle> find(std::string_view name) const;
  /// Name of the variable's type. Not real-time safe.
  std::string type_name(const Handle& handle) const;
  /// Value as JSON: true, -5, 1.25, "T#1s500ms", "text", enumeration by name, arrays and structures as such.
  /// Not real-time safe.
  std::string read(const Handle& handle) const;
  /// Numeric value (BOOL 0 or 1, times in nanoseconds, enumerations by number), NaN for what is no number.
  /// real-time safe.
  double number(const Handle& handle) const noexcept;
  /// The bytes of a variable as plc::to_json and plc::to_number take them. real-time safe.
  const std::uint8_t* data(const Handle& handle) const noexcept;
  /// Writes a value given as an IEC literal (`TRUE`, `-5`, `16#FF`, `T#30ms`, `Red`, `'text'`) or as plain
  /// text for a STRING. The value stays until logic or another write changes it; a variable that mirrors a
  /// packet place is written in the packet. False: not an elementary variable, or the text is no value of its
  /// type. Not real-time safe.
  bool write(image::Packets& packets, const Handle& handle, std::string_view text);
  /// The same with a number; it must fit. real-time safe.
  bool set_number(image::Packets& packets, const Handle& handle, double value) noexcept;

  /// Holds an elementary variable at a value before and after every scan, whatever logic writes. At most
  /// kMaxForces at once. False as for write(), or when the table is full. Not real-time safe.
  bool force(const Handle& handle, std::string_view text);
  void release(const Handle& handle);
  void release_all();
  /// The same in two steps: the first outside the cycle, the second real-time safe; false: the table is full.
  std::optional<Forcing> prepare_force(const Handle& handle, std::string_view text) const;
  bool apply(const Forcing& forcing) noexcept;
  /// real-time safe.
  void release_now(const Handle& handle) noexcept;
  void release_all_now() noexcept;
  /// Names and values of all forced variables. Not real-time safe.
  std::vector<std::pair<std::string, std::string>> forced() const;
  static constexpr std::size_t kMaxForces = 256;

  /// Bytes of all VAR RETAIN together, for a snapshot taken in the cycle. real-time safe.
  std::size_t retain_bytes() const noexcept;
  /// Copies the retained variables. False when `out` is smaller than retain_bytes(). real-time safe.
  bool snapshot_retained(std::span<std::uint8_t> out) const noexcept;
  /// The retained variables of such a snapshot, by name and type. Not real-time safe.
  std::vector<Retained> retained(std::span<const std::uint8_t> snapshot) const;
  /// The present values. Not real-time safe.
  std::vector<Retained> retained() const;
  /// Takes over every value whose name and type still exist; returns how many. Before the first scan; a
  /// place of a packet gets its value with it. Not real-time safe.
  std::size_t restore(std::span<const Retained> values);

  /// Takes over what was planned from the engine that ran before; instead of a first scan of its own, or
  /// before it. real-time safe: moves bytes only. `transfer` was planned for these two programs, and
  /// prepare_transfer() has seen it.
  void take_over(const Engine& before, const Transfer& transfer) noexcept;
  /// Makes room for it; once, behind restore(). Not real-time safe.
  void prepare_transfer(const Transfer& transfer);

  /// Who may end its scans; one watch for all engines that take turns in a cycle. Without one nobody can.
  /// Before the first scan.
  void watch(ScanWatch* watch) noexcept;
  /// Measures every task with this clock, nullptr: none. Before the first scan.
  void measure(const image::Clock* clock) noexcept;
  /// In the next scans also every call of a block, into one entry of `blocks` for each Image::units; nullptr:
  /// no more. real-time safe.
  void profile(Times* blocks) noexcept;
  /// By task. real-time safe.
  std::span<const Times> task_times() const noexcept;

  const Image& image() const noexcept { return *image_; }

 private:
  std::string name_of(const Handle& handle) const;
  // The parts of a scan, real-time safe.
  void take_inputs(image::Packets& packets) noexcept;
  bool due(std::size_t index, image::Nanoseconds t_ns) noexcept;
  ScanResult run_tasks(image::Nanoseconds t_ns) noexcept;
  void give_outputs(image::Packets& packets) noexcept;
  void drop_outputs(image::Packets& packets) noexcept;
  struct State;
  std::shared_ptr<const Image> image_;
  std::unique_ptr<State> state_;
};

}  // namespace servogate::plc
