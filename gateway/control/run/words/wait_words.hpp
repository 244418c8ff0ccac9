// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "gateway/control/compose/control.hpp"

namespace servogate::gateway {

/// What a process waits for, in words and figures: what `status`, `alarms`, `run` and the report say alike.
struct WaitWords {
  std::string_view reason;  ///< "signal", "m_acknowledge", "feed_enable" ...
  std::string text;  ///< "line 22 of bracket.nc: the program waits until door_closed (SA16.BL) = 1; it is 0"
  std::string remedy;  ///< who has to do what; empty: it ends by itself
  std::string file;    ///< as it was opened; empty: not known
  int line = 0;
  double since_s = 0.0;  ///< machine time at which the wait began
  double for_s = 0.0;    ///< and how long it has lasted
  // Where they apply, else empty:
  std::string place, symbol;     ///< "SA16.BL", "door_closed"
  std::string_view written_by;   ///< "input", "plc", "nc", "program", "operator"
  std::string_view compare;      ///< "=", "<>" ...
  std::optional<double> wanted;  ///< value that `place` is to have
  std::optional<double> actual;  ///< the one that it has
  std::string axis;              ///< letter
  std::string word;              ///< "M6", "S900", "T5", "H3"
};

/// The wait of process `process` (from 0) in this image; nullopt: it waits for nothing. Not for the cycle.
std::optional<WaitWords> wait_words(Control& control, const image::ProcessImage& image, int process,
                                    text::Language language);
/// `wait` as the image holds it, in the words of a moment at which `image` may already hold another one.
WaitWords wait_words(Control& control, const image::ProcessImage& image, int process, const image::Wait& wait,
                     text::Language language);

/// Somebody else has to act before the program goes on: neither a time that runs out nor a time-out ends it.
bool needs_somebody(image::WaitReason reason) noexcept;

/// The machine's PLC sources, as a list for a sentence.
std::string plc_sources(const machine::MachineConfig& machine);
/// What to do so that `symbol` becomes TRUE (`named`: the place as people read it), by who writes it;
/// nullptr: nobody is named.
std::string writer_remedy(const machine::MachineConfig& machine, const image::Symbol* symbol,
                          const std::string& named, text::Language language);

/// The last message of the program (NC-110 DIS) that process `process` has reached; empty: none.
std::string program_message(Control& control, const image::ProcessImage& image, int process);

}  // namespace servogate::gateway
