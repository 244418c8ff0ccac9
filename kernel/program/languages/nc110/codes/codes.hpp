// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace servogate::program {
class Execution;
struct Value;
}  // namespace servogate::program

namespace servogate::program::nc110 {
struct Operand;
struct Operands;
}  // namespace servogate::program::nc110

/// The exceptions of NC-110: what its three-letter codes and its variables do. Named as the words of the
/// language.
namespace servogate::program::nc110::code {

// flow.cpp; source: specification B 5
void rpt(Execution& run, const Operands& operands);
void erp(Execution& run, const Operands& operands);
void cls(Execution& run, const Operands& operands);
void epp(Execution& run, const Operands& operands);
void bnc(Execution& run, const Operands& operands);
void branch(Execution& run, const Operands& operands);

/// An operand that names a program; throws ProgramError where it is no name.
std::string_view program_name(const Operands& operands, const Operand& item);

// frame.cpp; source: specification B 4, B 6
void uao(Execution& run, const Operands& operands);
void uot(Execution& run, const Operands& operands);
void uio(Execution& run, const Operands& operands);
void mir(Execution& run, const Operands& operands);
void urt(Execution& run, const Operands& operands);
void scf(Execution& run, const Operands& operands);
void rqo(Execution& run, const Operands& operands);
void dpi(Execution& run, const Operands& operands);
void dlo(Execution& run, const Operands& operands);
void dtl(Execution& run, const Operands& operands);

// motion/spline.cpp; source: specification A 11
void bsp(Execution& run, const Operands& operands);
void esp(Execution& run, const Operands& operands);

// processes.cpp; source: specification B 15
void exe(Execution& run, const Operands& operands);
void rel(Execution& run, const Operands& operands);
void snd(Execution& run, const Operands& operands);
/// WAI with the number of a process.
void wait_for_process(Execution& run, const Operands& operands, const Value& value);

// zones.cpp; source: specification B 6.5
void dsa(Execution& run, const Operands& operands);
void asc(Execution& run, const Operands& operands);
void dsc(Execution& run, const Operands& operands);

// records.cpp; source: specification B 16
void der(Execution& run, const Operands& operands);
void record_file(Execution& run, const Operands& operands);
/// An order to record files stands in the block: it comes behind the motion before it.
bool orders_records(std::string_view code);
// asset.cpp
void keyboard(Execution& run, const Operands& operands);
void screen(Execution& run, const Operands& operands);

// virtual.cpp; source: specification B 13, B 6.4
void uav(Execution& run, const Operands& operands);
void ctl(Execution& run, const Operands& operands);

// tools.cpp; source: specification B 9, B 10.1
void rqu(Execution& run, const Operands& operands);
void rqp(Execution& run, const Operands& operands);
void tof(Execution& run, const Operands& operands);
void dpt(Execution& run, const Operands& operands);

// signal.cpp; source: specification B 7, B 15.3
void dis(Execution& run, const Operands& operands);
/// UCG, CLG, DCG: read, and told that they change nothing.
void graphics(Execution& run, const Operands& operands);
void dly(Execution& run, const Operands& operands);
void wai(Execution& run, const Operands& operands);

}  // namespace servogate::program::nc110::code

namespace servogate::program::nc110::variable {

// variables.cpp; source: specification A 19, A 13.4
void tmr(Execution& run, double value, int index, int column);
void uov(Execution& run, double value, int index, int column);
void erf(Execution& run, double value, int index, int column);
void mcd(Execution& run, double value, int index, int column);
void usb(Execution& run, double value, int index, int column);
void uso(Execution& run, double value, int index, int column);
void uvr(Execution& run, double value, int index, int column);
void tim(Execution& run, double value, int index, int column);
void tot(Execution& run, double value, int index, int column);
void rms(Execution& run, double value, int index, int column);
void rta(Execution& run, double value, int index, int column);
void rto(Execution& run, double value, int index, int column);
// records.cpp
void err(Execution& run, double value, int index, int column);
// variables.cpp
void rmn(Execution& run, double value, int index, int column);
// virtual.cpp
void ugf(Execution& run, double value, int index, int column);
void daw(Execution& run, double value, int index, int column);

}  // namespace servogate::program::nc110::variable
