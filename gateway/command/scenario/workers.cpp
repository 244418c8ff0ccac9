// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/scenario/workers.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "gateway/command/signals.hpp"

namespace servogate::gateway::command {

namespace {

struct Child {
  pid_t pid = -1;
  int out = -1;
  std::size_t piece = 0;
  std::string answer;
};

void write_all(int fd, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) ::_exit(111);
    at += static_cast<std::size_t>(n);
  }
}

Child begin(std::size_t piece, const std::function<std::string(std::size_t)>& work) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t pid = ::fork();
  if (pid < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (pid == 0) {
    ::close(ends[0]);
    write_all(ends[1], work(piece) + "\n");
    // What the parent has is the parent's: nothing of it is torn down here.
    ::_exit(0);
  }
  ::close(ends[1]);
  return {pid, ends[0], piece, {}};
}

/// False: it has said all.
bool read_some(Child& child) {
  char bytes[65536];
  const ssize_t n = ::read(child.out, bytes, sizeof bytes);
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  child.answer.append(bytes, static_cast<std::size_t>(n));
  return n > 0;
}

}  // namespace

bool work_beside(std::size_t count, int jobs, const std::function<std::string(std::size_t)>& work,
                 const std::function<void(std::size_t, std::string)>& take,
                 const std::function<void(std::size_t, const std::string& how)>& dead) {
  std::vector<Child> children;
  std::size_t next = 0;
  while (next < count || !children.empty()) {
    while (next < count && children.size() < static_cast<std::size_t>(jobs))
      children.push_back(begin(next++, work));
    std::vector<pollfd> waits;
    for (const Child& c : children) waits.push_back({c.out, POLLIN, 0});
    ::poll(waits.data(), waits.size(), 200);
    if (signals_seen() > 0) {
      for (const Child& c : children) ::kill(c.pid, SIGKILL), ::waitpid(c.pid, nullptr, 0), ::close(c.out);
      return false;
    }
    for (std::size_t n = children.size(); n-- > 0;) {
      if ((waits[n].revents & (POLLIN | POLLHUP)) == 0 || read_some(children[n])) continue;
      Child child = std::move(children[n]);
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(n));
      ::close(child.out);
      int status = 0;
      while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
      }
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && child.answer.ends_with('\n')) {
        child.answer.pop_back();
        take(child.piece, std::move(child.answer));
      } else {
        dead(child.piece, WIFSIGNALED(status) ? std::string("signal ") + ::strsignal(WTERMSIG(status))
                                              : "exit code " + std::to_string(WEXITSTATUS(status)));
      }
    }
  }
  return true;
}

}  // namespace servogate::gateway::command
