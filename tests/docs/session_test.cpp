// SPDX-License-Identifier: Apache-2.0
// What the documents show of a terminal is what the terminal shows: every `$ servogate` of them that needs no
// running control is run, and its lines are compared. `...` stands for any lines. Documents of docs/ru/ show
// the program in Russian. Behind `$ servogate up ... --virtual --speed N` the control of the page is there,
// and its clients are run as well.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "tests/places/places.hpp"

namespace servogate::docs {
namespace {

namespace fs = std::filesystem;

struct Shown {
  std::string command;
  std::vector<std::string> lines;
  std::string place;  ///< document:line
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

std::string content(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Commands behind `$ ` in fenced blocks, each with the lines up to the next one.
std::vector<Shown> shown_in(const std::string& document) {
  std::vector<Shown> out;
  bool fenced = false, open = false;
  int number = 0;
  for (const std::string& line : lines_of(content(fs::path(tests::source_dir()) / document))) {
    ++number;
    if (line.starts_with("```")) {
      fenced = !fenced;
      open = false;
    } else if (fenced && line.starts_with("$ ")) {
      out.push_back({line.substr(2), {}, document + ":" + std::to_string(number)});
      open = true;
    } else if (open) {
      out.back().lines.push_back(line);
    }
  }
  return out;
}

/// The files that a document lists: NAME and the fenced block behind a line "`NAME`:".
std::map<std::string, std::string> listings(const std::string& document) {
  std::map<std::string, std::string> out;
  std::string name;
  bool fenced = false;
  for (const std::string& line : lines_of(content(fs::path(tests::source_dir()) / document))) {
    if (line.starts_with("```")) {
      fenced = !fenced;
      if (!fenced) name.clear();
    } else if (!fenced) {
      const bool named = line.size() > 3 && line.front() == '`' && line.ends_with("`:");
      if (named || !line.empty()) name = named ? line.substr(1, line.size() - 3) : "";
    } else if (!name.empty()) {
      out[name] += line + "\n";
    }
  }
  return out;
}

bool matches(const std::vector<std::string>& shown, const std::vector<std::string>& real, std::size_t s = 0,
             std::size_t r = 0) {
  for (; s < shown.size(); ++s, ++r) {
    if (shown[s] == "...") {
      for (std::size_t rest = r; rest <= real.size(); ++rest)
        if (matches(shown, real, s + 1, rest)) return true;
      return false;
    }
    if (r >= real.size() || shown[s] != real[r]) return false;
  }
  return r == real.size();
}

/// Progress in a pipe comes every ten seconds, and so on slow computers only.
bool is_progress(const std::string& line) {
  return line.ends_with(" s left") || line.find(", осталось около ") != std::string::npos;
}

/// A folder like the source tree's top, with what the documents let their reader make.
class Terminal {
 public:
  explicit Terminal(const std::string& document) {
    std::string pattern = (fs::temp_directory_path() / "servogate-docs-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    const fs::path tree = tests::source_dir();
    fs::create_directory_symlink(tree / "examples", folder_ / "examples");
    for (const auto& [name, text] : listings(document)) std::ofstream(folder_ / name) << text;
    fs::create_directory(folder_ / "my");
    fs::copy_file(tree / "examples/mill/mill.st", folder_ / "my/mill.st");
    fs::copy_file(tree / "examples/mill/machine.toml", folder_ / "my/machine.toml");
    const std::vector<std::string> machine = lines_of(content(tree / "examples/mill/machine.toml"));
    std::ofstream wrong(folder_ / "my/wrong.toml"), no_brake(folder_ / "my/nobrake.toml");
    bool brake = false;
    for (std::size_t i = 0; i < machine.size(); ++i) {
      const std::map<std::size_t, std::string> changed{
          {55, "max_velocity = \"500 mm\""}, {89, "lead = \"5 mm/rev\""}, {146, "brakes = true"}};
      const auto found = changed.find(i + 1);
      wrong << (found != changed.end() ? found->second : machine[i]) << "\n";
      if (machine[i].starts_with("[")) brake = machine[i] == "[axis.brake]";
      if (!brake) no_brake << machine[i] << "\n";
    }
  }
  ~Terminal() {
    if (up_) run("servogate down", "C");
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  bool up() const { return up_; }
  /// Starts a control, which goes on, and waits until it answers.
  void begin(const std::string& command, const std::string& language) {
    up_ = true;
    run(command +
            " --state state > up.log 2>&1 & for n in $(seq 600); do servogate status > /dev/null 2>&1 && "
            "break; "
            "sleep 0.1; done",
        language);
  }
  std::vector<std::string> run(const std::string& command, const std::string& language) const {
    const std::string line = "cd '" + folder_.string() + "' && export XDG_RUNTIME_DIR='" + folder_.string() +
                             "' LANG=" + language + " LC_ALL=" + language + " PATH=\"" +
                             fs::path(tests::program()).parent_path().string() + ":$PATH\" && { " + command +
                             "; } 2>&1";
    std::string out;
    std::FILE* pipe = popen(line.c_str(), "r");
    if (pipe == nullptr) return {};
    char buffer[4096];
    for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
    pclose(pipe);
    std::vector<std::string> lines = lines_of(out);
    std::erase_if(lines, is_progress);
    return lines;
  }

 private:
  fs::path folder_;
  bool up_ = false;
};

bool starts_control(const std::string& command) {
  return command.starts_with("servogate up ") && command.find(" --speed ") != std::string::npos;
}

bool needs_no_control(const std::string& command) {
  for (const char* begin : {"sed -i ", "servogate run ", "servogate check ", "servogate canon ",
                            "servogate replay ", "servogate plc ", "servogate test ", "servogate chek "})
    if (command.starts_with(begin)) return command.find("--realtime") == std::string::npos;
  return false;
}

std::string language_of(const std::string& document) {
  return document.starts_with("docs/ru/") ? "ru_RU.UTF-8" : "C";
}

/// Every page that shows a session that can be run.
constexpr const char* kPages[] = {
    "docs/command-line.md",  "docs/command-line-tutorial.md", "docs/plc-tutorial.md",
    "docs/first-machine.md", "docs/trace-and-report.md",      "docs/dialects/nc110.md",
    "docs/first-alarm.md",   "docs/machine-tests-in-ci.md",   "docs/testing.md",
    "docs/ru/testing.md",    "docs/ru/first-machine.md",      "docs/ru/dialects/nc110.md"};

class Documents : public ::testing::TestWithParam<const char*> {};

TEST_P(Documents, show_what_the_program_says) {
  Terminal terminal(GetParam());
  int run = 0;
  for (const Shown& shown : shown_in(GetParam())) {
    if (starts_control(shown.command)) {
      terminal.begin(shown.command, language_of(GetParam()));
      continue;
    }
    const bool of_client = terminal.up() && shown.command.starts_with("servogate ");
    if (!needs_no_control(shown.command) && !of_client) continue;
    ++run;
    const std::vector<std::string> real = terminal.run(shown.command, language_of(GetParam()));
    std::string text;
    for (const std::string& line : real) text += line + "\n";
    EXPECT_TRUE(matches(shown.lines, real)) << shown.place << ": $ " << shown.command << "\n" << text;
  }
  EXPECT_GE(run, 1);
}

INSTANTIATE_TEST_SUITE_P(All, Documents, ::testing::ValuesIn(kPages), [](const auto& document) {
  std::string name = fs::path(document.param).relative_path().replace_extension();
  name.erase(0, std::string("docs/").size());
  for (char& c : name) c = c == '-' || c == '/' ? '_' : c;
  return name;
});

TEST(Documents, in_russian_are_compared_with_a_program_that_speaks_russian) {
  const Terminal terminal("docs/ru/safety.md");
  const std::string command = "servogate check nowhere.toml";
  EXPECT_NE(terminal.run(command, language_of("docs/ru/safety.md")),
            terminal.run(command, language_of("docs/safety.md")));
}

TEST(Documents, with_a_session_are_all_run) {
  const fs::path tree = tests::source_dir();
  for (const auto& entry : fs::recursive_directory_iterator(tree / "docs")) {
    if (entry.path().extension() != ".md") continue;
    const std::string document = fs::relative(entry.path(), tree).string();
    const std::vector<Shown> shown = shown_in(document);
    const bool session = std::any_of(shown.begin(), shown.end(), [](const Shown& s) {
      return needs_no_control(s.command) || starts_control(s.command);
    });
    EXPECT_EQ(session, std::find(std::begin(kPages), std::end(kPages), document) != std::end(kPages))
        << document;
  }
}

TEST(Documents, a_line_that_is_not_there_would_be_noticed) {
  EXPECT_TRUE(matches({"a", "...", "c"}, {"a", "b", "b", "c"}));
  EXPECT_TRUE(matches({"a", "..."}, {"a"}));
  EXPECT_FALSE(matches({"a", "...", "c"}, {"a", "b"}));
  EXPECT_FALSE(matches({"a"}, {"a", "b"}));
  EXPECT_FALSE(matches({}, {"a"}));
  EXPECT_TRUE(listings("docs/command-line.md").contains("blink.st"));
}

}  // namespace
}  // namespace servogate::docs
