// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plc/vm/image.hpp"

namespace servogate::plc {

/// What a program takes over from the one that it replaces, made before the change: moves of bytes and
/// nothing else, so that the change itself fits between two scans.
struct Transfer {
  struct Move {
    std::uint32_t from = 0, to = 0, size = 0;
  };
  struct PlaceMove {
    std::uint32_t from = 0;   ///< address in the old memory
    std::uint32_t place = 0;  ///< index of the new Image::places
    std::uint32_t size = 0;
  };
  bool running = false;  ///< an online change: every variable, edges and tasks go on
  std::vector<Move> moves;
  std::vector<PlaceMove> places;  ///< retained places, which the next scan would take from the packet
  std::vector<std::pair<std::uint32_t, std::uint32_t>> tasks;  ///< old and new index of tasks that go on
  std::size_t kept = 0;                                        ///< variables of elementary type
  std::vector<std::string> fresh;     ///< variables that begin with their initial value
  std::vector<std::string> given_up;  ///< variables of the old program whose value goes
};

/// Plans the change from one program to another. A value passes where name and type are the same; constants
/// are those of the new program. `all`: every variable (online change), otherwise the retained ones only.
/// Not real-time safe.
Transfer plan_transfer(const Image& from, const Image& to, bool all);

}  // namespace servogate::plc
