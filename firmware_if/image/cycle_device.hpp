// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/notices.hpp"
#include "firmware_if/image/process_image.hpp"

namespace servogate::image {

/// Whatever fills and empties the image in a cycle: a CAN segment, a Modbus line, a GPIO chip, a USB board, a
/// pendant, an encoder counter. The cycle knows no more of it than this. A device of any kind
/// - puts actual values into AxisImage::drive and SpindleImage::drive, and takes their commands,
/// - puts points into packet A through a PointStage, which knows what a point is worth without its device,
/// - shows in the image which of its parts are there: IoSource::quality of a station, DriveFeedback::online,
/// - tells what happened as notices (AlarmRecord with its own fields in AlarmRecord::detail; rows and words
/// of its
///   alarms are handed in by its room, alarms/alarm_table.hpp),
/// - tells edges of its inputs with their times (ProcessImage::edges), where it knows them.
/// What it says of presence stands in the image and nowhere else, so that the replay of a record sees it too.
/// A facility that the cycle cannot wait for (a serial line, edges of a GPIO chip, a HID device) has a thread
/// of its own: the device starts it where it is opened and ends it in its destructor, both outside real time;
/// thread and cycle share bounded lock-free queues only, which receive() empties and send() fills, and an age
/// that rises when the thread falls silent.
class CycleDevice {
 public:
  virtual ~CycleDevice() = default;
  /// First act of a cycle, of all devices before any of them receives: what has to leave at the cycle's own
  /// time (SYNC). real-time safe.
  virtual void open_cycle(ProcessImage& /*image*/) noexcept {}
  /// Takes in what has come. real-time safe.
  virtual void receive(ProcessImage& image, Notices& notices) noexcept = 0;
  /// Last act of a cycle: sends the commands computed in it. real-time safe.
  virtual void send(ProcessImage& image) noexcept = 0;
};

}  // namespace servogate::image
