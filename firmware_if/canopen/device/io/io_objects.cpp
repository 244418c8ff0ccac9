// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/io/io_objects.hpp"

#include <algorithm>
#include <limits>

#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/node/pdo_channel.hpp"

namespace servogate::canopen {
namespace {

using enum DataType;
using enum Access;

/// An object with one sub-index for each group or channel.
struct ArrayRow {
  std::uint16_t index;
  DataType type;
  Access access;
  Mappable mappable;
  std::int64_t value;
};

constexpr ArrayRow kDigitalInputRows[] = {
    {io::kReadInput8, unsigned8, ro, Mappable::tpdo, 0},
    {io::kPolarityInput8, unsigned8, rw, Mappable::no, 0},
    {io::kFilterConstantInput8, unsigned8, rw, Mappable::no, 0},
    {io::kInterruptAnyChange8, unsigned8, rw, Mappable::no, 0xFF},
    {io::kInterruptLowToHigh8, unsigned8, rw, Mappable::no, 0},
    {io::kInterruptHighToLow8, unsigned8, rw, Mappable::no, 0},
};
constexpr ArrayRow kDigitalOutputRows[] = {
    {io::kWriteOutput8, unsigned8, rw, Mappable::rpdo, 0},
    {io::kPolarityOutput8, unsigned8, rw, Mappable::no, 0},
    {io::kErrorModeOutput8, unsigned8, rw, Mappable::no, 0xFF},
    {io::kErrorValueOutput8, unsigned8, rw, Mappable::no, 0},
    {io::kFilterMaskOutput8, unsigned8, rw, Mappable::no, 0xFF},
};
constexpr ArrayRow kAnalogueInputRows[] = {
    {io::kReadAnalogueInput16, integer16, ro, Mappable::tpdo, 0},
    {io::kInterruptTriggerSelection, unsigned8, rw, Mappable::no, 0x07},
    {io::kInterruptUpperLimit, integer32, rw, Mappable::no, 0},
    {io::kInterruptLowerLimit, integer32, rw, Mappable::no, 0},
    {io::kInterruptDelta, unsigned32, rw, Mappable::no, 0},
    {io::kInterruptNegativeDelta, unsigned32, rw, Mappable::no, 0},
    {io::kInterruptPositiveDelta, unsigned32, rw, Mappable::no, 0},
};
constexpr ArrayRow kAnalogueOutputRows[] = {
    {io::kWriteAnalogueOutput16, integer16, rw, Mappable::rpdo, 0},
    {io::kErrorModeAnalogueOutput, unsigned8, rw, Mappable::no, 1},
    {io::kErrorValueAnalogueOutput, integer32, rw, Mappable::no, 0},
};

template <std::size_t N>
void add(std::vector<ObjectSpec>& rows, const ArrayRow (&table)[N], std::uint8_t count) {
  if (count == 0) return;
  for (const ArrayRow& row : table) {
    rows.push_back({row.index, 0, unsigned8, constant, Mappable::no, count});
    for (std::uint8_t i = 1; i <= count; ++i)
      rows.push_back({row.index, i, row.type, row.access, row.mappable, row.value});
  }
}

/// PDO `number` with `count` objects of `index` from sub-index `first`; switched off when there is none.
void add_pdo(std::vector<ObjectSpec>& rows, NodeId node, int number, bool transmit, std::uint16_t index,
             int first, int count, std::uint8_t bits) {
  const auto n = static_cast<std::uint16_t>(number - 1);
  const auto parameter =
      static_cast<std::uint16_t>((transmit ? object::kTpdoParameter : object::kRpdoParameter) + n);
  const auto mapping = static_cast<std::uint16_t>(parameter + 0x200);
  const std::uint32_t id = transmit ? cob::kNoRemote | cob::tpdo(number, node) : cob::rpdo(number, node);
  rows.push_back({parameter, 1, unsigned32, rw, Mappable::no, (count > 0 ? 0 : cob::kInvalid) | id});
  rows.push_back({mapping, 0, unsigned8, rw, Mappable::no, count});
  for (int i = 1; i <= kPdoEntries; ++i) {
    const std::uint32_t word =
        i <= count ? MappingEntry{index, static_cast<std::uint8_t>(first + i - 1), bits}.word() : 0;
    rows.push_back({mapping, static_cast<std::uint8_t>(i), unsigned32, rw, Mappable::no, word});
  }
}

}  // namespace

std::uint32_t io_device_type(const IoTerminals& t) noexcept {
  return io::kDeviceProfile | (t.digital_inputs ? io::kDigitalInputs : 0) |
         (t.digital_outputs ? io::kDigitalOutputs : 0) | (t.analogue_inputs ? io::kAnalogueInputs : 0) |
         (t.analogue_outputs ? io::kAnalogueOutputs : 0);
}

std::vector<ObjectSpec> io_objects(NodeId node, const IoTerminals& t) {
  std::vector<ObjectSpec> rows;
  add(rows, kDigitalInputRows, groups(t.digital_inputs));
  add(rows, kDigitalOutputRows, groups(t.digital_outputs));
  add(rows, kAnalogueInputRows, t.analogue_inputs);
  add(rows, kAnalogueOutputRows, t.analogue_outputs);
  if (t.digital_inputs > 0) rows.push_back({io::kInterruptEnableDigital, 0, boolean, rw, Mappable::no, 1});
  // Off by itself, so that a noisy input does not fill the bus.
  if (t.analogue_inputs > 0) rows.push_back({io::kInterruptEnableAnalogue, 0, boolean, rw, Mappable::no, 0});
  for (int transmit = 0; transmit < 2; ++transmit) {
    const int lines = groups(transmit ? t.digital_inputs : t.digital_outputs);
    const int channels = transmit ? t.analogue_inputs : t.analogue_outputs;
    add_pdo(rows, node, 1, transmit != 0, transmit ? io::kReadInput8 : io::kWriteOutput8, 1, lines, 8);
    for (int n = 0; n < 3; ++n)
      add_pdo(rows, node, n + 2, transmit != 0,
              transmit ? io::kReadAnalogueInput16 : io::kWriteAnalogueOutput16, 4 * n + 1,
              std::clamp(channels - 4 * n, 0, 4), 16);
  }
  return rows;
}

}  // namespace servogate::canopen
