// SPDX-License-Identifier: Apache-2.0
#include "tests/server/rig/shell.hpp"
#include "tests/comes.hpp"
#include "tests/places/places.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace servogate::gateway::testing {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

pid_t launch(const fs::path& folder, const std::string& name, std::vector<std::string> arguments,
             const std::string& language) {
  arguments.insert(arguments.begin(), tests::program());
  const std::string out = (folder / (name + ".out")).string(), err = (folder / (name + ".err")).string();
  const std::string runtime = folder.string();
  const pid_t pid = fork();
  // Less than zero is everybody to kill().
  if (pid < 0) throw std::runtime_error("no process for " + name + ": " + std::strerror(errno));
  if (pid != 0) return pid;
  const int out_fd = open(out.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  const int err_fd = open(err.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  dup2(out_fd, STDOUT_FILENO);
  dup2(err_fd, STDERR_FILENO);
  // A standard input that stays open and silent, as a terminal's.
  int silent[2];
  if (pipe(silent) == 0) dup2(silent[0], STDIN_FILENO);
  setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
  for (const char* variable : {"LC_ALL", "LC_MESSAGES", "SERVOGATE_SOCKET"}) unsetenv(variable);
  setenv("LANG", language.c_str(), 1);
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

}  // namespace

int ending_of(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

json alarm_of(const json& status, int number) {
  for (const json& a : status["alarms"])
    if (a["number"] == number) return a;
  return nullptr;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Shell::Shell() {
  std::string pattern = (fs::temp_directory_path() / "servogate-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder " + pattern);
  folder_ = pattern;
}

Shell::~Shell() {
  if (up_ > 0) {
    kill(up_, SIGKILL);
    waitpid(up_, nullptr, 0);
  }
  if (::testing::Test::HasFailure()) std::fprintf(stderr, "%s", text("up.err").c_str());
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string Shell::example(const std::string& path) { return tests::source_dir() + "/examples/" + path; }

std::string Shell::text(const std::string& file) const {
  std::ifstream in(folder_ / file);
  std::stringstream content;
  content << in.rdbuf();
  return content.str();
}

// A computer that is held up for a tenth of a second makes a real-time control refuse a request as too old:
// whoever still means it sends it again.
Outcome Shell::run(const std::vector<std::string>& arguments, const std::string& language) {
  Outcome done;
  tests::comes([&] {
    done.exit = ending_of(launch(folder_, "run", arguments, language));
    done.out = text("run.out");
    done.err = text("run.err");
    return !contains(done.err, "before the control could carry it out");
  });
  return done;
}

pid_t Shell::spawn(const std::vector<std::string>& arguments, const std::string& name) {
  return launch(folder_, name, arguments, "C");
}

void Shell::up(const std::string& machine, const std::vector<std::string>& more) {
  name_ = machine == "mill"      ? "three-axis-mill.sock"
          : machine == "tapping" ? "mill-with-a-probe-and-rigid-tapping.sock"
                                 : "lathe-with-turret.sock";
  up_file(example(machine + "/machine.toml"), more);
}

void Shell::up_file(const std::string& machine, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"up", machine};
  arguments.insert(arguments.end(), more.begin(), more.end());
  up_ = spawn(arguments, "up");
  const bool online = until([](const json& s) {
    return std::none_of(s["axes"].begin(), s["axes"].end(),
                        [](const json& a) { return a["drive"] == "offline"; });
  });
  if (!online) throw std::runtime_error("the drives do not come: " + text("up.err"));
}

int Shell::wait() {
  const int code = ending_of(up_);
  up_ = -1;
  return code;
}

int Shell::end(int signal) {
  if (up_ <= 0) throw std::runtime_error("no control to be ended");
  kill(up_, signal);
  return wait();
}

std::optional<json> Shell::answer_to(const json& request) {
  SocketClient client;
  std::string answer;
  if (!client.connect(socket()).empty() || !client.exchange(request.dump(), answer)) return std::nullopt;
  return json::parse(answer);
}

json Shell::ask(const json& request) {
  std::optional<json> answer;
  tests::comes([&] {
    answer = answer_to(request);
    return !answer || answer->value("code", "") != "gate.too_old";
  });
  if (!answer) throw std::runtime_error("no control answers " + request.dump() + ": " + text("up.err"));
  return std::move(*answer);
}

json Shell::status() {
  json answer = ask({{"cmd", "status"}});
  if (!answer.contains("axes")) throw std::runtime_error("no status: " + answer.dump());
  return answer;
}

bool Shell::until(const std::function<bool(const json&)>& good) {
  return tests::comes([&] {
    const std::optional<json> now = answer_to({{"cmd", "status"}});
    if (now && now->contains("axes") && good(*now)) return true;
    siginfo_t ended{};
    const bool gone = !now && up_ > 0 &&
                      waitid(P_PID, static_cast<id_t>(up_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
                      ended.si_pid == up_;
    if (gone) throw std::runtime_error("the control has ended: " + text("up.err"));
    return false;
  });
}

json Shell::plc_value(const std::string& name) {
  const json answer = ask({{"cmd", "plc_watch"}, {"names", {name}}});
  return answer.value("ok", false) ? answer["values"][0]["value"] : json();
}

bool Shell::plc_becomes(const std::string& name, const json& wanted) {
  return until([&](const json&) { return plc_value(name) == wanted; });
}

void Shell::ready() {
  for (const char* command : {"power on", "home"}) {
    const Outcome done =
        command == std::string("home") ? run({"home", "--wait"}) : run({"power", "on", "--wait"});
    if (done.exit != 0) throw std::runtime_error(std::string(command) + ": " + done.err);
  }
}

}  // namespace servogate::gateway::testing
