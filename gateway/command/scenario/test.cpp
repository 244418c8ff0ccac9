// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "bench/scenario/reading/read_scenario.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/scenario/one_run.hpp"
#include "gateway/command/scenario/results.hpp"
#include "gateway/command/scenario/session.hpp"
#include "gateway/command/scenario/shrink.hpp"
#include "gateway/command/scenario/workers.hpp"
#include "gateway/command/signals.hpp"
#include "machine/files/output_files.hpp"
#include "machine/files/read_file.hpp"
#include "report/html.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;
using scenario::Scenario;
using Status = scenario::Outcome::Status;
using Clock = std::chrono::steady_clock;

const text::Entry kNoPath{"test.no_path", "name scenario files or directories, or --session MACHINE",
                          "назовите файлы или каталоги сценариев либо --session СТАНОК"};
const text::Entry kNone{"test.none", "no scenario found in {0}: their files end in .scenario.toml",
                        "в {0} нет сценариев: их файлы оканчиваются на .scenario.toml"};
const text::Entry kNoneChosen{"test.none_chosen", "no scenario of {0} has this name, tag and shard",
                              "ни один из {0} сценариев не подходит по имени, тегу и доле"};
const text::Entry kBadShard{"test.shard", "--shard is I/N with 1 <= I <= N, not \"{0}\"",
                            "--shard пишется I/N, где 1 <= I <= N, а не «{0}»"};
const text::Entry kPassed{"test.passed", "ok      {0} ({1} s)", "успех   {0} ({1} с)"};
const text::Entry kSkipped{"test.skipped", "skipped {0}: {1}", "пропуск {0}: {1}"};
const text::Entry kFailed{"test.failed", "FAILED  {0}:{1}: {2}\n{3}", "ПРОВАЛ  {0}:{1}: {2}\n{3}"};
const text::Entry kError{"test.error", "ERROR   {0}:{1}: {2}\n{3}", "ОШИБКА  {0}:{1}: {2}\n{3}"};
const text::Entry kAgain{"test.again", "  again: {0}", "  повторить: {0}"};
const text::Entry kWritten{"test.written", "  written: {0}", "  записано: {0}"};
const text::Entry kSmallest{"test.smallest", "  the smallest time line that fails:\n{0}",
                            "  наименьший ход событий с тем же провалом:\n{0}"};
const text::Entry kSummary{
    "test.summary",
    "{0} scenarios: {1} passed, {2} failed, {3} skipped, {4} errors; {5} s of machine time in {6} s",
    "сценариев {0}: успешно {1}, провалов {2}, пропущено {3}, ошибок {4}; {5} с машинного времени за {6} с"};
const text::Entry kProgress{"test.progress", "{0} of {1}, {2} failed", "{0} из {1}, провалов {2}"};
const text::Entry kDied{"test.died", "the process of the scenario ended by {0}",
                        "процесс сценария завершился: {0}"};
const text::Entry kSeed{"test.seed", "seed {0}: the same scenarios again with --seed {0}",
                        "зерно {0}: те же сценарии снова с --seed {0}"};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

std::string indented(const std::string& words) {
  std::string out;
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find('\n', at), words.size());
    out += (out.empty() ? "  " : "\n  ") + words.substr(at, end - at);
    at = end + 1;
  }
  return out;
}

/// Files of scenarios, sorted; a folder is searched through.
std::vector<std::string> files_in(const std::vector<std::string>& paths) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> found;
    for (fs::recursive_directory_iterator it(path, fs::directory_options::skip_permission_denied, error), end;
         it != end; it.increment(error)) {
      if (error) break;
      if (it->path().filename().string().ends_with(".scenario.toml"))
        found.push_back(it->path().lexically_normal().string());
    }
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

/// A name for files of a scenario.
std::string slug(const std::string& name) {
  std::string out;
  for (const char c : name)
    out +=
        std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ? c : '-';
  return out.substr(0, 120);
}

std::string seconds(double s) { return text::number(s, s < 10.0 ? 2 : 1); }

class Tests {
 public:
  explicit Tests(const TestOptions& options) : options_(options) {}

  int run() {
    if (const int code = read(); code != kDone) return code;
    if (options_.list) return list();
    if (const int code = check_files(); code != kDone) return code;
    count_signals();
    const auto begin = Clock::now();
    all_.results.resize(all_.scenarios.size());
    const bool whole = work_beside(
        all_.scenarios.size(), jobs(), [this](std::size_t n) { return carry_out(n); },
        [this](std::size_t n, const std::string& answer) { take(n, answer); },
        [this](std::size_t n, const std::string& how) {
          all_.results[n].message = say(kDied, {how});
          tell_of(n);
        });
    end_line();
    all_.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
    if (!whole) return kStopped;
    return finish();
  }

 private:
  int jobs() const {
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());
    return options_.jobs > 0 ? options_.jobs : std::max(1, cores);
  }

  int read() {
    const std::uint64_t seed = options_.seed.value_or(std::random_device{}());
    const std::vector<std::string> files = files_in(options_.paths);
    std::vector<text::Finding> findings;
    bool drawn = false;
    for (const std::string& file : files) {
      std::string why;
      const auto content = files::read_file(file, files::kMostOfSettings, why);
      if (!content) {
        findings.push_back({text::Severity::error, file, 1, 1, &kCannotRead, {file, why}});
        continue;
      }
      for (Scenario& s : scenario::read_scenarios(file, *content, seed, findings)) {
        drawn = drawn || s.seed.has_value();
        all_.scenarios.push_back(std::move(s));
      }
    }
    if (print_findings(findings) > 0) return kWrongUse;
    const std::size_t found = all_.scenarios.size();
    std::string where;
    for (const std::string& path : options_.paths) where += (where.empty() ? "" : ", ") + path;
    if (found == 0) {
      complain(kNone, {where});
      return kWrongUse;
    }
    if (!choose()) return kWrongUse;
    if (all_.scenarios.empty()) {
      complain(kNoneChosen, {std::to_string(found)});
      return kWrongUse;
    }
    if (drawn && !options_.seed) tell(say(kSeed, {std::to_string(seed)}));
    return kDone;
  }

  /// By name, tag and shard; false: wrong use, which has been said.
  bool choose() {
    std::erase_if(all_.scenarios, [&](const Scenario& s) {
      const bool tagged =
          options_.tags.empty() || std::any_of(s.tags.begin(), s.tags.end(), [&](const std::string& tag) {
            return std::find(options_.tags.begin(), options_.tags.end(), tag) != options_.tags.end();
          });
      return !tagged || (!options_.name.empty() && s.name.find(options_.name) == std::string::npos);
    });
    if (options_.shard.empty()) return true;
    int part = 0, parts = 0;
    char more = 0;
    if (std::sscanf(options_.shard.c_str(), "%d/%d%c", &part, &parts, &more) != 2 || part < 1 ||
        part > parts) {
      complain(kBadShard, {options_.shard});
      return false;
    }
    std::vector<Scenario> mine;
    for (std::size_t n = 0; n < all_.scenarios.size(); ++n)
      if (n % static_cast<std::size_t>(parts) == static_cast<std::size_t>(part - 1))
        mine.push_back(std::move(all_.scenarios[n]));
    all_.scenarios = std::move(mine);
    return true;
  }

  int list() {
    for (const Scenario& s : all_.scenarios)
      if (!print_line(s.file + ": " + s.name)) break;
    return kDone;
  }

  int check_files() const {
    std::vector<files::NamedPath> inputs;
    for (const Scenario& s : all_.scenarios) inputs.push_back({text::both("a scenario", "сценарий"), s.file});
    auto problem = files::problem_of_outputs(
        {{"--junit", options_.junit}, {"--json", options_.json}, {"--trace-table", options_.trace_table}},
        inputs);
    if (!problem && !options_.artifacts.empty()) problem = files::problem_of_folder(options_.artifacts);
    if (!problem) return kDone;
    complain(*problem->entry, problem->arguments);
    return problem->wrong_use ? kWrongUse : kInfrastructure;
  }

  // In a process of its own.
  std::string carry_out(std::size_t n) const {
    const Scenario& s = all_.scenarios[n];
    const auto begin = Clock::now();
    const scenario::Outcome outcome = run_one(s, options_);
    const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
    json answer{{"status", static_cast<int>(outcome.status)},
                {"message", text::in_language(outcome.message)},
                {"line", outcome.at.line},
                {"t", outcome.t_s},
                {"virtual", outcome.virtual_s},
                {"wall", wall_s},
                {"diagram", outcome.diagram},
                {"findings", json::array()},
                {"artifacts", json::array()},
                {"smallest", ""}};
    for (const text::Finding& f : outcome.findings)
      if (f.severity == text::Severity::error) answer["findings"].push_back(f.str());
    const bool drawn =
        std::any_of(s.steps.begin(), s.steps.end(), [](const scenario::Step& step) { return step.drawn; });
    Scenario shown = s;
    if (outcome.status == Status::failed && options_.shrink && drawn) {
      shown = shrink(
          s, [this](const Scenario& tried) { return run_one(tried, options_).status == Status::failed; });
      answer["smallest"] = drawn_steps(shown);
    }
    if (outcome.status == Status::failed && !options_.artifacts.empty()) {
      std::error_code error;
      std::filesystem::create_directories(options_.artifacts, error);
      const std::string base = (std::filesystem::path(options_.artifacts) / slug(s.name)).string();
      const Outputs outputs{.trace = base + ".csv", .report = {}, .html = base + ".html"};
      run_one(shown, options_, outputs);
      for (const std::string& file : {outputs.trace, outputs.html})
        if (std::filesystem::exists(file, error)) answer["artifacts"].push_back(file);
    }
    return answer.dump(-1, ' ', false, json::error_handler_t::replace);
  }

  void take(std::size_t n, const std::string& line) {
    const json answer = json::parse(line, nullptr, false);
    Result& r = all_.results[n];
    r.status = static_cast<Status>(answer.value("status", static_cast<int>(Status::infrastructure)));
    r.message = answer.value("message", "");
    r.line = answer.value("line", 0);
    r.t_s = answer.value("t", 0.0);
    r.virtual_s = answer.value("virtual", 0.0);
    r.wall_s = answer.value("wall", 0.0);
    r.diagram = answer.value("diagram", "");
    r.findings = answer.value("findings", std::vector<std::string>{});
    r.artifacts = answer.value("artifacts", std::vector<std::string>{});
    r.smallest = answer.value("smallest", "");
    tell_of(n);
  }

  void tell_of(std::size_t n) {
    ++done_;
    const Scenario& s = all_.scenarios[n];
    const Result& r = all_.results[n];
    const bool good = r.status == Status::passed || r.status == Status::skipped;
    if (!good) ++failed_;
    const bool person = !options_.tap;
    if (!good) {
      end_line();
      std::string words = indented(r.message);
      for (const std::string& finding : r.findings) words += (words.empty() ? "" : "\n") + indented(finding);
      std::string block = say(r.failed() ? kFailed : kError,
                              {s.file, std::to_string(r.line > 0 ? r.line : s.at.line), s.name, words});
      if (!r.diagram.empty()) block += "\n" + indented(r.diagram);
      if (!r.smallest.empty()) block += "\n" + say(kSmallest, {indented(r.smallest)});
      block += "\n" + say(kAgain, {again(s)});
      for (const std::string& file : r.artifacts) block += "\n" + say(kWritten, {file});
      person ? static_cast<void>(print_line(block)) : tell(block);
      annotate(s, r);
    } else if (person && !options_.quiet && !terminal_) {
      print_line(r.status == Status::skipped ? say(kSkipped, {s.name, r.message})
                                             : say(kPassed, {s.name, seconds(r.virtual_s)}));
    }
    progress();
  }

  /// As hosts of continuous integration show it beside the line.
  void annotate(const Scenario& s, const Result& r) const {
    const char* const host = std::getenv("GITHUB_ACTIONS");
    if (host == nullptr || options_.tap) return;
    std::string message = s.name + ": " + r.message;
    for (const auto& [from, to] : {std::pair{"%", "%25"}, {"\r", "%0D"}, {"\n", "%0A"}})
      for (std::size_t at = 0; (at = message.find(from, at)) != std::string::npos; at += 3)
        message.replace(at, 1, to);
    print_line("::error file=" + s.file + ",line=" + std::to_string(r.line > 0 ? r.line : s.at.line) +
               "::" + message);
  }

  void progress() {
    if (options_.quiet || !terminal_) return;
    std::fprintf(stderr, "\r\x1b[K%s",
                 say(kProgress,
                     {std::to_string(done_), std::to_string(all_.scenarios.size()), std::to_string(failed_)})
                     .c_str());
    line_open_ = true;
  }
  void end_line() {
    if (line_open_) std::fprintf(stderr, "\r\x1b[K");
    line_open_ = false;
  }

  int finish() {
    const int impossible = all_.count(Status::impossible),
              infrastructure = all_.count(Status::infrastructure);
    double virtual_s = 0.0;
    for (const Result& r : all_.results) virtual_s += r.virtual_s;
    const std::string summary = say(
        kSummary, {std::to_string(all_.results.size()), std::to_string(all_.count(Status::passed)),
                   std::to_string(all_.count(Status::failed)), std::to_string(all_.count(Status::skipped)),
                   std::to_string(impossible + infrastructure), seconds(virtual_s), seconds(all_.wall_s)});
    if (options_.tap)
      print(to_tap(all_));
    else
      print_line(summary);
    bool written = true;
    const auto write = [&](const std::string& path, const std::string& content) {
      if (path.empty()) return;
      if (const std::string error = report::write_file(path, content); !error.empty()) {
        complain(kCannotWrite, {path, error});
        written = false;
      }
    };
    write(options_.junit, to_junit(all_));
    write(options_.json, to_json(all_));
    write(options_.trace_table, trace_table(all_));
    if (impossible > 0) return kWrongUse;
    if (infrastructure > 0 || !written) return kInfrastructure;
    return all_.count(Status::failed) > 0 ? kAlarm : kDone;
  }

  const TestOptions& options_;
  Results all_;
  std::size_t done_ = 0, failed_ = 0;
  const bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  bool line_open_ = false;
};

}  // namespace

int test(const TestOptions& options) {
  if (!options.session.empty()) return session(options.session);
  if (!options.paths.empty()) return Tests(options).run();
  complain(kNoPath, {});
  return kWrongUse;
}

}  // namespace servogate::gateway::command
