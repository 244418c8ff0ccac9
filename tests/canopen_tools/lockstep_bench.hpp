// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>

#include "tests/canopen_tools/workbench.hpp"
#include "tests/one_processor.hpp"

namespace servogate::canopen_tools {

/// Buses in granted time with one drive each, which live as long as one call of the bench; what the bench
/// says.
class LockstepBench : public Workbench {
 protected:
  /// `servogate LINE` with $DRIVE for url and node of a new drive, or $BUS_OF_DRIVE for its url; `plant` is
  /// its
  /// --plant.
  Ended on_drive(std::string line, const std::string& plant, const std::string& nodes = "5") {
    const tests::OneProcessor pinned;  // server, drive and bench take turns
    const std::string at = std::to_string(++calls_);
    const std::string socket = path("lockstep-" + at);
    const std::string url = "lockstep:unix:" + socket + "/can0";
    auto bus = std::make_unique<usercan::Process>(
        std::vector<std::string>{"can", "bus", "can0", "--listen", "unix:" + socket, "--lockstep", "2"});
    EXPECT_TRUE(bus->says("can0"));
    std::vector<std::string> words{"drive", url, "--node", nodes, "--plant", plant};
    if (!sheet_.empty()) words.insert(words.end(), {"--profile", sheet_});
    const usercan::Process drive(words);
    EXPECT_TRUE(drive.says("node 5"));
    if (const std::size_t place = line.find("$BUS_OF_DRIVE"); place != std::string::npos)
      line.replace(place, 13, url);
    else
      line.replace(line.find("$DRIVE"), 6, url + " 5");
    Ended ended = tool(line);
    if (is_timed_ && bus->says(" s; the others go on without it")) {
      const std::string said = bus->said(), left = "left at ";
      lasted_s_ = std::strtod(said.c_str() + said.find(left) + left.size(), nullptr);
    }
    bus.reset();  // first: the drive waits for its time
    return ended;
  }
  /// `servogate bench WORDS` into a directory of its own.
  Ended bench(const std::string& words, const std::string& plant = "friction=0.02",
              const std::string& nodes = "5") {
    out_ = "run-" + std::to_string(calls_ + 1);
    return on_drive("bench " + words + " --listen 0.1 --out " + out_, plant, nodes);
  }
  json meta() const { return json::parse(desk_.text(out_ + "/meta.json"), nullptr, false); }

  bool is_timed_ = false;  ///< waits for what the server says of the time when a call has joined and left
  double lasted_s_ = 0.0;  ///< the last such call, in granted time
  std::string sheet_;      ///< data sheet that the drive is made of; empty: that of a servo
  std::string out_;        ///< directory of the last call of bench()

 private:
  int calls_ = 0;
};

}  // namespace servogate::canopen_tools
