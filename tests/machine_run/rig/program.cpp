// SPDX-License-Identifier: Apache-2.0
#include "tests/machine_run/rig/program.hpp"
#include "tests/places/places.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace servogate::machine_run {

Scratch::Scratch() {
  std::string pattern = (std::filesystem::temp_directory_path() / "servogate-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  folder_ = pattern;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string Scratch::write(std::string_view name, std::string_view content) const {
  std::ofstream(path(name), std::ios::binary) << content;
  return path(name);
}

std::string read_all(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  std::ostringstream out;
  out << in.rdbuf();
  return std::move(out).str();
}

std::string source(std::string_view path) { return tests::source_dir() + "/" + std::string(path); }

std::string mill_file() { return source("examples/mill/machine.toml"); }

std::string changed_mill(const Scratch& scratch, const std::string& from, const std::string& to) {
  std::filesystem::copy_file(source("examples/mill/mill.st"), scratch.path("mill.st"),
                             std::filesystem::copy_options::overwrite_existing);
  std::string text = read_all(mill_file());
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  return scratch.write("machine.toml", text);
}

Program::Program(const std::vector<std::string>& arguments, const Environment& environment) {
  std::vector<std::string> all{tests::program()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& a : all) argv.push_back(a.data());
  argv.push_back(nullptr);
  const std::string out = scratch_.path("out"), err = scratch_.path("err");
  pid_ = fork();
  if (pid_ != 0) return;
  setenv("LANG", "C", 1);
  unsetenv("LC_ALL");
  for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
  dup2(open("/dev/null", O_RDONLY), 0);
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
  execv(argv[0], argv.data());
  _exit(127);
}

Program::~Program() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

void Program::signal(int number) const { kill(pid_, number); }

Ending Program::wait() {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  int status = 0;
  while (waitpid(pid_, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) kill(pid_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  pid_ = -1;
  Ending e;
  e.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  e.out = read_all(scratch_.path("out"));
  e.err = read_all(scratch_.path("err"));
  return e;
}

Ending servogate(const std::vector<std::string>& arguments, const Environment& environment) {
  return Program(arguments, environment).wait();
}

TraceFile::TraceFile(const std::string& path) {
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  std::string line;
  std::getline(in, line);
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) names_.push_back(name);
  while (std::getline(in, line)) {
    std::vector<double> row;
    row.reserve(names_.size());
    const char* at = line.c_str();
    for (char* end = nullptr; *at != '\0'; at = *end == ',' ? end + 1 : end) {
      row.push_back(std::strtod(at, &end));
      if (end == at) break;
    }
    EXPECT_EQ(row.size(), names_.size()) << path << " row " << rows_.size();
    row.resize(names_.size());
    rows_.push_back(std::move(row));
  }
}

std::size_t TraceFile::column(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  EXPECT_NE(found, names_.end()) << name;
  return found == names_.end() ? 0 : static_cast<std::size_t>(found - names_.begin());
}

}  // namespace servogate::machine_run
