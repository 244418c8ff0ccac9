// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/process_image.hpp"
#include "kernel/program/reading/block.hpp"

namespace servogate::program {

/// What one block of words asks for, gathered before anything of it is executed.
struct BlockWords {
  const Block* block = nullptr;
  bool dwell = false, exact_once = false, machine_zero = false;
  bool counts_as_motion = false;              ///< modes of one block hold for it, though no axis is named
  bool tool_behind = false;                   ///< T acts behind the motion
  Function plane_behind = Function::nothing;  ///< plane that comes back behind the motion
  std::uint64_t one_shot = 0;                 ///< bit of each Function that holds for this block only
  Function then = Function::nothing;          ///< mode in force behind this block
  void (*instead)(Execution&, const BlockWords&) = nullptr;  ///< takes the place of the motion ...
  const Word* instead_word = nullptr;                        ///< ... and this word asks for it
  int cycle = 0;                                             ///< number of a G word that defines a cycle
  const Word *cycle_word = nullptr, *dwell_word = nullptr, *mark_word = nullptr;
  int axes = 0;
  std::array<const Word*, image::kMaxAxes> axis{};
  const Word *centre1 = nullptr, *centre2 = nullptr, *pitch = nullptr, *radius = nullptr, *radius2 = nullptr;
  const Word *feed = nullptr, *time = nullptr, *speed = nullptr, *tool = nullptr, *h = nullptr;
  const Word *corrector = nullptr, *count = nullptr, *angle = nullptr, *amount = nullptr;
  std::array<const Word*, 3> factor{};  ///< of the tool's radius, by axis
  bool has_factors = false;
  bool has_centres = false;                 ///< words of Meaning::centre_of
  bool for_instead = false;                 ///< words that only `instead` can take
  std::array<const Word*, 4> statements{};  ///< those that act at the end of the block
  int statement_count = 0;
  std::array<const Word*, 8> m{};
  std::array<int, 8> m_code{};
  int m_count = 0;
};

}  // namespace servogate::program
