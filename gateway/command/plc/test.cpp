// SPDX-License-Identifier: Apache-2.0
#include "plc/testing/run_tests.hpp"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/junit.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/sources.hpp"
#include "machine/consequences.hpp"
#include "machine/files/read_file.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;
namespace testing = plc::testing;

const text::Entry kNoTestFile{"plc-test.none", "none of the files is a test: their names end in .test",
                              "среди файлов нет тестов: их имена оканчиваются на .test"};
const text::Entry kNoSource{
    "plc-test.no-source",
    "{0} names no PLC program: give it a 'source' or 'machine' line, or name the program",
    "{0} не называет программу ПЛК: добавьте строку source или machine, либо назовите её"};
const text::Entry kPassed{"plc-test.passed", "passed: {0}", "пройден: {0}"};
const text::Entry kFailed{"plc-test.failed", "FAILED: {0}", "НЕ ПРОЙДЕН: {0}"};
const text::Entry kSummary{"plc-test.summary", "{0} tests, {1} failed", "тестов: {0}, не пройдено: {1}"};

bool is_test(const std::string& file) { return std::filesystem::path(file).extension() == ".test"; }

std::string beside(const std::string& file, const std::string& path) {
  const std::filesystem::path p(path);
  return p.is_absolute() ? path : (std::filesystem::path(file).parent_path() / p).lexically_normal().string();
}

/// All test files of one call.
class Tests {
 public:
  explicit Tests(const PlcTestOptions& options) : options_(options) {
    for (const std::string& file : options.files) (is_test(file) ? tests_ : sources_).push_back(file);
  }
  int run();

 private:
  /// kDone: its tests have been run, whatever came out.
  int run_file(const std::string& path);
  void tell(const std::string& path, const testing::Outcome& outcome);

  const PlcTestOptions& options_;
  std::vector<std::string> tests_, sources_;
  json told_ = json::array();
  std::vector<JUnitCase> cases_;
  int failed_ = 0;
};

int Tests::run_file(const std::string& path) {
  std::string reason;
  const auto content = files::read_file(path, files::kMostOfSource, reason);
  if (!content) {
    print_findings({{text::Severity::error, path, 1, 1, &kCannotRead, {reason}}});
    return kWrongUse;
  }
  const testing::TestFile file = testing::read_test_file(path, *content);
  if (!file.ok()) {
    print_findings(file.findings);
    return kAlarm;
  }
  const std::string machine = !options_.machine.empty()   ? options_.machine
                              : file.machine.text.empty() ? ""
                                                          : beside(path, file.machine.text);
  PlcSurroundings surroundings;
  if (!read_surroundings(machine, surroundings)) return kWrongUse;
  std::vector<std::string> names = sources_;
  for (const testing::Word& source : file.sources) names.push_back(beside(path, source.text));
  if (names.empty()) names = surroundings.sources;
  if (names.empty()) {
    complain(kNoSource, {path});
    return kWrongUse;
  }
  std::vector<plc::SourceFile> sources;
  if (!read_sources(names, sources)) return kWrongUse;
  const plc::CompileResult compiled =
      plc::compile(std::move(sources), surroundings.symbols, surroundings.options);
  print_findings(compiled.findings);
  if (!compiled.ok()) return kWrongUse;
  for (const testing::Outcome& outcome :
       testing::run_tests(file, compiled.image, surroundings.symbols, surroundings.options))
    tell(path, outcome);
  return kDone;
}

void Tests::tell(const std::string& path, const testing::Outcome& outcome) {
  if (!outcome.passed()) ++failed_;
  JUnitCase c;
  c.classname = c.file = path;
  c.name = outcome.name;
  c.line = outcome.line;
  c.result = outcome.passed() ? JUnitCase::Result::passed : JUnitCase::Result::failed;
  c.type = "expectation";
  c.properties = {{"virtual_time", text::number(static_cast<double>(outcome.time_ns) * 1e-9, 3)}};
  for (const text::Finding& f : outcome.findings) c.message += (c.message.empty() ? "" : "\n") + f.str();
  cases_.push_back(std::move(c));
  told_.push_back({{"file", path},
                   {"line", outcome.line},
                   {"name", outcome.name},
                   {"passed", outcome.passed()},
                   {"scans", outcome.scans},
                   {"time_ms", static_cast<double>(outcome.time_ns) * 1e-6},
                   {"findings", json::parse(machine::to_json(outcome.findings), nullptr, false)}});
  if (!options_.json)
    print_line(text::render(outcome.passed() ? kPassed : kFailed, std::vector<std::string>{outcome.name},
                            text::user_language()));
  print_findings(outcome.findings);
}

int Tests::run() {
  if (tests_.empty()) {
    complain(kNoTestFile, {});
    return kWrongUse;
  }
  int code = kDone;
  for (const std::string& path : tests_) code = std::max(code, run_file(path));
  if (options_.json)
    print_exact(json{{"schema", 1}, {"tests", told_}, {"failed", failed_}}.dump(
        -1, ' ', false, json::error_handler_t::replace));
  else
    print_line(text::render(kSummary,
                            std::vector<std::string>{std::to_string(told_.size()), std::to_string(failed_)},
                            text::user_language()));
  if (!options_.junit.empty())
    if (const std::string error = report::write_file(options_.junit, junit("servogate plc test", cases_));
        !error.empty()) {
      complain(kCannotWrite, {options_.junit, error});
      return kInfrastructure;
    }
  return code != kDone ? code : failed_ > 0 ? kAlarm : kDone;
}

}  // namespace

int plc_test(const PlcTestOptions& options) { return Tests(options).run(); }

}  // namespace servogate::gateway::command
