// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "drivers/notice.hpp"
#include "gateway/control/compose/bus_tap.hpp"
#include "gateway/control/compose/control.hpp"
#include "gateway/control/run/capture/capture_request.hpp"
#include "gateway/control/run/capture/machine_channels.hpp"
#include "report/capture/capture_recorder.hpp"

namespace servogate::gateway {

/// Captures a machine behind each of its cycles. Made before the first cycle, closed behind the last.
class MachineCapture final : public FrameObserver {
 public:
  /// The file that a request asks for. nullptr: refused, `why` says what is wrong with it.
  static std::unique_ptr<MachineCapture> open(Control& control, const CaptureRequest& request,
                                              drivers::Notice& why);
  /// Keeps the last kBlackBox_s in memory and writes them, and a second more, into `folder` at each alarm, as
  /// MCAP; the newest kBlackBoxes files stay.
  static std::unique_ptr<MachineCapture> black_box(Control& control, const std::string& folder);
  static constexpr double kBlackBox_s = 10.0;
  static constexpr std::size_t kBlackBoxes = 20;
  ~MachineCapture() override;

  /// Before a cycle of virtual time.
  void wait_for_room() const { recorder_->wait_for_room(); }
  /// Behind each cycle; its thread. real-time safe.
  void after_cycle() noexcept;
  void passed(int bus, const image::CanFrame& frame, bool sent) noexcept override;
  /// Ends the files. What went wrong (also: values were lost), empty: nothing.
  std::string close();
  const std::string& path() const noexcept { return path_; }
  /// After close(): files that were written; 0: the trigger did not come.
  int files() const noexcept { return recorder_->files(); }

 private:
  MachineCapture(Control& control, MachineChannels channels, std::string path);
  void start(report::CaptureSettings settings, report::Capture::Open open);

  Control& control_;
  MachineChannels channels_;
  std::string path_;
  std::unique_ptr<report::CaptureRecorder> recorder_;
};

}  // namespace servogate::gateway
