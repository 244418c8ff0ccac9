// SPDX-License-Identifier: Apache-2.0
#include "tests/usercan/rig/mill.hpp"

#include <fstream>

#include "tests/places/places.hpp"
#include "tests/usercan/rig/running_server.hpp"

namespace servogate::usercan {

std::string mill(const std::string& url, const Changes& changes) {
  const std::string example = tests::source_dir() + "/examples/mill/";
  std::string text = content(example + "machine.toml");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    std::size_t n = 0;
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()), ++n)
      text.replace(at, from.size(), to);
    EXPECT_GT(n, 0u) << from;
  };
  replace("\"mill.st\"", "\"" + example + "mill.st\"");
  replace("url = \"mock:can\"", "url = \"" + url + "\"");
  for (const auto& [from, to] : changes) replace(from, to);
  const std::string file = scratch("mill.toml");
  std::ofstream(file) << text;
  return file;
}

Changes patience() {
  // 6065h, FFFFFFFFh: no window.
  const std::string patient =
      "loss_cycles = 1000\nheartbeat = \"1 s\"\nobjects = { \"6065:00/32\" = 4294967295 }\ndevice = ";
  return {{"bit_rate = \"1 Mbit/s\"", "bit_rate = \"1 Mbit/s\"\nsimulated = true"},
          {"cycle_time = \"1 ms\"", "cycle_time = \"4 ms\""},
          {"following_error_stop = \"1 mm\"", "following_error_stop = \"100 mm\""},
          {"following_error_warn = \"0.5 mm\"", "following_error_warn = \"90 mm\""},
          {"device = \"servo", patient + "\"servo"},
          {"device = \"spindle", patient + "\"spindle"}};
}

std::vector<std::unique_ptr<Process>> mill_drives(const std::string& machine) {
  std::vector<std::unique_ptr<Process>> out;
  for (const char* nodes : {"1", "2", "3,4"})
    out.push_back(
        std::make_unique<Process>(std::vector<std::string>{"drive", machine + "#can", "--node", nodes}));
  return out;
}

}  // namespace servogate::usercan
