// SPDX-License-Identifier: Apache-2.0
// A candleLight adapter on a dummy USB host: gs_usb_gadget FUNCTIONFS_FOLDER CAN_INTERFACE [BUS_RATE]. With
// BUS_RATE the others on the bus speak this bit rate, and at another one every frame is destroyed. Ends when
// it is killed.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>

#include "drivers/socketcan/socketcan_bus.hpp"
#include "tests/gsusb/gadget/function.hpp"

int main(int count, char** arguments) try {
  using namespace servogate;
  if (count < 3) {
    std::fprintf(stderr, "gs_usb_gadget FUNCTIONFS_FOLDER CAN_INTERFACE [BUS_RATE]\n");
    return 2;
  }
  drivers::Notice why;
  const auto bus = socketcan::SocketCanBus::open({arguments[2], 0, {}}, why);
  if (bus == nullptr) {
    std::fprintf(stderr, "%s\n", why.str().c_str());
    return 4;
  }
  gsusb::SimulatedAdapter::Config config;
  if (count > 3) config.bus_rate = static_cast<std::uint32_t>(std::strtoul(arguments[3], nullptr, 10));
  gsusb::SimulatedAdapter adapter(*bus, config);
  gsusb::GadgetFunction function(arguments[1], adapter);
  std::printf("ready\n");
  std::fflush(stdout);
  std::thread out([&] { function.serve_out(); });
  std::thread in([&] { function.serve_in(); });
  function.serve_requests();
  std::_Exit(0);  // the others wait for a host that has gone
} catch (const std::exception& e) {
  std::fprintf(stderr, "gs_usb_gadget: %s\n", e.what());
  return 4;
}
