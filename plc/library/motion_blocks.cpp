// SPDX-License-Identifier: Apache-2.0
#include "plc/library/motion_blocks.hpp"

#include <string_view>

namespace servogate::plc::library {

namespace {

// In memory as in packet K, image::kMotionFields: Analyzer::axis_reference puts it there.
constexpr const char* kAxisRef = R"(
TYPE MC_DIRECTION : USINT (mcNoDirection, mcPositiveDirection, mcShortestWay, mcNegativeDirection, mcCurrentDirection);
END_TYPE
TYPE AXIS_REF : STRUCT
  mc_taken, mc_active : DINT;
  mc_refusal, mc_error : INT;
  mc_state, mc_result, mc_powered, mc_pad : USINT;
  mc_power_refusal : INT;
  mc_torque : REAL;
  mc_position : LREAL;
  mc_order_number : DINT;
  mc_order, mc_power, mc_direction : USINT;
  mc_target, mc_velocity, mc_acceleration : LREAL;
END_STRUCT; END_TYPE
)";

// @N name, @I inputs, @O number of the order, @A its values, @Q output of its success, @K what keeps it busy.
// Results last while Execute is TRUE, and one call at least; another order of the same axis ends this one.
constexpr const char* kOrder = R"(
FUNCTION_BLOCK @N
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT Execute : BOOL; @I END_VAR
VAR_OUTPUT @Q, Busy, Active, CommandAborted, Error : BOOL; ErrorID : WORD; END_VAR
VAR M, ASKED, TAKEN, LET_GO : BOOL; NUMBER, RELEASE : DINT; END_VAR
IF NOT Execute OR NOT M THEN @Q := FALSE; CommandAborted := FALSE; Error := FALSE; ErrorID := 0; END_IF;
IF Execute AND NOT M THEN
  ASKED := FALSE; TAKEN := FALSE; LET_GO := FALSE;
  IF Axis.mc_state = 0 THEN
    Error := TRUE; ErrorID := 3;
  ELSE
    Axis.mc_order_number := Axis.mc_order_number + 1;
    NUMBER := Axis.mc_order_number;
    Axis.mc_order := @O;
    @A
    ASKED := TRUE;
  END_IF;
ELSIF ASKED THEN
  IF Axis.mc_taken = NUMBER THEN
    ASKED := FALSE;
    TAKEN := Axis.mc_refusal = 0;
    IF NOT TAKEN THEN Error := TRUE; ErrorID := INT_TO_WORD(Axis.mc_refusal); END_IF;
  ELSIF Axis.mc_order_number <> NUMBER THEN
    ASKED := FALSE; CommandAborted := TRUE;
  END_IF;
END_IF;
M := Execute;
IF TAKEN THEN
  IF Axis.mc_active <> NUMBER OR Axis.mc_result = 2 THEN
    TAKEN := FALSE; @Q := FALSE; CommandAborted := NOT LET_GO;
  ELSIF Axis.mc_result = 3 THEN
    TAKEN := FALSE; @Q := FALSE; Error := TRUE; ErrorID := INT_TO_WORD(Axis.mc_error);
  ELSE
    @K
  END_IF;
END_IF;
Busy := ASKED OR TAKEN;
Active := TAKEN;
END_FUNCTION_BLOCK
)";

constexpr std::string_view kUntilDone = "IF Axis.mc_result = 1 THEN TAKEN := FALSE; @Q := TRUE; END_IF;";
constexpr std::string_view kUntilAborted = "@Q := Execute AND Axis.mc_result = 1;";
// The axis stays in the state Stopping until Execute falls.
constexpr std::string_view kStop = R"(@Q := Axis.mc_result = 1;
    IF @Q AND NOT Execute AND (NOT LET_GO OR Axis.mc_order_number <> RELEASE) THEN
      LET_GO := TRUE;
      Axis.mc_order_number := Axis.mc_order_number + 1;
      RELEASE := Axis.mc_order_number;
      Axis.mc_order := 6;
    END_IF;)";
constexpr std::string_view kLimits = R"(
    Axis.mc_acceleration := Acceleration;
    IF Deceleration > 0.0 AND (Acceleration <= 0.0 OR Deceleration < Acceleration) THEN
      Axis.mc_acceleration := Deceleration;
    END_IF;)";

// What does not ask for a motion. A reset while the axis moves has nothing to do and leaves the motion alone.
constexpr const char* kAdministration = R"(
FUNCTION_BLOCK MC_Power
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT Enable : BOOL; END_VAR
VAR_OUTPUT Status, Valid, Error : BOOL; ErrorID : WORD; END_VAR
VAR M : BOOL; END_VAR
ErrorID := 0;
IF Enable AND Axis.mc_state = 0 THEN
  ErrorID := 3;
ELSIF Enable AND M THEN
  ErrorID := INT_TO_WORD(Axis.mc_power_refusal);
END_IF;
Axis.mc_power := BOOL_TO_USINT(Enable);
M := Enable;
Error := ErrorID <> 0;
Valid := Enable AND NOT Error;
Status := Axis.mc_powered = 1;
END_FUNCTION_BLOCK
FUNCTION_BLOCK MC_Reset
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT Execute : BOOL; END_VAR
VAR_OUTPUT Done, Busy, Error : BOOL; ErrorID : WORD; END_VAR
VAR M : BOOL; NUMBER : DINT; END_VAR
IF NOT Execute OR NOT M THEN Done := FALSE; Error := FALSE; ErrorID := 0; END_IF;
IF Execute AND NOT M THEN
  Busy := FALSE;
  IF Axis.mc_state = 0 THEN
    Error := TRUE; ErrorID := 3;
  ELSE
    Axis.mc_order_number := Axis.mc_order_number + 1;
    NUMBER := Axis.mc_order_number;
    Axis.mc_order := 7;
    Busy := TRUE;
  END_IF;
ELSIF Busy AND (Axis.mc_taken = NUMBER OR Axis.mc_order_number <> NUMBER) THEN
  IF Axis.mc_taken = NUMBER AND Axis.mc_refusal <> 0 THEN
    Busy := FALSE; Error := TRUE; ErrorID := INT_TO_WORD(Axis.mc_refusal);
  ELSIF Axis.mc_active = NUMBER AND Axis.mc_result = 3 THEN
    Busy := FALSE; Error := TRUE; ErrorID := INT_TO_WORD(Axis.mc_error);
  ELSIF Axis.mc_active <> NUMBER OR Axis.mc_result <> 0 THEN
    Busy := FALSE; Done := TRUE;
  END_IF;
END_IF;
M := Execute;
END_FUNCTION_BLOCK
FUNCTION_BLOCK MC_ReadStatus
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT Enable : BOOL; END_VAR
VAR_OUTPUT
  Valid, Busy, Error : BOOL; ErrorID : WORD;
  ErrorStop, Disabled, Stopping, Homing, StandStill, DiscreteMotion, ContinuousMotion, SynchronizedMotion : BOOL;
END_VAR
VAR S : USINT; END_VAR
Error := Enable AND Axis.mc_state = 0;
ErrorID := SEL(Error, WORD#0, WORD#3);
Valid := Enable AND NOT Error;
Busy := Valid;
S := SEL(Valid, USINT#0, Axis.mc_state);
Disabled := S = 1;
StandStill := S = 2;
Homing := S = 3;
DiscreteMotion := S = 4;
ContinuousMotion := S = 5;
Stopping := S = 6;
ErrorStop := S = 7;
SynchronizedMotion := FALSE;
END_FUNCTION_BLOCK
FUNCTION_BLOCK MC_ReadActualPosition
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT Enable : BOOL; END_VAR
VAR_OUTPUT Valid, Busy, Error : BOOL; ErrorID : WORD; Position : LREAL; END_VAR
Error := Enable AND Axis.mc_state = 0;
ErrorID := SEL(Error, WORD#0, WORD#3);
Valid := Enable AND NOT Error;
Busy := Valid;
IF Valid THEN Position := Axis.mc_position; END_IF;
END_FUNCTION_BLOCK
FUNCTION_BLOCK MC_ReadActualTorque
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT Enable : BOOL; END_VAR
VAR_OUTPUT Valid, Busy, Error : BOOL; ErrorID : WORD; Torque : LREAL; END_VAR
Error := Enable AND Axis.mc_state = 0;
ErrorID := SEL(Error, WORD#0, WORD#3);
Valid := Enable AND NOT Error;
Busy := Valid;
IF Valid THEN Torque := REAL_TO_LREAL(Axis.mc_torque); END_IF;
END_FUNCTION_BLOCK
)";

// The other end of an AXIS_REF that belongs to no axis of a machine, for programs on a desk: velocity in
// trapezoids, no jerk, no following error. Error numbers are those of the control.
constexpr const char* kSimulation = R"(
FUNCTION_BLOCK MC_SIMULATED_AXIS
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT
  MaxVelocity : LREAL := 100.0; MaxAcceleration : LREAL := 1000.0;
  TravelMin, TravelMax : LREAL;  (* both 0: endless *)
  Homed : BOOL;
  Fault : INT;  (* other than 0: number of an alarm that stops the axis *)
END_VAR
VAR_OUTPUT Velocity : LREAL; END_VAR
VAR
  HAVE_TIME, IS_HOMED, POWER, ENDLESS, BRAKING : BOOL;
  DOWN : BOOL;  (* the way it turned last *)
  LAST, HOME_TIME : TIME; DT, WAY, AHEAD, GOAL, SPEED, ACC, WISH, STEP : LREAL; ORDER, WANTED : USINT; R : INT;
END_VAR
DT := 0.0;
IF HAVE_TIME THEN DT := LINT_TO_LREAL(TIME_TO_LINT(TIME() - LAST)) / 1000.0; END_IF;
LAST := TIME(); HAVE_TIME := TRUE;
ENDLESS := TravelMin = 0.0 AND TravelMax = 0.0;
IF Homed THEN IS_HOMED := TRUE; END_IF;
IF Axis.mc_state = 0 THEN Axis.mc_state := 1; END_IF;

IF Axis.mc_power = 1 AND NOT POWER THEN Axis.mc_power_refusal := Fault; END_IF;
POWER := Axis.mc_power = 1;
IF NOT POWER THEN Axis.mc_power_refusal := 0; END_IF;
IF POWER AND Fault <> 0 THEN Axis.mc_power_refusal := Fault; END_IF;
Axis.mc_powered := BOOL_TO_USINT(POWER AND Axis.mc_power_refusal = 0);

(* the end of the order in force *)
IF ORDER <> 0 AND ORDER <> 5 AND ORDER <> 7 AND Axis.mc_result <> 2 AND Axis.mc_result <> 3
   AND NOT (Axis.mc_result = 1 AND ORDER <> 4) AND Axis.mc_powered = 0 THEN
  IF POWER THEN Axis.mc_result := 3; Axis.mc_error := Axis.mc_power_refusal; Axis.mc_state := 7;
  ELSE Axis.mc_result := 2; END_IF;
  BRAKING := TRUE;
END_IF;

IF Axis.mc_order_number <> Axis.mc_taken THEN
  Axis.mc_taken := Axis.mc_order_number;
  WANTED := Axis.mc_order;
  R := 0;
  WAY := Axis.mc_target;
  IF WANTED = 8 THEN R := @N; END_IF;
  IF WANTED = 2 THEN
    WAY := WAY - Axis.mc_position;
    IF ENDLESS AND Axis.mc_direction >= 1 AND Axis.mc_direction <= 4 THEN
      (* from where it would come to rest, less than a turn on *)
      GOAL := Velocity * ABS(Velocity) / (2.0 * MaxAcceleration);
      AHEAD := (WAY - GOAL) / 360.0;
      AHEAD := (AHEAD - LINT_TO_LREAL(LREAL_TRUNC_LINT(AHEAD))) * 360.0;
      IF AHEAD < -1.0E-6 THEN AHEAD := AHEAD + 360.0; END_IF;
      IF AHEAD > 360.0 - 1.0E-6 THEN AHEAD := AHEAD - 360.0; END_IF;
      IF AHEAD > 1.0E-6 AND (Axis.mc_direction = 3 OR Axis.mc_direction = 4 AND DOWN OR
         Axis.mc_direction = 2 AND AHEAD > 180.0) THEN AHEAD := AHEAD - 360.0; END_IF;
      WAY := GOAL + AHEAD;
    END_IF;
  END_IF;
  IF WANTED >= 1 AND WANTED <= 4 THEN
    IF Axis.mc_state = 7 THEN R := @E;
    ELSIF Axis.mc_state = 6 THEN R := @S;
    ELSIF Axis.mc_powered = 0 THEN R := 8;
    ELSIF WANTED > 1 THEN
      IF NOT IS_HOMED THEN R := 9;
      ELSIF NOT (Axis.mc_velocity > 0.0 AND Axis.mc_velocity <= MaxVelocity) THEN R := @V;
      ELSIF Axis.mc_acceleration < 0.0 OR Axis.mc_acceleration > MaxAcceleration THEN R := @B;
      ELSIF NOT ENDLESS AND WANTED < 4 AND
        (Axis.mc_position + WAY < TravelMin OR Axis.mc_position + WAY > TravelMax) THEN R := @T; END_IF;
    END_IF;
  END_IF;
  Axis.mc_refusal := R;
  IF R = 0 AND NOT (WANTED = 7 AND Axis.mc_state <> 7) THEN
    ORDER := WANTED;
    Axis.mc_active := SEL(WANTED = 0 OR WANTED = 6, Axis.mc_taken, 0);
    Axis.mc_result := 0;
    SPEED := Axis.mc_velocity;
    ACC := SEL(Axis.mc_acceleration > 0.0, MaxAcceleration, Axis.mc_acceleration);
    GOAL := Axis.mc_position + WAY;
    BRAKING := WANTED = 0 OR WANTED = 5;
    HOME_TIME := TIME();
    IF WANTED = 6 THEN BRAKING := TRUE; END_IF;
    IF WANTED = 7 THEN
      BRAKING := TRUE;
      IF Fault <> 0 THEN Axis.mc_result := 3; Axis.mc_error := Fault;
      ELSE Axis.mc_result := 1; Axis.mc_error := 0; Axis.mc_state := 2; END_IF;
    END_IF;
  END_IF;
END_IF;

(* the way of this cycle *)
WISH := 0.0;
IF NOT BRAKING AND (ORDER = 2 OR ORDER = 3) THEN
  WAY := GOAL - Axis.mc_position;
  WISH := LIMIT(-SPEED, WAY * 1.0E9, SPEED);
  IF ABS(WISH) > SQRT(2.0 * ACC * ABS(WAY)) THEN WISH := SEL(WAY < 0.0, LREAL#1.0, LREAL#-1.0) * SQRT(2.0 * ACC * ABS(WAY)); END_IF;
ELSIF NOT BRAKING AND ORDER = 4 THEN
  WISH := SEL(Axis.mc_target < 0.0, SPEED, -SPEED);
END_IF;
STEP := SEL(BRAKING, ACC, MaxAcceleration) * DT;
Velocity := LIMIT(Velocity - STEP, WISH, Velocity + STEP);
IF Velocity <> 0.0 THEN DOWN := Velocity < 0.0; END_IF;
IF NOT BRAKING AND (ORDER = 2 OR ORDER = 3) AND ABS(GOAL - Axis.mc_position) <= ABS(Velocity) * DT + 1.0E-9 THEN
  Axis.mc_position := GOAL; Velocity := 0.0; Axis.mc_result := 1; ORDER := 0;
ELSE
  Axis.mc_position := Axis.mc_position + Velocity * DT;
END_IF;
IF ORDER = 4 AND NOT ENDLESS AND (Axis.mc_position >= TravelMax AND Velocity > 0.0
   OR Axis.mc_position <= TravelMin AND Velocity < 0.0) THEN
  Axis.mc_position := LIMIT(TravelMin, Axis.mc_position, TravelMax);
  Velocity := 0.0; BRAKING := TRUE; Axis.mc_result := 3; Axis.mc_error := 22;
END_IF;
IF ORDER = 4 AND Axis.mc_result <> 3 AND NOT BRAKING THEN Axis.mc_result := BOOL_TO_USINT(Velocity = WISH); END_IF;
IF ORDER = 5 AND Velocity = 0.0 THEN Axis.mc_result := 1; END_IF;
IF ORDER = 1 AND NOT BRAKING AND TIME() - HOME_TIME >= T#100ms THEN
  IS_HOMED := TRUE; Axis.mc_position := 0.0; Axis.mc_result := 1; ORDER := 0;
END_IF;
IF Axis.mc_state <> 7 THEN
  IF Axis.mc_powered = 0 THEN Axis.mc_state := 1;
  ELSIF ORDER = 5 THEN Axis.mc_state := 6;
  ELSIF ORDER = 1 AND NOT BRAKING THEN Axis.mc_state := 3;
  ELSIF ORDER = 4 AND NOT BRAKING THEN Axis.mc_state := 5;
  ELSIF Velocity <> 0.0 OR NOT BRAKING AND (ORDER = 2 OR ORDER = 3) THEN Axis.mc_state := 4;
  ELSE Axis.mc_state := 2; END_IF;
END_IF;
END_FUNCTION_BLOCK
)";

struct Order {
  std::string_view name, inputs, number, values, success, kept;
};
constexpr std::string_view kMoveInputs = "Velocity, Acceleration, Deceleration : LREAL;";
constexpr Order kOrders[] = {
    {"MC_Home", "", "1", "", "Done", kUntilDone},
    {"MC_MoveAbsolute", "Position, @M Direction : MC_DIRECTION;", "2",
     "Axis.mc_target := Position; Axis.mc_direction := TO_USINT(Direction); Axis.mc_velocity := Velocity; @L",
     "Done", kUntilDone},
    {"MC_MoveRelative", "Distance, @M", "3", "Axis.mc_target := Distance; Axis.mc_velocity := Velocity; @L",
     "Done", kUntilDone},
    {"MC_MoveVelocity", "@M", "4",
     "Axis.mc_target := SEL(Velocity < 0.0, LREAL#1.0, LREAL#-1.0); Axis.mc_velocity := ABS(Velocity); @L",
     "InVelocity", kUntilAborted},
    {"MC_Stop", "", "5", "", "Done", kStop},
    {"MC_TorqueControl", "Torque, TorqueRamp, Velocity : LREAL;", "8",
     "Axis.mc_target := Torque; Axis.mc_velocity := Velocity; Axis.mc_acceleration := TorqueRamp;",
     "InTorque", kUntilAborted},
};

void fill(std::string& out, std::string_view text, const Order& o) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '@') {
      out += text[i];
      continue;
    }
    switch (text[++i]) {
      case 'N':
        out += o.name;
        break;
      case 'I':
        fill(out, o.inputs, o);
        break;
      case 'O':
        out += o.number;
        break;
      case 'A':
        fill(out, o.values, o);
        break;
      case 'Q':
        out += o.success;
        break;
      case 'K':
        fill(out, o.kept, o);
        break;
      case 'M':
        out += kMoveInputs;
        break;
      default:
        out += kLimits;
    }
  }
}

// Numbers of the gate's refusals that the simulation gives: cycle::Refusal, which this room does not see;
// tests/machine_run compares them.
std::string simulation() {
  std::string out = kSimulation;
  constexpr std::string_view kNumbers[][2] = {{"@T", "33"}, {"@V", "34"}, {"@B", "35"},
                                              {"@S", "36"}, {"@E", "38"}, {"@N", "46"}};
  for (const auto& [mark, number] : kNumbers)
    for (std::size_t at = out.find(mark); at != std::string::npos; at = out.find(mark))
      out.replace(at, mark.size(), number);
  return out;
}

}  // namespace

std::string motion_blocks() {
  std::string out = kAxisRef;
  for (const Order& o : kOrders) fill(out, kOrder, o);
  return out + kAdministration + simulation();
}

}  // namespace servogate::plc::library
