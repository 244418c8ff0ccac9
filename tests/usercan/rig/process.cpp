// SPDX-License-Identifier: Apache-2.0
#include "tests/usercan/rig/process.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/comes.hpp"
#include "tests/places/places.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {

Process::Process(const std::vector<std::string>& arguments) : file_(scratch("said")) {
  std::vector<std::string> words = {tests::program()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int out = open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_ = fork();
  if (pid_ == 0) {
    setenv("LC_ALL", "C", 1);
    dup2(open("/dev/null", O_RDONLY), 0);
    dup2(out, 1);
    dup2(out, 2);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(out);
}

Process::~Process() {
  if (pid_ <= 0) return;
  signal(SIGTERM);
  wait();
}

bool Process::says(const std::string& text) const {
  return tests::comes([&] { return said().find(text) != std::string::npos; });
}

int Process::wait() {
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool Process::ended() const {
  if (pid_ <= 0) return true;
  siginfo_t seen{};
  return waitid(P_PID, static_cast<id_t>(pid_), &seen, WEXITED | WNOHANG | WNOWAIT) != 0 || seen.si_pid != 0;
}

void Process::signal(int number) const { kill(pid_, number); }

std::string Process::said() const { return content(file_); }

std::string Process::life() {
  int status = 0;
  if (pid_ <= 0) return "has been waited for; it said: " + said();
  if (waitpid(pid_, &status, WNOHANG) == 0) return "lives; it said: " + said();
  pid_ = -1;
  const std::string how = WIFSIGNALED(status) ? "by signal " + std::to_string(WTERMSIG(status))
                                              : "with code " + std::to_string(WEXITSTATUS(status));
  return "has ended " + how + "; it said: " + said();
}

}  // namespace servogate::usercan
