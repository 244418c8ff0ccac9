// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "firmware_if/image/request.hpp"

/// Kinds of requests in sets, and who may ask for which. real-time safe.
namespace servogate::cycle::requests {

/// A set of kinds of requests, however many there come to be.
class Kinds {
 public:
  constexpr Kinds(std::initializer_list<image::RequestKind> kinds) noexcept {
    for (const image::RequestKind k : kinds) words_[word(k)] |= bit(k);
  }
  constexpr bool has(image::RequestKind k) const noexcept { return (words_[word(k)] & bit(k)) != 0; }
  constexpr Kinds operator|(const Kinds& other) const noexcept {
    Kinds all = *this;
    for (std::size_t w = 0; w < words_.size(); ++w) all.words_[w] |= other.words_[w];
    return all;
  }
  constexpr Kinds without(image::RequestKind k) const noexcept {
    Kinds rest = *this;
    rest.words_[word(k)] &= ~bit(k);
    return rest;
  }

 private:
  static constexpr std::size_t word(image::RequestKind k) { return static_cast<std::size_t>(k) / 64; }
  static constexpr std::uint64_t bit(image::RequestKind k) {
    return std::uint64_t{1} << (static_cast<unsigned>(k) % 64);
  }
  std::array<std::uint64_t, 256 / 64> words_{};  // a kind is one byte
};

using enum image::RequestKind;

inline constexpr Kinds kStops{hold, stop, quick_stop, jog_stop};
inline constexpr Kinds kJogs{jog_increment, jog_continuous, keep_alive};
inline constexpr Kinds kResets{reset, acknowledge};
inline constexpr Kinds kProgram{start, step, resume, mode, override_feed};
inline constexpr Kinds kPlaces{set_place, force, release_force, logic, logic_scan};
inline constexpr Kinds kPanel =
    kStops | kJogs | kResets | kProgram |
    Kinds{power, home, zero, assign, tables, reposition, retrace, function, path_wheel};
/// Of the auxiliary axes, the PLC's alone.
inline constexpr Kinds kMoves{move_absolute, move_relative, move_velocity, torque};
inline constexpr Kinds kAuxiliary = kMoves | Kinds{axis_power, axis_home, axis_stop, axis_reset};
inline constexpr Kinds kBegins =
    kJogs | kMoves |
    Kinds{home, start, step, resume, power, axis_power, axis_home, reposition, retrace, function, gear};

/// Never too old. Of these kinds a value of 0 only takes away: power off, an override of 0, a wheel that is
/// lost.
inline constexpr Kinds kTakesAway = kStops | Kinds{reset, axis_stop, axis_reset};
inline constexpr Kinds kTakesAwayAtZero{power, axis_power, override_feed, path_wheel, gear};

/// What speaks to a process. All else works on a machine that has none (a bench of drives) just as well.
inline constexpr Kinds kOfProcess =
    kProgram | Kinds{hold, zero, assign, reposition, retrace, function, path_wheel};
/// Whoever asks for them leads the program from then on, and not the wheel of its path.
inline constexpr Kinds kLeads{hold, stop, reset, start, step, resume, reposition, retrace, function};
/// What may bring its mode along.
inline constexpr Kinds kWithMode{home, jog_increment, jog_continuous, start, step};

/// Who may ask for what at all. Stops are everybody's right.
constexpr Kinds may_ask(image::Asker asker) noexcept {
  switch (asker) {
    case image::Asker::command_line:
    case image::Asker::page:
    case image::Asker::scenario:
      return kPanel | kPlaces;
    case image::Asker::pendant:
      return kPanel;
    case image::Asker::plc:
      return kPanel.without(zero) | kAuxiliary | Kinds{gear};
    case image::Asker::modbus:
      return kStops | Kinds{set_place};
    case image::Asker::program:
      return kStops | Kinds{start};
    case image::Asker::bench:
      return kStops | kJogs | kResets | kPlaces | Kinds{power, home};
  }
  return {};
}

}  // namespace servogate::cycle::requests
