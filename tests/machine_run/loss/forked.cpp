// SPDX-License-Identifier: Apache-2.0
#include "tests/machine_run/loss/forked.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>

namespace servogate::machine_run {

namespace {

void write_all(int to, const std::string& words) {
  for (std::size_t done = 0; done < words.size();) {
    const ssize_t n = write(to, words.data() + done, words.size() - done);
    if (n <= 0) return;
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace

std::string in_copy(const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return "no pipe";
  const pid_t child = fork();
  if (child < 0) return "no copy of the process";
  if (child == 0) {
    write_all(ends[1], work());
    _exit(0);
  }
  close(ends[1]);
  std::string words;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = read(ends[0], buffer.data(), buffer.size())) > 0;)
    words.append(buffer.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) words += " (the copy broke down)";
  return words;
}

}  // namespace servogate::machine_run
