// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "drivers/usb/libusb_port.hpp"

namespace servogate::gadget {

/// The endpoints of a function with one interface and a bulk pipe each way, at full and high speed.
class FunctionFs {
 public:
  /// `folder` is where functionfs is mounted. Throws std::system_error.
  FunctionFs(const std::string& folder, const usb::InterfaceClass& interface);
  ~FunctionFs();
  FunctionFs(const FunctionFs&) = delete;
  FunctionFs& operator=(const FunctionFs&) = delete;

  int requests() const { return requests_; }  ///< endpoint 0
  int in() const { return in_; }              ///< to the host
  int out() const { return out_; }            ///< from the host

 private:
  int requests_ = -1, in_ = -1, out_ = -1;
};

}  // namespace servogate::gadget
