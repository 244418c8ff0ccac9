// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/dispatch/request.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway {

namespace {

/// Writes what has been learned, then answers.
Work save_and(Resident& resident, Reply done, text::Language language) {
  const auto problem = std::make_shared<std::string>();
  Work work;
  work.what = "save", work.bench = Work::Bench::files;
  work.run = [&resident, saved = resident.to_save(), problem, done = std::move(done),
              language](const std::stop_token&) -> Finish {
    *problem = resident.write(saved);
    return [problem, done, language]() -> Outcome {
      return problem->empty() ? done : refuse(says::kNotSaved, {*problem}, kInfrastructure, language);
    };
  };
  return work;
}

}  // namespace

Outcome Dispatch::with_new_tables(const Reply& done) {
  Resident& resident = resident_;
  const Finish save = [&resident, done, language = language_] { return save_and(resident, done, language); };
  if (auto proof = resident.renew_tables()) return prove_and(resident, std::move(*proof), save);
  return save();
}

bool Dispatch::ask_for_tables(std::uint32_t touched) {
  image::Request r;
  r.kind = RequestKind::tables;
  r.index = touched;
  return ask(r);
}

Outcome Dispatch::take(const ask::TableSet& asked) {
  FormProblem problem;
  ask::TableSet wanted = asked;
  if (!take_inches(machine(), wanted, problem) || !check_row(machine(), wanted, problem))
    return fail(*problem.entry, problem.arguments, kWrongUse);
  if (!ask_for_tables(touched_axes(machine(), wanted))) return refusal_;
  resident_.change_tables(with_row(resident_, wanted));
  return with_new_tables(
      good(says::kRowSet, {table_word(*wanted.table), std::to_string(wanted.number),
                           row_words(machine(), resident_.tables(), *wanted.table, wanted.number)}));
}

Outcome Dispatch::take(const ask::TableClear& wanted) {
  FormProblem problem;
  if (!row_known(resident_.tables(), *wanted.table, wanted.number, problem))
    return fail(*problem.entry, problem.arguments, kWrongUse);
  if (!ask_for_tables(0)) return refusal_;
  program::Tables tables = resident_.tables();
  if (*wanted.table == ask::Table::origin)
    tables.origins.erase(wanted.number);
  else
    tables.correctors.erase(wanted.number);
  resident_.change_tables(std::move(tables));
  return with_new_tables(good(says::kRowCleared, {table_word(*wanted.table), std::to_string(wanted.number)}));
}

Outcome Dispatch::take(const ask::TableUndo&) {
  if (!ask_for_tables(0)) return refusal_;
  if (!resident_.undo_tables()) return fail(says::kNoUndo, {}, kAlarm);
  return with_new_tables(good(says::kTablesUndone));
}

Outcome Dispatch::take(const ask::TableImport& wanted) {
  std::string why;
  const auto content = files::read_file(wanted.file, files::kMostOfSettings, why);
  if (!content) return fail(says::kNotReadable, {wanted.file, why}, kWrongUse);
  program::Tables tables = resident_.tables();
  FoundIn found;
  if (!machine::read_exchange(*content, wanted.file, kind_of(*wanted.table), table_axes(machine()), tables,
                              found.findings)) {
    Reply refused = fail(says::kNotImported, {wanted.file}, kWrongUse);
    refused.text = with_findings(says::kNotImported, wanted.file, found.findings);
    refused.content = std::move(found);
    return refused;
  }
  if (!ask_for_tables(0)) return refusal_;
  const std::size_t rows =
      *wanted.table == ask::Table::origin ? tables.origins.size() : tables.correctors.size();
  resident_.change_tables(std::move(tables));
  return with_new_tables(good(says::kImported, {wanted.file, std::to_string(rows)}));
}

Outcome Dispatch::take(const ask::TableExport& wanted) {
  const std::vector<std::string> axes = table_axes(machine());
  return looked(ExportedTable{wanted.linuxcnc
                                  ? machine::to_linuxcnc(resident_.tables(), axes)
                                  : machine::to_csv(resident_.tables(), kind_of(*wanted.table), axes)});
}

}  // namespace servogate::gateway
