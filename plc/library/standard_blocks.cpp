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

// @N the suffix of the name.
constexpr const char* kTimers = R"(
FUNCTION_BLOCK TP@N
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
FUNCTION_BLOCK TON@N
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
FUNCTION_BLOCK TOF@N
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

// IEC 61131-3:2013, table 36. A day or clock beyond its month or day counts on into the next.
constexpr const char* kDates = R"(
FUNCTION CONCAT_DATE : DATE
VAR_INPUT YEAR, MONTH, DAY : INT; END_VAR
VAR Y, M, ERA, YOE, DOE : DINT; END_VAR
M := (MONTH + 9) MOD 12;
Y := YEAR - M / 10;
ERA := SEL(Y < 0, Y, Y - 399) / 400;
YOE := Y - ERA * 400;
DOE := YOE * 365 + YOE / 4 - YOE / 100 + (153 * M + 2) / 5 + DAY - 1;
CONCAT_DATE := LINT_TO_DATE((DINT_TO_LINT(ERA) * 146097 + DOE - 719468) * 86400);
END_FUNCTION
FUNCTION CONCAT_TOD : TOD
VAR_INPUT HOUR, MINUTE, SECOND, MILLISECOND : INT; END_VAR
CONCAT_TOD := LINT_TO_TOD(((HOUR * LINT#60 + MINUTE) * 60 + SECOND) * 1000 + MILLISECOND);
END_FUNCTION
FUNCTION CONCAT_DT : DT
VAR_INPUT YEAR, MONTH, DAY, HOUR, MINUTE, SECOND, MILLISECOND : INT; END_VAR
CONCAT_DT := CONCAT_DATE_TOD(CONCAT_DATE(YEAR, MONTH, DAY), CONCAT_TOD(HOUR, MINUTE, SECOND, MILLISECOND));
END_FUNCTION
FUNCTION SPLIT_DATE
VAR_INPUT IN : DATE; END_VAR
VAR_OUTPUT YEAR, MONTH, DAY : INT; END_VAR
VAR Z, ERA, DOE, YOE, DOY, M : LINT; END_VAR
Z := DATE_TO_LINT(IN) / 86400 + 719468;
ERA := SEL(Z < 0, Z, Z - 146096) / 146097;
DOE := Z - ERA * 146097;
YOE := (DOE - DOE / 1460 + DOE / 36524 - DOE / 146096) / 365;
DOY := DOE - (365 * YOE + YOE / 4 - YOE / 100);
M := (5 * DOY + 2) / 153;
DAY := LINT_TO_INT(DOY - (153 * M + 2) / 5 + 1);
MONTH := LINT_TO_INT(SEL(M < 10, M - 9, M + 3));
YEAR := LINT_TO_INT(YOE + ERA * 400 + SEL(M < 10, 1, 0));
END_FUNCTION
FUNCTION SPLIT_TOD
VAR_INPUT IN : TOD; END_VAR
VAR_OUTPUT HOUR, MINUTE, SECOND, MILLISECOND : INT; END_VAR
VAR T : LINT; END_VAR
T := TOD_TO_LINT(IN);
MILLISECOND := LINT_TO_INT(T MOD 1000);
SECOND := LINT_TO_INT(T / 1000 MOD 60);
MINUTE := LINT_TO_INT(T / 60000 MOD 60);
HOUR := LINT_TO_INT(T / 3600000);
END_FUNCTION
FUNCTION SPLIT_DT
VAR_INPUT IN : DT; END_VAR
VAR_OUTPUT YEAR, MONTH, DAY, HOUR, MINUTE, SECOND, MILLISECOND : INT; END_VAR
SPLIT_DATE(DT_TO_DATE(IN), YEAR, MONTH, DAY);
SPLIT_TOD(DT_TO_TOD(IN), HOUR, MINUTE, SECOND, MILLISECOND);
END_FUNCTION
FUNCTION DAY_OF_WEEK : USINT
VAR_INPUT IN : DATE; END_VAR
VAR D : LINT; END_VAR
D := (DATE_TO_LINT(IN) / 86400 + 4) MOD 7;
DAY_OF_WEEK := LINT_TO_USINT(SEL(D < 0, D, D + 7));
END_FUNCTION
FUNCTION IS_VALID : BOOL
VAR_INPUT IN : LREAL; END_VAR
IS_VALID := IN - IN = 0.0;
END_FUNCTION
FUNCTION IS_VALID_BCD : BOOL
VAR_INPUT IN : LWORD; END_VAR
VAR I : INT; END_VAR
IS_VALID_BCD := TRUE;
FOR I := 0 TO 60 BY 4 DO
  IF (SHR(IN, I) AND 16#F) > LWORD#9 THEN IS_VALID_BCD := FALSE; END_IF;
END_FOR;
END_FUNCTION
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

// Appends `text` with @N, @T, @L and @H replaced.
void fill(std::string& out, std::string_view text, const CounterType& c) {
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

}  // namespace

std::string standard_blocks() {
  std::string out = std::string(kBistables) + kDates;
  for (const char* suffix : {"", "_TIME", "_LTIME"}) fill(out, kTimers, {suffix, "", "", ""});
  for (const CounterType& c : kCounterTypes) fill(out, kCounters, c);
  return out;
}

}  // namespace servogate::plc::library
