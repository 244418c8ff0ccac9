// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "plc/types/type.hpp"

/// The instructions of the machine: three addresses into one memory, no registers, no stack of values. Every
/// instruction exists twice: the plain form takes addresses as they are, the other adds the running
/// instance's own address where bit 31 of an operand is set.
namespace servogate::plc::vm {

// One row for each cell, in the order of plc::Cell; a group's code for a cell is its first code plus the
// cell.
#define PLC_INTEGER_CELLS(M, op) \
  M(op, i8, std::int8_t)         \
  M(op, i16, std::int16_t)       \
  M(op, i32, std::int32_t)       \
  M(op, i64, std::int64_t)       \
  M(op, u8, std::uint8_t) M(op, u16, std::uint16_t) M(op, u32, std::uint32_t) M(op, u64, std::uint64_t)
#define PLC_NUMBER_CELLS(M, op) PLC_INTEGER_CELLS(M, op) M(op, f32, float) M(op, f64, double)
#define PLC_WIDTHS(M, op) \
  M(op, w1, std::uint8_t) M(op, w2, std::uint16_t) M(op, w4, std::uint32_t) M(op, w8, std::uint64_t)

// BINARY: a := b op c. UNARY: a := op b. SINGLE: one code.
#define PLC_CODES(BINARY, DIVIDE, UNARY, BITWISE, MOVE, INDEX, CHECK, SINGLE) \
  PLC_NUMBER_CELLS(BINARY, add)                                               \
  PLC_NUMBER_CELLS(BINARY, sub)                                               \
  PLC_NUMBER_CELLS(BINARY, mul)                                               \
  PLC_NUMBER_CELLS(DIVIDE, div)                                               \
  PLC_INTEGER_CELLS(DIVIDE, mod)                                              \
  PLC_NUMBER_CELLS(BINARY, min)                                               \
  PLC_NUMBER_CELLS(BINARY, max)                                               \
  PLC_NUMBER_CELLS(BINARY, eq)                                                \
  PLC_NUMBER_CELLS(BINARY, ne)                                                \
  PLC_NUMBER_CELLS(BINARY, lt)                                                \
  PLC_NUMBER_CELLS(BINARY, le)                                                \
  PLC_NUMBER_CELLS(UNARY, neg)                                                \
  PLC_NUMBER_CELLS(UNARY, abs)                                                \
  PLC_WIDTHS(BITWISE, and)                                                    \
  PLC_WIDTHS(BITWISE, or)                                                     \
  PLC_WIDTHS(BITWISE, xor)                                                    \
  PLC_WIDTHS(UNARY, not )                                                     \
  PLC_WIDTHS(MOVE, move)                                                      \
  PLC_WIDTHS(MOVE, load)                                                      \
  PLC_WIDTHS(MOVE, store)                                                     \
  PLC_INTEGER_CELLS(INDEX, index_at)                                          \
  PLC_INTEGER_CELLS(INDEX, index_add)                                         \
  PLC_INTEGER_CELLS(CHECK, check)                                             \
  SINGLE(index_open)                                                          \
  SINGLE(not_bool)                                                            \
  SINGLE(move_bytes)                                                          \
  SINGLE(load_bytes)                                                          \
  SINGLE(store_bytes)                                                         \
  SINGLE(move_text)                                                           \
  SINGLE(move_wide_text)                                                      \
  SINGLE(address)                                                             \
  SINGLE(check_reference)                                                     \
  SINGLE(load_bit)                                                            \
  SINGLE(store_bit)                                                           \
  SINGLE(jump)                                                                \
  SINGLE(jump_back)                                                           \
  SINGLE(jump_true)                                                           \
  SINGLE(jump_false)                                                          \
  SINGLE(repeat_until)                                                        \
  SINGLE(for_check)                                                           \
  SINGLE(for_next)                                                            \
  SINGLE(call)                                                                \
  SINGLE(call_at)                                                             \
  SINGLE(ret)                                                                 \
  SINGLE(extra)                                                               \
  SINGLE(native)

enum class Code : std::uint16_t {
#define PLC_TYPED(op, cell, type) op##_##cell,
#define PLC_SINGLE(op) op,
  PLC_CODES(PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_SINGLE)
#undef PLC_TYPED
#undef PLC_SINGLE
      count
};

/// The code of a group for a cell; `first` is the group's code for i8 (numbers) or w1 (widths).
constexpr Code code_for(Code first, Cell cell) noexcept {
  return static_cast<Code>(static_cast<int>(first) + static_cast<int>(cell));
}
constexpr Code code_for_width(Code first, std::uint32_t bytes) noexcept {
  return static_cast<Code>(static_cast<int>(first) + (bytes == 1 ? 0 : bytes == 2 ? 1 : bytes == 4 ? 2 : 3));
}

inline constexpr std::uint32_t kInstanceFlag = 0x8000'0000u;
inline constexpr int kMaxCallDepth = 120;

/// 16 bytes. `op` is twice the code, plus 1 for the form with instance addresses.
struct Instruction {
  std::uint16_t op = 0;
  std::uint16_t aux = 0;
  std::uint32_t a = 0, b = 0, c = 0;
};

}  // namespace servogate::plc::vm
