// SPDX-License-Identifier: Apache-2.0
#include "plc/library/standard_blocks.hpp"

namespace servogate::plc::library {

namespace {

constexpr const char* kBistables = R"(
FUNCTION_BLOCK SR
VAR_INPUT S1, R : BOOL; END_VAR
VAR_OUTPUT Q1 : BOOL; END_VAR
Q1 := S1 OR (NOT R AND Q1);
END_FUNCTION_BLOCK
FUNCTION_BLOCK RS
VAR_INPUT S, R1 : BOOL; END_VAR
VAR_OUTPUT Q1 : BOOL; END_VAR
Q1 := NOT R1 AND (S OR Q1);
END_FUNCTION_BLOCK
FUNCTION_BLOCK R_TRIG
VAR_INPUT CLK : BOOL; END_VAR
VAR_OUTPUT Q : BOOL; END_VAR
VAR M : BOOL; END_VAR
Q := CLK AND NOT M;
M := CLK;
END_FUNCTION_BLOCK
FUNCTION_BLOCK F_TRIG
VAR_INPUT CLK : BOOL; END_VAR
VAR_OUTPUT Q : BOOL; END_VAR
VAR M : BOOL := FALSE; END_VAR
Q := NOT CLK AND M;
M := CLK;
END_FUNCTION_BLOCK
)";

constexpr const char* kTimers = R"(
FUNCTION_BLOCK TP
VAR_INPUT IN : BOOL; PT : TIME; END_VAR
VAR_OUTPUT Q : BOOL; ET : TIME; END_VAR
VAR M, RUN : BOOL; T0 : TIME; END_VAR
IF IN AND NOT M AND NOT RUN THEN RUN := TRUE; T0 := TIME(); END_IF;
M := IN;
IF RUN THEN
  ET := TIME() - T0;
  IF ET >= PT THEN ET := PT; Q := FALSE; RUN := IN; ELSE Q := TRUE; END_IF;
END_IF;
IF NOT RUN THEN ET := T#0s; END_IF;
END_FUNCTION_BLOCK
FUNCTION_BLOCK TON
VAR_INPUT IN : BOOL; PT : TIME; END_VAR
VAR_OUTPUT Q : BOOL; ET : TIME; END_VAR
VAR M : BOOL; T0 : TIME; END_VAR
IF NOT IN THEN
  Q := FALSE; ET := T#0s;
ELSE
  IF NOT M THEN T0 := TIME(); END_IF;
  IF NOT Q THEN
    ET := TIME() - T0;
    IF ET >= PT THEN ET := PT; Q := TRUE; END_IF;
  END_IF;
END_IF;
M := IN;
END_FUNCTION_BLOCK
FUNCTION_BLOCK TOF
VAR_INPUT IN : BOOL; PT : TIME; END_VAR
VAR_OUTPUT Q : BOOL; ET : TIME; END_VAR
VAR M : BOOL; T0 : TIME; END_VAR
IF IN THEN
  Q := TRUE; ET := T#0s;
ELSIF Q THEN
  IF M THEN T0 := TIME(); END_IF;
  ET := TIME() - T0;
  IF ET >= PT THEN ET := PT; Q := FALSE; END_IF;
END_IF;
M := IN;
END_FUNCTION_BLOCK
)";

// @T the integer type, @N the suffix of the name, @L its least and @H its greatest value.
constexpr const char* kCounters = R"(
FUNCTION_BLOCK CTU@N
VAR_INPUT CU : BOOL; R : BOOL; PV : @T; END_VAR
VAR_OUTPUT Q : BOOL; CV : @T; END_VAR
VAR M : BOOL; END_VAR
IF R THEN CV := 0; ELSIF CU AND NOT M AND CV < @H THEN CV := CV + 1; END_IF;
M := CU;
Q := CV >= PV;
END_FUNCTION_BLOCK
FUNCTION_BLOCK CTD@N
VAR_INPUT CD : BOOL; LD : BOOL; PV : @T; END_VAR
VAR_OUTPUT Q : BOOL; CV : @T; END_VAR
VAR M : BOOL; END_VAR
IF LD THEN CV := PV; ELSIF CD AND NOT M AND CV > @L THEN CV := CV - 1; END_IF;
M := CD;
Q := CV <= 0;
END_FUNCTION_BLOCK
FUNCTION_BLOCK CTUD@N
VAR_INPUT CU, CD, R, LD : BOOL; PV : @T; END_VAR
VAR_OUTPUT QU, QD : BOOL; CV : @T; END_VAR
VAR MU, MD, UP, DOWN : BOOL; END_VAR
UP := CU AND NOT MU;
DOWN := CD AND NOT MD;
MU := CU; MD := CD;
IF R THEN CV := 0;
ELSIF LD THEN CV := PV;
ELSIF NOT (UP AND DOWN) THEN
  IF UP AND CV < @H THEN CV := CV + 1;
  ELSIF DOWN AND CV > @L THEN CV := CV - 1; END_IF;
END_IF;
QU := CV >= PV;
QD := CV <= 0;
END_FUNCTION_BLOCK
)";

struct CounterType {
  const char *suffix, *type, *low, *high;
};
constexpr CounterType kCounterTypes[] = {{"", "INT", "-32768", "32767"},
                                         {"_INT", "INT", "-32768", "32767"},
                                         {"_DINT", "DINT", "-2147483648", "2147483647"},
                                         {"_LINT", "LINT", "-9223372036854775808", "9223372036854775807"},
                                         {"_UDINT", "UDINT", "0", "4294967295"},
                                         {"_ULINT", "ULINT", "0", "18446744073709551615"}};

}  // namespace

std::string standard_blocks() {
  std::string out = std::string(kBistables) + kTimers;
  for (const CounterType& c : kCounterTypes) {
    const std::string_view text = kCounters;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char mark = text[i] == '@' ? text[i + 1] : '\0';
      if (mark == '\0') {
        out += text[i];
        continue;
      }
      out += mark == 'T' ? c.type : mark == 'N' ? c.suffix : mark == 'L' ? c.low : c.high;
      ++i;
    }
  }
  return out;
}

}  // namespace servogate::plc::library
