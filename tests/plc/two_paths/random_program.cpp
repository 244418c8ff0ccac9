// SPDX-License-Identifier: Apache-2.0
#include "tests/plc/two_paths/random_program.hpp"

#include <functional>
#include <random>
#include <vector>

namespace servogate::plc {

namespace {

struct Sort {
  const char* name;
  const char* literals[4];
};
constexpr Sort kSorts[] = {
    {"SINT", {"-128", "127", "3", "-1"}},
    {"INT", {"-32768", "32767", "7", "-2"}},
    {"DINT", {"-2147483648", "2147483647", "11", "-3"}},
    {"LINT", {"-9223372036854775808", "9223372036854775807", "13", "-1"}},
    {"USINT", {"0", "255", "5", "1"}},
    {"UINT", {"0", "65535", "6", "2"}},
    {"UDINT", {"0", "4294967295", "9", "1"}},
    {"ULINT", {"0", "18446744073709551615", "8", "3"}},
    {"BYTE", {"0", "16#FF", "16#5A", "1"}},
    {"WORD", {"0", "16#FFFF", "16#A55A", "2"}},
    {"DWORD", {"0", "16#FFFF_FFFF", "16#1234_5678", "4"}},
    {"LWORD", {"0", "16#FFFF_FFFF_FFFF_FFFF", "16#8000_0000_0000_0001", "8"}},
    {"REAL", {"0.0", "1.5", "-2.25", "1.0E10"}},
    {"LREAL", {"0.0", "-1.5", "3.0", "1.0E-3"}},
    {"BOOL", {"TRUE", "FALSE", "TRUE", "FALSE"}},
};
constexpr int kSortCount = 15, kFirstBits = 8, kFirstReal = 12, kBool = 14;

class Writer {
 public:
  explicit Writer(std::function<std::uint64_t()> choice) : choice_(std::move(choice)) {}

  std::string program() {
    std::string text = "TYPE Rec : STRUCT";
    for (int s = 0; s < kSortCount; ++s) text += " m" + number(s) + " : " + kSorts[s].name + ";";
    text += " END_STRUCT; END_TYPE\n";
    function_ = true;
    text +=
        "FUNCTION Fn : DINT\nVAR_INPUT p2 : DINT; p1 : INT := 4; END_VAR\nVAR_IN_OUT io2 : DINT; "
        "END_VAR\nVAR" +
        locals() + "END_VAR\n" + statements(2, 3) + "Fn := " + expression(2, 3) +
        ";\nio2 := " + expression(2, 2) + ";\nEND_FUNCTION\n";
    text +=
        "FUNCTION Total : DINT\nVAR_INPUT a : ARRAY[*] OF DINT; END_VAR\nVAR_IN_OUT m : ARRAY[*, *] OF Rec; "
        "END_VAR\nVAR i, j : DINT; END_VAR\nFOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO\n"
        "Total := Total * 3 + a[i];\nEND_FOR;\nFOR i := LOWER_BOUND(m, 1) TO UPPER_BOUND(m, 1) DO\n"
        "FOR j := UPPER_BOUND(m, 2) TO LOWER_BOUND(m, 2) BY -1 DO\nm[i, j].m2 := m[i, j].m2 + Total + " +
        number(pick(9)) + ";\nEND_FOR;\nEND_FOR;\nTotal := a[" + number(pick(2)) + " + LOWER_BOUND(m, " +
        number(1 + pick(2)) + ")];\nEND_FUNCTION\n";
    text +=
        "FUNCTION_BLOCK Blk\nVAR_INPUT p2 : DINT; p1 : INT; END_VAR\nVAR_IN_OUT io2 : DINT; END_VAR\nVAR" +
        locals() + "END_VAR\nVAR_TEMP tmp : INT := 3; END_VAR\n" + statements(2, 4) +
        "tmp := tmp + 1;\nio2 := io2 + tmp;\nEND_FUNCTION_BLOCK\n";
    function_ = false;
    text += "PROGRAM Main\nVAR blk : ARRAY[0..2] OF Blk;" + locals() + "END_VAR\n" + statements(3, 8) +
            "END_PROGRAM\n";
    return text;
  }

 private:
  static std::string number(int n) { return std::to_string(n); }
  int pick(int n) { return static_cast<int>(choice_() % static_cast<std::uint64_t>(n)); }

  std::string locals() {
    std::string out;
    for (int s = 0; s < kSortCount; ++s)
      out += "\n  v" + number(s) + " : " + kSorts[s].name + " := " + kSorts[s].literals[pick(4)] + "; a" +
             number(s) + " : ARRAY[-1..2] OF " + kSorts[s].name + ";";
    return out +
           "\n  rec, rec2 : Rec; recs : ARRAY[1..2, 0..1] OF Rec; few : ARRAY[0..0, -1..1] OF Rec; i, j, k : "
           "DINT; n : INT;\n";
  }

  std::string index(int low, int high) {
    if (pick(3) != 0 || subscripts_ > 3) return number(low + pick(high - low + 1));
    ++subscripts_;
    const std::string inner = variable(2);
    --subscripts_;
    return "LIMIT(" + number(low) + ", " + inner + ", " + number(high + (pick(40) == 0 ? 1 : 0)) + ")";
  }
  std::string variable(int sort) {
    const std::string s = number(sort);
    switch (pick(6)) {
      case 0:
        return "a" + s + "[" + index(-1, 2) + "]";
      case 1:
        return "rec.m" + s;
      case 2:
        return depth_++ > 3 ? (depth_ = 0, "v" + s) : "recs[" + index(1, 2) + ", " + index(0, 1) + "].m" + s;
      case 3:
        if (function_ && sort == 2) return pick(2) == 0 ? "io2" : "v2";
        return "v" + s;
      default:
        return "v" + s;
    }
  }
  std::string readable(int sort) {
    if (function_ && sort == 2 && pick(4) == 0) return "p2";
    if (function_ && sort == 1 && pick(4) == 0) return "p1";
    if (sort == kBool && pick(5) == 0) return "v" + number(kFirstBits + 1) + "." + number(pick(16));
    return variable(sort);
  }

  std::string expression(int sort, int depth) {
    if (depth <= 0) return pick(3) == 0 ? literal(sort) : readable(sort);
    const auto sub = [&](int s) { return expression(s, depth - 1 - pick(2)); };
    if (sort == kBool) return boolean(depth);
    if (pick(7) == 0) {  // from another type
      const int from = pick(kBool);
      // A bit pattern may be a signalling NaN, whose bits the processor does not keep.
      const bool pattern = (from == 10 && sort == 12) || (from == 12 && sort == 10) ||
                           (from == 11 && sort == 13) || (from == 13 && sort == 11);
      if (from != sort && !pattern)
        return std::string(kSorts[from].name) + "_TO_" + kSorts[sort].name + "(" +
               real_safe(from, sort, sub(from)) + ")";
    }
    if (pick(10) == 0) return "SEL(" + sub(kBool) + ", " + sub(sort) + ", " + sub(sort) + ")";
    if (sort >= kFirstBits && sort < kFirstReal) {
      constexpr const char* shifts[] = {"SHL", "SHR", "ROL", "ROR"};
      constexpr const char* ops[] = {" AND ", " OR ", " XOR "};
      if (pick(4) == 0) return std::string(shifts[pick(4)]) + "(" + sub(sort) + ", " + number(pick(20)) + ")";
      if (pick(4) == 0) return "NOT " + bracket(sub(sort));
      return "(" + sub(sort) + ops[pick(3)] + sub(sort) + ")";
    }
    if (pick(8) == 0)
      return (pick(2) == 0 ? "MIN(" : "MAX(") + sub(sort) + ", " + sub(sort) + ", " + sub(sort) + ")";
    if (pick(9) == 0) return "ABS(" + sub(sort) + ")";
    if (sort == 2 && !function_ && pick(6) == 0) return "Fn(" + sub(2) + ", INT_TO_INT_SAFE)";
    if (pick(6) == 0 && (sort < 4 || sort >= kFirstReal)) return "-" + bracket(sub(sort));
    constexpr const char* ops[] = {" + ", " - ", " * ", " + ", " - ", " / ", " MOD "};
    const int op = pick(sort >= kFirstReal ? 6 : 7);
    // Most divisors are kept from zero, or every program would end at its first line.
    const std::string right =
        op >= 5 && pick(30) != 0
            ? (sort >= kFirstReal ? "(2.5 + ABS(" + sub(sort) + "))" : "MAX(" + sub(sort) + ", 1)")
        : op >= 5 ? readable(sort)
                  : sub(sort);
    return "(" + sub(sort) + ops[op] + right + ")";
  }
  std::string boolean(int depth) {
    const auto sub = [&](int s) { return expression(s, depth - 1 - pick(2)); };
    constexpr const char* ops[] = {" AND ", " OR ", " XOR ", " = "};
    constexpr const char* compares[] = {" < ", " <= ", " > ", " >= ", " = ", " <> "};
    if (pick(4) == 0) return "NOT " + bracket(sub(kBool));
    if (pick(2) == 0) return "(" + sub(kBool) + ops[pick(4)] + sub(kBool) + ")";
    const int s = pick(kBool);
    return "(" + sub(s) + compares[pick(6)] + sub(s) + ")";
  }
  static std::string bracket(const std::string& s) { return "(" + s + ")"; }
  std::string real_safe(int from, int to, const std::string& e) {
    // A real out of an integer's range is a fault; seldom wanted.
    if (from >= kFirstReal && to < kFirstReal && pick(25) != 0) return "LIMIT(0.0, " + e + ", 100.0)";
    if (from == 13 && to == 12 && pick(25) != 0) return "LIMIT(-1.0E6, " + e + ", 1.0E6)";
    return e;
  }
  std::string literal(int sort) {
    return std::string(kSorts[sort].name) + "#" + kSorts[sort].literals[pick(4)];
  }

  std::string statements(int depth, int count) {
    std::string out;
    for (int i = 0; i < count; ++i) out += statement(depth);
    return out;
  }
  std::string statement(int depth) {
    const int sort = pick(kSortCount);
    const int kind = depth > 0 ? pick(11) : 0;
    const auto inner = [&] { return statements(depth - 1, 1 + pick(3)); };
    switch (kind) {
      case 0:
      case 1:
      case 2:
      case 3:
        return variable(sort) + " := " + expression(sort, 4) + ";\n";
      case 4:
        return "IF " + expression(kBool, 3) + " THEN\n" + inner() + "ELSIF " + expression(kBool, 2) +
               " THEN\n" + inner() + "ELSE\n" + inner() + "END_IF;\n";
      case 5:
        return "CASE " + expression(1, 2) + " OF\n-100..0:\n" + inner() + "1, 3, 7:\n" + inner() +
               "8..300:\n" + inner() + (pick(2) == 0 ? "ELSE\n" + inner() : "") + "END_CASE;\n";
      case 6: {
        const char* counters[] = {"i", "j", "k"};
        const std::string c = counters[depth - 1];
        const bool down = pick(3) == 0;
        return "FOR " + c +
               " := " + (down ? "5 TO 1 BY -" + number(1 + pick(2)) : "-1 TO 2 BY " + number(1 + pick(2))) +
               " DO\n" + inner() +
               (pick(3) == 0 ? "IF " + expression(kBool, 1) +
                                   (pick(2) == 0 ? " THEN EXIT; END_IF;\n" : " THEN CONTINUE; END_IF;\n")
                             : "") +
               variable(sort) + " := " + expression(sort, 2) + ";\nEND_FOR;\n";
      }
      case 7:
        return "n := 0;\nREPEAT\nn := n + 1;\n" + variable(sort) + " := " + expression(sort, 3) +
               ";\nUNTIL n >= " + number(1 + pick(4)) + " OR " + expression(kBool, 1) + " END_REPEAT;\n";
      case 8:
        return pick(2) == 0 ? "rec2 := recs[" + index(1, 2) + ", 0];\nrec := rec2;\n"
                            : "a" + number(sort) + " := a" + number(sort) + ";\nrecs[2, " + index(0, 1) +
                                  "] := rec;\n";
      case 9:
        if (function_) return "v2 := v2 + p2;\n";
        return "blk[" + index(0, 2) + "](p2 := " + expression(2, 2) + ", p1 := " + expression(1, 2) +
               ", io2 := " + (pick(2) == 0 ? "v2" : "a2[" + index(-1, 2) + "]") + ");\n";
      default:
        if (function_) return "v1 := v1 + p1;\n";
        if (pick(3) == 0)
          return "v2 := v2 + Total(a2, recs);\nv1 := v1 + DINT_TO_INT(Total(m := few, a := a2));\n";
        return "v2 := Fn(p2 := " + expression(2, 2) +
               ", io2 := " + (pick(2) == 0 ? "rec.m2" : "a2[" + index(-1, 2) + "]") +
               ") + v2 * Fn(p2 := Fn(p2 := 1, io2 := v2), p1 := v1, io2 := v2);\n";
    }
  }

  std::function<std::uint64_t()> choice_;
  bool function_ = false;
  int depth_ = 0;
  int subscripts_ = 0;  ///< inside one another
};

}  // namespace

static std::string written(std::function<std::uint64_t()> choice) {
  std::string text = Writer(std::move(choice)).program();
  // A call inside an expression: the last argument is the variable that the function changes.
  for (std::size_t at; (at = text.find("INT_TO_INT_SAFE")) != std::string::npos;)
    text.replace(at, 15, "v1, v2");
  return text;
}

std::string random_program(std::uint64_t seed) { return written(std::mt19937_64(seed)); }

std::string random_program(std::span<const std::uint8_t> choices) {
  return written([choices, at = std::size_t{0}]() mutable -> std::uint64_t {
    return at < choices.size() ? choices[at++] : 0;
  });
}

}  // namespace servogate::plc
