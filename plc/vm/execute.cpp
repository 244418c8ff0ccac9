// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "plc/vm/machine.hpp"

// Labels as values: one indirect jump at the end of each instruction, which the branch predictor learns
// apart, is what makes the machine fast. GCC and Clang both have them.
#pragma GCC diagnostic ignored "-Wpedantic"

namespace servogate::plc::vm {

namespace {

template <typename T>
inline T get(const std::uint8_t* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <typename T>
inline void put(std::uint8_t* p, T v) noexcept {
  std::memcpy(p, &v, sizeof v);
}

// Integers wrap; 64 bits are enough for the product of all narrower ones.
template <typename T>
using Wide = std::conditional_t<std::is_integral_v<T>, std::uint64_t, T>;

struct Add {
  template <typename T>
  static T of(T a, T b) noexcept {
    return static_cast<T>(static_cast<Wide<T>>(a) + static_cast<Wide<T>>(b));
  }
};
struct Sub {
  template <typename T>
  static T of(T a, T b) noexcept {
    return static_cast<T>(static_cast<Wide<T>>(a) - static_cast<Wide<T>>(b));
  }
};
struct Mul {
  template <typename T>
  static T of(T a, T b) noexcept {
    return static_cast<T>(static_cast<Wide<T>>(a) * static_cast<Wide<T>>(b));
  }
};
struct Min {
  template <typename T>
  static T of(T a, T b) noexcept {
    return b < a ? b : a;
  }
};
struct Max {
  template <typename T>
  static T of(T a, T b) noexcept {
    return b > a ? b : a;
  }
};
struct Eq {
  template <typename T>
  static std::uint8_t of(T a, T b) noexcept {
    return a == b;
  }
};
struct Ne {
  template <typename T>
  static std::uint8_t of(T a, T b) noexcept {
    return a != b;
  }
};
struct Lt {
  template <typename T>
  static std::uint8_t of(T a, T b) noexcept {
    return a < b;
  }
};
struct Le {
  template <typename T>
  static std::uint8_t of(T a, T b) noexcept {
    return a <= b;
  }
};
struct Neg {
  template <typename T>
  static T of(T a) noexcept {
    if constexpr (std::is_integral_v<T>)
      return static_cast<T>(0 - static_cast<std::uint64_t>(a));
    else
      return -a;
  }
};
struct Abs {
  template <typename T>
  static T of(T a) noexcept {
    if constexpr (std::is_floating_point_v<T>)
      return std::abs(a);
    else
      return a < T{0} ? Neg::of(a) : a;
  }
};
struct Not {
  template <typename T>
  static T of(T a) noexcept {
    return static_cast<T>(~a);
  }
};

// False: division by zero. The least integer divided by -1 wraps to itself.
template <typename T>
inline bool divide(T a, T b, T& out) noexcept {
  if (b == T{0}) return false;
  if constexpr (std::is_signed_v<T> && std::is_integral_v<T>)
    out = b == T{-1} ? Neg::of(a) : static_cast<T>(a / b);
  else
    out = static_cast<T>(a / b);
  return true;
}
template <typename T>
inline T remainder(T a, T b) noexcept {  // IEC 61131-3: MOD by zero is zero
  if (b == T{0}) return T{0};
  if constexpr (std::is_signed_v<T>)
    if (b == T{-1}) return T{0};
  return static_cast<T>(a % b);
}

// The counter of a FOR loop: value, limit and step, beside the variable that shows it.
struct Counter {
  std::int64_t value, limit, step;
  bool within() const noexcept { return step >= 0 ? value <= limit : value >= limit; }
};
inline void show(const Counter& c, std::uint8_t* variable, Cell cell) noexcept {
  const std::uint32_t bytes = cell_size(cell);
  if (bytes < 8) {
    const bool is_signed = cell <= Cell::i64;
    const int bits = static_cast<int>(bytes) * 8 - (is_signed ? 1 : 0);
    const std::int64_t high = (std::int64_t{1} << bits) - 1, low = is_signed ? -high - 1 : 0;
    if (c.value < low || c.value > high) return;
  }
  // ULINT counts moved down by 2^63, so that the order is that of a signed number.
  const std::int64_t shown = cell == Cell::u64 ? c.value ^ std::numeric_limits<std::int64_t>::min() : c.value;
  std::memcpy(variable, &shown, bytes);
}

struct Frame {
  std::uint32_t back;
  std::uint32_t instance;
};

/// Times of the calls under way, beside the frames; only in a scan that is profiled.
struct Profile {
  std::int64_t began[kMaxCallDepth + 2];
  std::int32_t unit[kMaxCallDepth + 2];

  void enter(const Machine& m, int depth, std::uint32_t entry) noexcept {
    unit[depth] = -1;
    for (std::size_t u = 0; u < m.image->units.size(); ++u)
      if (m.image->units[u].entry == entry && m.image->units[u].reached)
        unit[depth] = static_cast<std::int32_t>(u);
    began[depth] = m.clock->now_ns();
  }
  void leave(const Machine& m, int depth) noexcept {
    if (unit[depth] >= 0) m.blocks[unit[depth]].add(m.clock->now_ns() - began[depth]);
  }
};

}  // namespace

namespace {

template <bool kProfiled>
Fault run(Machine& m, std::uint32_t entry) noexcept {
  static const void* const table[] = {
#define PLC_TYPED(op, cell, type) &&op##_##cell##_g, &&op##_##cell##_x,
#define PLC_SINGLE(op) &&op##_g, &&op##_x,
      PLC_CODES(PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_TYPED, PLC_SINGLE)
#undef PLC_TYPED
#undef PLC_SINGLE
  };
  const Instruction* const code = m.image->code.data();
  const Image::Bounds* const bounds = m.image->bounds.data();
  std::uint8_t* const mem = m.memory;
  const Instruction* ip = code + entry;
  std::uint8_t* self = mem;
  Frame frames[kMaxCallDepth + 2];
  [[maybe_unused]] std::conditional_t<kProfiled, Profile, char> profile;
  int depth = 0;
  Fault fault = Fault::none;

#define DISPATCH() goto* table[ip->op]
#define NEXT()  \
  do {          \
    ++ip;       \
    DISPATCH(); \
  } while (false)
#define PLAIN(x) (mem + (x))
#define MIXED(x) (((x)&kInstanceFlag) != 0 ? self + ((x) & ~kInstanceFlag) : mem + (x))
#define FAIL(what)  \
  do {              \
    fault = (what); \
    goto failed;    \
  } while (false)

// What may be executed before anybody looks again: paid for before it is done, and whoever watches from
// outside is obeyed. A jump to itself repeats one instruction.
#define CHARGE(instructions)                                                      \
  do {                                                                            \
    if ((m.budget -= (instructions)) < 0) FAIL(Fault::budget);                    \
    if (m.ended->load(std::memory_order_relaxed) == m.scan) FAIL(Fault::overrun); \
  } while (false)
#define CHARGE_BACK() CHARGE(ip - (code + ip->c) + 1)

  DISPATCH();

#define BINARY_CLASS_add Add
#define BINARY_CLASS_sub Sub
#define BINARY_CLASS_mul Mul
#define BINARY_CLASS_min Min
#define BINARY_CLASS_max Max
#define BINARY_CLASS_eq Eq
#define BINARY_CLASS_ne Ne
#define BINARY_CLASS_lt Lt
#define BINARY_CLASS_le Le
#define UNARY_CLASS_neg Neg
#define UNARY_CLASS_abs Abs
#define UNARY_CLASS_not Not
#define DO_BINARY(op, cell, T, F, AT)                                                                 \
  op##_##cell##_##F : put(AT(ip->a), BINARY_CLASS_##op::of<T>(get<T>(AT(ip->b)), get<T>(AT(ip->c)))); \
  NEXT();
#define PLC_BINARY(op, cell, T) DO_BINARY(op, cell, T, g, PLAIN) DO_BINARY(op, cell, T, x, MIXED)
#define DO_UNARY(op, cell, T, F, AT)                                              \
  op##_##cell##_##F : put(AT(ip->a), UNARY_CLASS_##op::of<T>(get<T>(AT(ip->b)))); \
  NEXT();
#define PLC_UNARY(op, cell, T) DO_UNARY(op, cell, T, g, PLAIN) DO_UNARY(op, cell, T, x, MIXED)
#define OPERATOR_and &
#define OPERATOR_or |
#define OPERATOR_xor ^
#define DO_BITWISE(op, cell, T, F, AT)                                                                   \
  op##_##cell##_##F : put(AT(ip->a), static_cast<T>(get<T>(AT(ip->b)) OPERATOR_##op get<T>(AT(ip->c)))); \
  NEXT();
#define PLC_BITWISE(op, cell, T) DO_BITWISE(op, cell, T, g, PLAIN) DO_BITWISE(op, cell, T, x, MIXED)
#define DIVIDE_div(T, AT)                                                                     \
  T quotient;                                                                                 \
  if (!divide(get<T>(AT(ip->b)), get<T>(AT(ip->c)), quotient)) FAIL(Fault::division_by_zero); \
  put(AT(ip->a), quotient);
#define DIVIDE_mod(T, AT) put(AT(ip->a), remainder(get<T>(AT(ip->b)), get<T>(AT(ip->c))));
#define DO_DIVIDE(op, cell, T, F, AT) op##_##cell##_##F : {DIVIDE_##op(T, AT)} NEXT();
#define PLC_DIVIDE(op, cell, T) DO_DIVIDE(op, cell, T, g, PLAIN) DO_DIVIDE(op, cell, T, x, MIXED)
// load: a := *(b + offset c); store: *(a + offset c) := b.
#define MOVE_move(T, AT) put(AT(ip->a), get<T>(AT(ip->b)));
#define MOVE_load(T, AT) put(AT(ip->a), get<T>(mem + get<std::uint32_t>(AT(ip->b)) + ip->c));
#define MOVE_store(T, AT) put(mem + get<std::uint32_t>(AT(ip->a)) + ip->c, get<T>(AT(ip->b)));
#define PLC_MOVE(op, cell, T)                   \
  op##_##cell##_g : MOVE_##op(T, PLAIN) NEXT(); \
  op##_##cell##_x : MOVE_##op(T, MIXED) NEXT();
// a := address of the element: bounds `aux`, index c, base b (a place, or a cell that holds an address).
#define BASE_index_at(AT) static_cast<std::uint32_t>(AT(ip->b) - mem)
#define BASE_index_add(AT) get<std::uint32_t>(AT(ip->b))
#define DO_INDEX(op, cell, T, F, AT)                                                                       \
  op##_##cell##_##F : {                                                                                    \
    const Image::Bounds& r = bounds[ip->aux];                                                              \
    const T i = get<T>(AT(ip->c));                                                                         \
    if (static_cast<std::int64_t>(i) < r.low || static_cast<std::int64_t>(i) > r.high ||                   \
        (std::is_same_v<T, std::uint64_t> && (i >> (sizeof(T) * 8 - 1)) != 0 && std::is_unsigned_v<T>))    \
      FAIL(Fault::index_out_of_range);                                                                     \
    put(AT(ip->a),                                                                                         \
        static_cast<std::uint32_t>(                                                                        \
            BASE_##op(AT) + static_cast<std::uint32_t>(static_cast<std::int64_t>(i) - r.low) * r.stride)); \
  }                                                                                                        \
  NEXT();
#define PLC_INDEX(op, cell, T) DO_INDEX(op, cell, T, g, PLAIN) DO_INDEX(op, cell, T, x, MIXED)
#define DO_CHECK(op, cell, T, F, AT)                                                   \
  op##_##cell##_##F : {                                                                \
    const T v = get<T>(AT(ip->a));                                                     \
    const Image::Bounds& r = bounds[ip->aux];                                          \
    if (static_cast<std::int64_t>(v) < r.low || static_cast<std::int64_t>(v) > r.high) \
      FAIL(Fault::subrange);                                                           \
  }                                                                                    \
  NEXT();
#define PLC_CHECK(op, cell, T) DO_CHECK(op, cell, T, g, PLAIN) DO_CHECK(op, cell, T, x, MIXED)
#define PLC_SINGLE(op)         \
  op##_g : SINGLE_##op(PLAIN); \
  op##_x : SINGLE_##op(MIXED);

// a := address of the element of an ARRAY[*]: limits `aux` behind the address in extra, index c, base b.
#define SINGLE_index_open(AT)                                                                           \
  {                                                                                                     \
    const auto r = get<ir::Limits>(mem + get<std::uint32_t>(m.extra[0]) + ip->aux);                     \
    const auto i = get<std::int64_t>(AT(ip->c));                                                        \
    if (i < r.low || i > r.high) FAIL(Fault::index_out_of_range);                                       \
    put(AT(ip->a), static_cast<std::uint32_t>(get<std::uint32_t>(AT(ip->b)) + (i - r.low) * r.stride)); \
  }                                                                                                     \
  NEXT()
#define SINGLE_not_bool(AT)    \
  *AT(ip->a) = *AT(ip->b) ^ 1; \
  NEXT()
#define SINGLE_move_bytes(AT)                \
  CHARGE(ip->c >> 4);                        \
  std::memmove(AT(ip->a), AT(ip->b), ip->c); \
  NEXT()
#define SINGLE_load_bytes(AT)                                          \
  CHARGE(ip->c >> 4);                                                  \
  std::memmove(AT(ip->a), mem + get<std::uint32_t>(AT(ip->b)), ip->c); \
  NEXT()
#define SINGLE_store_bytes(AT)                                         \
  CHARGE(ip->c >> 4);                                                  \
  std::memmove(mem + get<std::uint32_t>(AT(ip->a)), AT(ip->b), ip->c); \
  NEXT()
#define SINGLE_move_text(AT)                                                             \
  {                                                                                      \
    std::uint8_t* to = AT(ip->a);                                                        \
    const std::uint8_t* from = AT(ip->b);                                                \
    const std::uint8_t n = *from < ip->aux ? *from : static_cast<std::uint8_t>(ip->aux); \
    std::memmove(to + 1, from + 1, n);                                                   \
    *to = n;                                                                             \
  }                                                                                      \
  NEXT()
#define SINGLE_move_wide_text(AT)                                     \
  {                                                                   \
    const auto n = std::min(get<std::uint16_t>(AT(ip->b)), ip->aux);  \
    std::memmove(AT(ip->a) + 2, AT(ip->b) + 2, n * sizeof(char16_t)); \
    put(AT(ip->a), n);                                                \
  }                                                                   \
  NEXT()
#define SINGLE_address(AT)                                             \
  put(AT(ip->a), static_cast<std::uint32_t>(AT(ip->b) - mem) + ip->c); \
  NEXT()
#define SINGLE_check_reference(AT)                                     \
  if (get<std::uint32_t>(AT(ip->a)) == 0) FAIL(Fault::null_reference); \
  NEXT()
#define SINGLE_load_bit(AT)                                            \
  *AT(ip->a) = static_cast<std::uint8_t>((*AT(ip->b) >> ip->aux) & 1); \
  NEXT()
#define SINGLE_store_bit(AT)                                                               \
  {                                                                                        \
    std::uint8_t* byte = AT(ip->a);                                                        \
    const auto mask = static_cast<std::uint8_t>(1u << ip->aux);                            \
    *byte = static_cast<std::uint8_t>(*AT(ip->b) != 0 ? (*byte | mask) : (*byte & ~mask)); \
  }                                                                                        \
  NEXT()
#define SINGLE_jump(AT) \
  ip = code + ip->c;    \
  DISPATCH()
#define SINGLE_jump_back(AT) \
  CHARGE_BACK();             \
  ip = code + ip->c;         \
  DISPATCH()
#define SINGLE_jump_true(AT)                    \
  ip = *AT(ip->a) != 0 ? code + ip->c : ip + 1; \
  DISPATCH()
#define SINGLE_jump_false(AT)                   \
  ip = *AT(ip->a) == 0 ? code + ip->c : ip + 1; \
  DISPATCH()
#define SINGLE_repeat_until(AT) \
  if (*AT(ip->a) != 0) NEXT();  \
  CHARGE_BACK();                \
  ip = code + ip->c;            \
  DISPATCH()
#define SINGLE_for_check(AT)                        \
  {                                                 \
    const Counter n = get<Counter>(AT(ip->a));      \
    show(n, AT(ip->b), static_cast<Cell>(ip->aux)); \
    ip = n.within() ? ip + 1 : code + ip->c;        \
  }                                                 \
  DISPATCH()
#define SINGLE_for_next(AT)                                        \
  {                                                                \
    CHARGE_BACK();                                                 \
    Counter n = get<Counter>(AT(ip->a));                           \
    if (__builtin_add_overflow(n.value, n.step, &n.value)) NEXT(); \
    show(n, AT(ip->b), static_cast<Cell>(ip->aux));                \
    put(AT(ip->a), n);                                             \
    ip = n.within() ? code + ip->c : ip + 1;                       \
  }                                                                \
  DISPATCH()
#define ENTER(where)                                                                                     \
  CHARGE(ip->c);                                                                                         \
  if constexpr (kProfiled) profile.enter(m, depth, ip->a);                                               \
  frames[depth++] = {static_cast<std::uint32_t>(ip - code) + 1, static_cast<std::uint32_t>(self - mem)}; \
  self = (where);                                                                                        \
  ip = code + ip->a;                                                                                     \
  DISPATCH()
#define SINGLE_call(AT) ENTER(AT(ip->b))
#define SINGLE_call_at(AT) ENTER(mem + get<std::uint32_t>(AT(ip->b)))
#define SINGLE_ret(AT)                              \
  if (depth == 0) return Fault::none;               \
  --depth;                                          \
  if constexpr (kProfiled) profile.leave(m, depth); \
  ip = code + frames[depth].back;                   \
  self = mem + frames[depth].instance;              \
  DISPATCH()
#define SINGLE_extra(AT)  \
  m.extra[0] = AT(ip->b); \
  m.extra[1] = AT(ip->c); \
  NEXT()
#define SINGLE_native(AT)                                         \
  fault = native_at(ip->aux)(m, AT(ip->a), AT(ip->b), AT(ip->c)); \
  if (fault != Fault::none) goto failed;                          \
  NEXT()

  PLC_CODES(PLC_BINARY, PLC_DIVIDE, PLC_UNARY, PLC_BITWISE, PLC_MOVE, PLC_INDEX, PLC_CHECK, PLC_SINGLE)

failed:
  m.at = static_cast<std::uint32_t>(ip - code);
  // Nobody has the file of the library; its caller's line says what was wrong.
  while (depth > 0 && m.image->lines[m.at] >> 24 == m.image->files.size() - 1)
    m.at = frames[--depth].back - 1;
  return fault;
}

}  // namespace

Fault execute(Machine& m, std::uint32_t entry) noexcept {
  return m.blocks != nullptr && m.clock != nullptr ? run<true>(m, entry) : run<false>(m, entry);
}

}  // namespace servogate::plc::vm
