// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/canopen/drive_model.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen::testing {

/// A small drive written by hand from CiA 301 and CiA 402, sharing nothing with the product's codecs:
/// expedited SDO server, NMT, heartbeat, PDOs as configured in its objects, state machine, touch probe, ideal
/// plant.
class FakeDrive {
 public:
  explicit FakeDrive(std::uint8_t node);

  /// A frame on the wire; answers go to `out`.
  void on_frame(const image::CanFrame& f, std::vector<image::CanFrame>& out);
  /// Time goes on: heartbeat.
  void advance_to(image::Nanoseconds now, std::vector<image::CanFrame>& out);

  void power_on(std::vector<image::CanFrame>& out);
  void raise_fault(std::uint16_t code, std::vector<image::CanFrame>& out);

  std::uint32_t get(std::uint16_t index, std::uint8_t subindex) const;
  void set(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value);
  void erase(std::uint16_t index, std::uint8_t subindex);

  std::uint8_t node;
  int nmt_state = 0x7F;
  DriveModel machine;
  std::int64_t position = 0;
  std::int64_t zero_mark_every = 0;               ///< counts between two zero marks, 0: no touch probe event
  std::map<std::uint32_t, std::uint32_t> aborts;  ///< index << 8 | subindex: abort code for a write
  std::map<std::uint32_t, std::uint32_t> stuck;   ///< value the object keeps whatever is written
  std::vector<std::string> writes;                ///< "1400:1=80000201" in order
  std::vector<std::int64_t> applied;              ///< targets used in Operation enabled, one per SYNC
  bool powered = true;                            ///< FALSE: as if its plug were pulled
  bool silent_sdo = false;
  bool silent_tpdo = false;
  bool silent_heartbeat = false;
  int short_tpdo = 0;  ///< bytes cut off from TPDO1

 private:
  struct Object {
    std::uint8_t bytes = 4;
    std::uint32_t value = 0;
  };
  static std::uint32_t key(std::uint16_t index, std::uint8_t subindex) {
    return static_cast<std::uint32_t>(index) << 8 | subindex;
  }
  void on_nmt(const image::CanFrame& f, std::vector<image::CanFrame>& out);
  void on_sdo(const image::CanFrame& f, std::vector<image::CanFrame>& out);
  void on_sync(std::vector<image::CanFrame>& out);
  void on_rpdo(int pdo, const image::CanFrame& f);
  void apply_rpdos();
  void watch_zero_mark(std::int64_t from, std::int64_t to);
  static std::uint32_t encode(image::DriveState state);

  std::map<std::uint32_t, Object> objects_;
  std::map<int, image::CanFrame> pending_rpdo_;
  image::Nanoseconds heartbeat_ns_ = 0;
  image::Nanoseconds now_ = 0;
  int sync_count_ = 0;
  bool captured_ = false;
};

/// A bus between one master and fake drives. What the master sends in a cycle reaches the drives in
/// transfer(), in order; their answers wait for the master's next cycle.
class FakeNetwork final : public image::CanBus {
 public:
  FakeDrive& add(std::uint8_t node);

  bool send(const image::CanFrame& f) noexcept override;
  bool receive(image::CanFrame& f) noexcept override;
  image::CanState state() const noexcept override { return bus_state; }
  std::uint32_t bit_rate() const noexcept override { return 1'000'000; }

  /// Everything that happens on the wire up to time `now`.
  void transfer(image::Nanoseconds now);
  /// A frame of somebody who is neither master nor drive; everybody hears it.
  void inject(const image::CanFrame& f);
  /// Puts what a drive has put into waiting_out on the way to the master.
  void flush_out();

  std::vector<std::unique_ptr<FakeDrive>> drives;
  std::vector<image::CanFrame> sent;       ///< by the master since the last transfer()
  std::vector<image::CanFrame> last_sent;  ///< by the master in the cycle before
  std::deque<image::CanFrame> waiting;
  std::vector<image::CanFrame> waiting_out;
  image::CanState bus_state = image::CanState::error_active;
  bool refuse_sending = false;
  /// Says the fate of each frame: how many times it arrives (0: lost).
  std::function<int(const image::CanFrame&)> fate;
};

}  // namespace servogate::canopen::testing
