// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "gateway/control/server/protocol/caller.hpp"
#include "gateway/control/server/protocol/command.hpp"
#include "gateway/control/server/protocol/refusal.hpp"
#include "gateway/control/server/protocol/reply.hpp"
#include "machine/tables/exchange.hpp"

/// Rows of the tables of origins and tools as clients change them. People give and read diameters on diameter
/// axes; the tables hold radii.
namespace servogate::gateway {

class Resident;

machine::TableKind kind_of(ask::Table table);
/// Letters of the axes that programs move: those that a table may name.
std::vector<std::string> table_axes(const machine::MachineConfig& machine);

/// False: `problem` says what is wrong with the number or a value of the row.
/// Takes lengths in inches over into millimetres; false: a value is no length, and `problem` says so.
bool take_inches(const machine::MachineConfig& machine, ask::TableSet& wanted, FormProblem& problem);

bool check_row(const machine::MachineConfig& machine, const ask::TableSet& wanted, FormProblem& problem);
/// The row is in the table; false: `problem` says which are.
bool row_known(const program::Tables& tables, ask::Table table, int number, FormProblem& problem);
/// The axes of a row that is set by touching, as bits; 0 of one that is given in figures.
std::uint32_t touched_axes(const machine::MachineConfig& machine, const ask::TableSet& wanted);
/// The tables with the row as it was checked; what it does not name stays.
program::Tables with_row(Resident& resident, const ask::TableSet& wanted);
/// "X 100 mm, Z 12.5 mm (diameter)": a row as people read it.
std::string row_words(const machine::MachineConfig& machine, const program::Tables& tables, ask::Table table,
                      int number);
/// "origin", "tool" in both languages (text::both).
std::string table_word(ask::Table table);
TablesReport tables_report(Resident& resident);

}  // namespace servogate::gateway
