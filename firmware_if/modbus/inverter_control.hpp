// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/modbus/poller.hpp"

namespace servogate::modbus {

/// An inverter as the drive of a spindle: its registers into DriveFeedback, and DriveCommand (power,
/// velocity, fault reset) into its registers. Its states are those of CiA 402 in meaning: it is enabled while
/// the control wants power, runs while a speed is wanted, and is in fault while it has tripped. It is online
/// while each of its blocks is read or written in time; before, and as long as a required register is wrong,
/// it is told to stop. The error code is that of a trip, or the address of the register that is wrong. All
/// but the constructor is real-time safe.
class InverterControl {
 public:
  explicit InverterControl(Inverter inverter);

  const Inverter& inverter() const noexcept { return inverter_; }
  /// It alone says what is written there.
  bool writes_to(std::size_t block) const noexcept;

  /// What came of a transaction of the line, of one of its blocks or not.
  void take(const Outcome& outcome) noexcept;
  /// Into the image; `quality` of the data of its unit.
  void receive(image::ProcessImage& image, image::Quality quality) noexcept;
  /// What has changed, and everything the first time.
  void send(const image::ProcessImage& image, WriteSink& sink) noexcept;
  /// The control ends: the inverter stops. Nothing where nothing was sent.
  void leave(WriteSink& sink) noexcept;

 private:
  /// A register that is written.
  struct Written {
    std::size_t block = 0;
    Data data;
    bool armed = false;
  };
  void write(Written& to, std::uint16_t value, image::Nanoseconds t, WriteSink& sink) noexcept;
  const RequiredRegister* wrong_register() const noexcept;
  bool tripped() const noexcept;
  double output_hz() const noexcept;
  image::DriveState state() const noexcept;

  Inverter inverter_;
  Written command_, frequency_, reset_;
  std::uint16_t status_ = 0, output_ = 0, fault_ = 0;
  std::vector<std::uint16_t> required_;
  /// Answers until the newest frequency has surely arrived; then the status has to be read once more.
  int frequency_left_ = 0;
  bool status_since_ = false;
  bool online_ = false;
  bool powered_ = false;       ///< the control wants it on
  int direction_ = 1;          ///< last one that was commanded
  bool reset_wished_ = false;  ///< level of the command
  int reset_left_ = 0;         ///< the reset value is written so many times more
};

}  // namespace servogate::modbus
