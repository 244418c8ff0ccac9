// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/plc_logic.hpp"

#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::gateway {

void PlcLogic::scan(image::ProcessImage& image, cycle::Notices& notices) noexcept {
  const plc::ScanResult result = engine_.scan(image.packets, image.now.t_ns);
  const bool faulted = result.fault != plc::Fault::none;
  if (faulted && !faulted_) {
    image::AlarmRecord r;
    r.number = result.fault == plc::Fault::budget ? cycle::alarm::kPlcBudget : cycle::alarm::kPlcFault;
    r.line = result.line;
    r.value = result.fault == plc::Fault::budget ? static_cast<double>(result.instructions)
                                                 : static_cast<double>(result.fault);
    notices.add(r);
  }
  faulted_ = faulted;
  if (faulted) return;  // what an abandoned scan has left half done is not kept
  engine_.snapshot_retained(retained_.scratch());
  retained_.publish();
}

}  // namespace servogate::gateway
