// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <mutex>
#include <string>

#include "tests/gsusb/simulated_adapter.hpp"
#include "tests/usb_gadget/functionfs.hpp"

struct usb_ctrlrequest;

namespace servogate::gsusb {

/// The simulated adapter as a USB function of a Linux gadget (FunctionFS): whoever is the host, the kernel's
/// own driver or libusb, sees a candleLight. Three threads serve the endpoints.
class GadgetFunction {
 public:
  /// `folder` is where functionfs is mounted. Throws std::system_error.
  GadgetFunction(const std::string& folder, SimulatedAdapter& adapter);
  GadgetFunction(const GadgetFunction&) = delete;
  GadgetFunction& operator=(const GadgetFunction&) = delete;

  /// Requests to endpoint 0, until the gadget is taken apart.
  void serve_requests();
  /// Transfers from the host, until the gadget is taken apart.
  void serve_out();
  /// Frames of the bus to the host, until end().
  void serve_in();
  void end() { ending_ = true; }
  std::mutex& mutex() { return mutex_; }

 private:
  void answer(const ::usb_ctrlrequest& setup);

  SimulatedAdapter& adapter_;
  std::mutex mutex_;  ///< of adapter_
  gadget::FunctionFs function_;
  std::atomic<bool> ending_{false};
};

}  // namespace servogate::gsusb
