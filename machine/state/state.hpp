// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "kernel/program/execution/state/machine.hpp"

namespace servogate::machine {

/// Result of homing an axis, for drives with absolute encoders and for the commissioning record.
struct HomingRecord {
  bool valid = false;
  std::int64_t offset_counts = 0;  ///< drive counts at machine coordinate 0
  double switch_to_index =
      0.0;  ///< mm from the switch edge to the index: near 0 or a whole turn is a bad adjustment
  bool operator==(const HomingRecord&) const = default;
};

/// One retained PLC variable, kept by name and type; the same three as plc::Retained.
struct RetainedVariable {
  std::string name;   ///< "Mill.tool_in_spindle"
  std::string type;   ///< IEC 61131-3 name: "DINT"
  std::string value;  ///< as plc::Engine::read writes it
  bool operator==(const RetainedVariable&) const = default;
};

/// What the machine learns and the operator enters; the machine file is never rewritten.
struct MachineState {
  program::Tables tables;                        ///< origins and correctors in mm, record files
  std::map<std::string, HomingRecord> homing;    ///< by axis letter
  std::map<std::string, std::int64_t> counters;  ///< "power_on_s", "parts", "X.distance_mm" ...
  std::map<std::string, double> gains;           ///< "X.position_gain" ... found by the bench
  std::int32_t tool_in_spindle = 0;
  std::vector<RetainedVariable> retained;
  std::int64_t retained_generation = 0;  ///< number of the copy that they come from, 0: none was ever written
};

/// The parts of the state, one file each: NAME.toml, readable, `schema = 1`, with a checksum in its head.
enum class StatePart : std::uint8_t { origins, tools, homing, counters, gains, records, retained };

/// A state directory. Files are written whole (temporary file, fsync, rename, fsync of the folder); the
/// generation before stays as NAME.previous.toml and is taken when the newest is damaged. The retained
/// variables, written again and again, have two copies instead, retained.a.toml and retained.b.toml, which
/// take turns and carry the number of their generation; the newest whole one counts. Not real-time safe.
class StateDirectory {
 public:
  /// `axes`: letters of the machine, which its tables may name; empty: any.
  explicit StateDirectory(std::string path, std::vector<std::string> axes = {});

  struct Loaded {
    MachineState state;
    std::vector<text::Finding>
        findings;  ///< damaged files (warning when the previous one is taken, else error)
    bool ok() const;
    /// Something was damaged, and a copy from before is taken.
    bool fell_back() const;
  };
  /// Reads all parts. A missing folder or file is an empty part and no finding. Origins and tools may be
  /// edited by people: an edit is taken with a warning, or refused by errors with their places and left as it
  /// is. Any other part that a person edited says `checksum = "none"` and is taken with a warning.
  Loaded load() const;
  /// The origins, tools and record files alone; what is wrong with them is added to `findings`.
  program::Tables load_tables(std::vector<text::Finding>& findings) const;
  /// Writes one part, creating the folder (owner only). False: `error` holds the system's words. Retained
  /// variables go into the copy that state.retained_generation chooses; it must be greater than the one that
  /// load() gave, by one.
  bool save(const MachineState& state, StatePart part, std::string& error) const;
  /// Writes all parts but the retained variables, which have a writer of their own.
  bool save_all(const MachineState& state, std::string& error) const;
  /// Path of a part's file.
  std::string file(StatePart part) const;
  /// Path of the copy that holds a generation of the retained variables.
  std::string retained_file(std::int64_t generation) const;

 private:
  std::string path_;
  std::vector<std::string> axes_;
};

/// The file of one part as text, and back; for tests and for showing.
std::string write_part(const MachineState& state, StatePart part);
/// Findings name `file`; on an error the part in `state` is unchanged. `axes` as for
/// StateDirectory.
std::vector<text::Finding> read_part(std::string_view text, const std::string& file, StatePart part,
                                     MachineState& state, const std::vector<std::string>& axes = {});

}  // namespace servogate::machine
