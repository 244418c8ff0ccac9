// SPDX-License-Identifier: Apache-2.0
#include "tests/canopen_tools/workbench.hpp"

namespace servogate::canopen_tools {

Workbench::Workbench() : socket_(desk_.path("bus.sock")), url_("socketcand:unix:" + socket_ + "/can0") {
  bus_ = std::make_unique<usercan::Process>(
      std::vector<std::string>{"can", "bus", "can0", "--listen", "unix:" + socket_});
  EXPECT_TRUE(bus_->says("can0 at")) << bus_->said();
}

usercan::Process& Workbench::drives(const std::string& nodes, const std::vector<std::string>& options) {
  std::vector<std::string> words{"drive", url_, "--node", nodes};
  words.insert(words.end(), options.begin(), options.end());
  drives_.push_back(std::make_unique<usercan::Process>(words));
  const std::size_t comma = nodes.rfind(',');
  EXPECT_TRUE(
      drives_.back()->says("node " + nodes.substr(comma == std::string::npos ? 0 : comma + 1) + " on "))
      << drives_.back()->said();
  return *drives_.back();
}

Ended Workbench::tool(const std::string& words, const std::string& language) const {
  std::string line = "$SG " + words;
  for (std::size_t at = line.find("$BUS"); at != std::string::npos; at = line.find("$BUS"))
    line.replace(at, 4, url_);
  return desk_.line(line, language);
}

json Workbench::facts(const std::string& words, int code) const {
  const Ended ended = tool(words + " --json");
  EXPECT_EQ(ended.code, code) << words << "\n" << ended.out << ended.err;
  json out = json::parse(ended.out, nullptr, false);
  EXPECT_TRUE(out.is_object()) << ended.out;
  return out.is_object() ? out : json::object();
}

std::unique_ptr<usercan::SocketcandBus> Workbench::join() const {
  usercan::SocketcandConfig config;
  config.address = *usercan::parse_address("unix:" + socket_);
  drivers::Notice why;
  auto bus = usercan::SocketcandBus::open(config, why);
  EXPECT_NE(bus, nullptr) << why.str();
  return bus;
}

}  // namespace servogate::canopen_tools
