// SPDX-License-Identifier: Apache-2.0
// The Modbus server of the example mill in virtual time, by the product's own link and by other people's
// clients.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>

#include "drivers/modbus/link.hpp"
#include "gateway/control/server/modbus/register_map.hpp"
#include "tests/comes.hpp"
#include "tests/server/rig/shell.hpp"
#include "tests/skip_here.hpp"

namespace servogate::gateway::testing {
namespace {

using modbus::Exception;
using modbus::Function;

/// A port of loopback that nobody has.
std::string free_port() {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  close(fd);
  return std::to_string(ntohs(address.sin_port));
}

class ServedMill : public ::testing::Test {
 protected:
  ServedMill() {
    std::ifstream in(Shell::example("mill/machine.toml"));
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string plc = "[plc]\nsources = [\"mill.st\"]";
    text.replace(text.find(plc), plc.size(),
                 "[modbus_server]\nlisten = \"127.0.0.1:" + port_ + "\"\nwrite = [\"SK200-SK231\"]\n" +
                     "[plc]\nsources = [\"" + Shell::example("mill/mill.st") + "\"]");
    std::ofstream(shell_.folder() / "machine.toml") << text;
    shell_.up_file((shell_.folder() / "machine.toml").string(), {"--virtual", "--speed", "20"});
  }
  /// Once the server has seen a cycle.
  modbus::Response ask(Function function, std::uint16_t address, std::uint16_t count,
                       const std::vector<std::uint16_t>& values = {}) {
    modbus::Request request;
    request.function = function;
    request.address = address;
    request.count = count;
    for (std::size_t n = 0; n < values.size(); ++n)
      modbus::carries_bits(function) ? request.data.set_bit(n, values[n] != 0)
                                     : static_cast<void>(request.data.words[n] = values[n]);
    modbus::Response response;
    EXPECT_TRUE(tests::comes([&] {
      drivers::Notice why;
      modbus::Link link({modbus::TcpAddress{"127.0.0.1", port_}, 60 * image::kSecond});
      return link.open(why) && link.exchange(1, request, response, nullptr) == modbus::Heard::answer &&
             response.exception != Exception::server_device_busy;
    }));
    return response;
  }
  std::uint16_t word(std::uint16_t address) {
    return ask(Function::read_holding_registers, address, 1).data.words[0];
  }

  const std::string port_ = free_port();
  Shell shell_;
};

TEST_F(ServedMill, shows_packets_axes_and_state_to_whoever_reads) {
  shell_.ready();
  ASSERT_EQ(shell_.run({"jog", "X", "-12.5mm", "--wait"}).exit, 0);
  ASSERT_TRUE(tests::comes([&] {
    const modbus::Response r = ask(Function::read_holding_registers, 20'000, 8);
    const auto position = static_cast<std::int32_t>(std::uint32_t{r.data.words[0]} << 16 | r.data.words[1]);
    return std::abs(position + 12'500) <= 2 && (r.data.words[6] & 0b111) == 0b011;  // enabled, homed, at rest
  }));
  EXPECT_TRUE(ask(Function::read_discrete_inputs, 16, 1).data.bit(0)) << "SA16, the door is closed";
  EXPECT_EQ(ask(Function::read_input_registers, 17, 1).data.words[0], 600) << "SA17.IN, air pressure";
  EXPECT_EQ(word(22'003), 0) << "no alarm";
  const std::uint16_t before = word(22'000);
  EXPECT_TRUE(tests::comes([&] { return word(22'000) != before; })) << "its cycles go on";
  EXPECT_EQ(ask(Function::read_holding_registers, 20'000 + 20 * 3, 1).exception,
            Exception::illegal_data_address)
      << "three axes";
  EXPECT_EQ(ask(Function::read_coils, 8'192, 1).exception, Exception::illegal_data_address);
}

TEST_F(ServedMill, takes_writes_where_the_machine_file_opens_them_and_nowhere_else) {
  EXPECT_EQ(ask(Function::write_multiple_registers, 2'000 + 100, 2, {1234, 0xFFFF}).exception,
            Exception::none);
  EXPECT_TRUE(tests::comes([&] { return word(2'100) == 1234 && word(2'101) == 0xFFFF; }))
      << "SK100.IN, SK101.IN";
  EXPECT_EQ(ask(Function::write_single_coil, 10'000 + 8 * 204 + 3, 1, {1}).exception, Exception::none);
  EXPECT_TRUE(tests::comes([&] { return ask(Function::read_coils, 10'000 + 8 * 204 + 3, 1).data.bit(0); }));
  for (const std::uint16_t address : {0, 99 + 2'000, 116 + 2'000, 20'000})
    EXPECT_EQ(ask(Function::write_single_register, address, 1, {1}).exception,
              Exception::illegal_data_address)
        << address;
  EXPECT_EQ(ask(Function::write_single_coil, 64, 1, {1}).exception, Exception::illegal_data_address)
      << "an output";
  bool told = false;
  const nlohmann::json history = shell_.ask({{"cmd", "history"}});
  for (const nlohmann::json& e : history["events"]) told = told || e["who"] == "Modbus";
  EXPECT_TRUE(told) << history;
}

int run(const std::string& command, std::string& said) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  char bytes[256];
  while (fgets(bytes, sizeof bytes, pipe) != nullptr) said += bytes;
  return pclose(pipe);
}

TEST_F(ServedMill, answers_mbpoll_and_pymodbus) {
  if (std::system(
          "command -v mbpoll >/dev/null && /usr/bin/python3 -c 'import pymodbus.client' 2>/dev/null") != 0)
    SKIP_HERE("no mbpoll or python3-pymodbus here; install them so: .ci/packages --tests");
  ask(Function::read_coils, 0, 1);
  std::string said;
  EXPECT_EQ(run("mbpoll -m tcp -p " + port_ + " -0 -1 -t 3 -r 17 -c 1 -o 10 127.0.0.1", said), 0) << said;
  EXPECT_NE(said.find("600"), std::string::npos) << said;
  said.clear();
  EXPECT_EQ(run("mbpoll -m tcp -p " + port_ + " -0 -1 -t 4 -r 2105 -o 10 127.0.0.1 65459", said), 0) << said;
  EXPECT_TRUE(tests::comes([&] { return word(2'105) == 65459; }));
  said.clear();
  const std::string script =
      "from pymodbus.client import ModbusTcpClient as C; c = C('127.0.0.1', port=" + port_ +
      ", timeout=60); c.connect(); print(c.read_input_registers(17, 1).registers, "
      "c.write_register(2106, 42).isError(), c.write_register(0, 1).exception_code, "
      "c.read_discrete_inputs(16, "
      "1).bits[0])";
  EXPECT_EQ(run("/usr/bin/python3 -c \"" + script + "\"", said), 0) << said;
  EXPECT_EQ(said, "[600] False 2 True\n");
}

TEST(RegisterMap, ranges_are_bytes_of_packet_k) {
  ASSERT_TRUE(parse_range("SK200-SK231"));
  EXPECT_EQ(parse_range("SK200-SK231")->last, 231u);
  EXPECT_EQ(parse_range("SK7")->first, 7u);
  for (const char* wrong : {"", "SA1", "SK5.IN", "SK9-SK8", "SK1-", "K1"})
    EXPECT_FALSE(parse_range(wrong)) << wrong;
}

}  // namespace
}  // namespace servogate::gateway::testing
