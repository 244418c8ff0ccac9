// SPDX-License-Identifier: Apache-2.0
#include "tests/shell/line.hpp"
#include "tests/places/places.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace servogate::shell {

namespace fs = std::filesystem;

std::string source(const std::string& path) { return tests::source_dir() + "/" + path; }

Desk::Desk() {
  std::string pattern = (fs::temp_directory_path() / "servogate-shell-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  folder_ = pattern;
}

Desk::~Desk() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Desk::write(const std::string& name, const std::string& content) const {
  std::ofstream(path(name), std::ios::binary) << content;
}

std::string Desk::text(const std::string& name) const {
  std::ifstream in(path(name), std::ios::binary);
  std::stringstream content;
  content << in.rdbuf();
  return content.str();
}

bool Desk::has(const std::string& name) const { return fs::exists(path(name)); }

Ended Desk::line(const std::string& line, const std::string& language) const {
  const std::string out = path(".out"), err = path(".err"), mill = source("examples/mill/machine.toml"),
                    bracket = source("examples/mill/bracket.nc");
  const pid_t pid = fork();
  if (pid == 0) {
    setpgid(0, 0);
    if (chdir(folder_.c_str()) != 0) _exit(126);
    dup2(open("/dev/null", O_RDONLY), 0);
    dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
    for (const char* variable : {"LC_ALL", "LC_MESSAGES", "SERVOGATE_SOCKET", "SERVOGATE_DEVICES"})
      unsetenv(variable);
    setenv("LANG", language.c_str(), 1);
    setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
    setenv("SG", tests::program().c_str(), 1);
    setenv("MILL", mill.c_str(), 1);
    setenv("BRACKET", bracket.c_str(), 1);
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  setpgid(pid, pid);
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  int status = 0;
  bool late = false;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (!late && std::chrono::steady_clock::now() > end) {
      late = true;
      kill(-pid, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  Ended ended;
  ended.code = late ? 124 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  ended.out = text(".out");
  ended.err = text(".err");
  return ended;
}

}  // namespace servogate::shell
