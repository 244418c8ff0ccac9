// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::machine_run {

/// A program that uses every joint between program, cycle and PLC within a few seconds of machine time: M, S
/// and T, rapids, lines, arcs, a continuous profile, a dwell, writes and reads of SK that synchronise, a
/// branch.
inline constexpr const char* kShortProgram = R"("BEGIN"N10 G71 G90 G94 G97 G27
N20 SK10=1
N30 T2.1 M6
N40 S1200 M3
N50 G0 X5 Y3
N60 G1 X15 Y5 F6000
N70 X18 Y9
N80 G3 X12 Y15 I12 J9
N90 G1 X5 Y3
N100 M8
N110 G0 X2
N120 TMR=0.05
N125 G4
N130 E1=SK10.IN
N140 SK20=7
N150 (BEQ,SK20,7,GOOD)
N160 G0 X100
"GOOD"N170 G0 Z-5
N180 G1 Z-2 F1500
N190 M5
N200 M30
)";

}  // namespace servogate::machine_run
