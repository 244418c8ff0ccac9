// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/402/controlword.hpp"
#include "firmware_if/image/drive_link.hpp"

namespace servogate::canopen::testing {

/// The state machine of CiA 402-2, figure "Power drive system finite state automaton", as a drive runs it.
struct DriveModel {
  image::DriveState state = image::DriveState::switch_on_disabled;
  std::uint16_t last = 0;
  image::DriveState refuses = image::DriveState::offline;  ///< never enters this state

  void step(std::uint16_t word) {
    const ControlCommand command = decode_command(word);
    const bool reset_edge = (word & 0x80) && !(last & 0x80);
    last = word;
    const image::DriveState next = reaction(command, reset_edge);
    if (next != refuses) state = next;
  }

  image::DriveState reaction(ControlCommand command, bool reset_edge) const {
    using C = ControlCommand;
    using S = image::DriveState;
    switch (state) {
      case S::not_ready_to_switch_on:
        return S::switch_on_disabled;
      case S::switch_on_disabled:
        return command == C::shutdown ? S::ready_to_switch_on : state;
      case S::ready_to_switch_on:
        if (command == C::switch_on || command == C::enable_operation) return S::switched_on;
        return command == C::shutdown ? state : S::switch_on_disabled;
      case S::switched_on:
        if (command == C::enable_operation) return S::operation_enabled;
        if (command == C::shutdown) return S::ready_to_switch_on;
        return command == C::switch_on ? state : S::switch_on_disabled;
      case S::operation_enabled:
        if (command == C::shutdown) return S::ready_to_switch_on;
        if (command == C::switch_on) return S::switched_on;
        if (command == C::quick_stop) return S::quick_stop_active;
        return command == C::disable_voltage ? S::switch_on_disabled : state;
      case S::quick_stop_active:
        return command == C::disable_voltage ? S::switch_on_disabled : state;
      case S::fault_reaction_active:
        return S::fault;
      case S::fault:
        return reset_edge ? S::switch_on_disabled : state;
      default:
        return state;
    }
  }
};

}  // namespace servogate::canopen::testing
