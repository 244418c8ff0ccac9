// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "gateway/cli/options.hpp"

/// `servogate origin` and `servogate tool`: rows of the two tables of a running control.
namespace servogate::gateway::command {

bool is_table_command(const ClientOptions& options);
/// Fills the request of such a command; null after saying what is wrong with its words.
nlohmann::json table_request(const ClientOptions& options, nlohmann::json request);
/// Prints the table that the command is about.
/// A row of the answer to `tables` as people read it; empty: it has none, or nothing is set in it.
std::string table_row_words(const std::string& table, int number, const nlohmann::json& reply);
void print_table(const ClientOptions& options, const nlohmann::json& reply);
/// Writes what `export` got into its file, `-`: standard output. An exit code.
int write_export(const ClientOptions& options, const nlohmann::json& reply);

}  // namespace servogate::gateway::command
