// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/node/communication_objects.hpp"

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/node/node_monitor.hpp"
#include "firmware_if/canopen/device/node/pdo_channel.hpp"

namespace servogate::canopen {
namespace {

using enum DataType;
using enum Access;

constexpr ObjectSpec kGeneral[] = {
    {0x1000, 0, unsigned32, ro},
    {0x1001, 0, unsigned8, ro, Mappable::tpdo},
    {0x1003, 0, unsigned8, rw},
    {0x1005, 0, unsigned32, rw, Mappable::no, 0x80},
    {0x1006, 0, unsigned32, rw},
    {0x1007, 0, unsigned32, rw},
    {0x1008, 0, visible_string, constant, Mappable::no},
    {0x1009, 0, visible_string, constant, Mappable::no, 0, 0, 0, "simulated"},
    {0x100A, 0, visible_string, constant, Mappable::no, 0, 0, 0, "0.1"},
    {0x100C, 0, unsigned16, rw},
    {0x100D, 0, unsigned8, rw},
    {0x1010, 0, unsigned8, constant, Mappable::no, 3},
    {0x1010, 1, unsigned32, rw, Mappable::no, 1},
    {0x1010, 2, unsigned32, rw, Mappable::no, 1},
    {0x1010, 3, unsigned32, rw, Mappable::no, 1},
    {0x1011, 0, unsigned8, constant, Mappable::no, 3},
    {0x1011, 1, unsigned32, rw, Mappable::no, 1},
    {0x1011, 2, unsigned32, rw, Mappable::no, 1},
    {0x1011, 3, unsigned32, rw, Mappable::no, 1},
    {0x1012, 0, unsigned32, rw, Mappable::no, cob::kInvalid | cob::kTime},  // bit 31: TIME is consumed
    {0x1015, 0, unsigned16, rw},
    {0x1016, 0, unsigned8, constant, Mappable::no, NodeMonitor::kConsumers},
    {0x1017, 0, unsigned16, rw},
    {0x1018, 0, unsigned8, constant, Mappable::no, 4},
    {0x1019, 0, unsigned8, rw, Mappable::no, 0, 0, 240},
    {0x1020, 0, unsigned8, constant, Mappable::no, 2},
    {0x1020, 1, unsigned32, rw},
    {0x1020, 2, unsigned32, rw},
    {0x1029, 0, unsigned8, constant, Mappable::no, 1},
    {0x1029, 1, unsigned8, rw, Mappable::no, 0, 0, 2},
    {0x1200, 0, unsigned8, constant, Mappable::no, 2},
    // A name that the user gives the device.
    {0x2100, 0, visible_string, rw},
};

// The usual first PDO of a drive; those behind it carry the words of the cyclic modes. Source: CiA 402-3.
constexpr std::uint32_t kReceive[kPdos][3] = {{1, 0x6040'0010},
                                              {2, 0x6040'0010, 0x6060'0008},
                                              {2, 0x6040'0010, 0x607A'0020},
                                              {2, 0x6040'0010, 0x60FF'0020}};
constexpr std::uint32_t kTransmit[kPdos][3] = {{1, 0x6041'0010},
                                               {2, 0x6041'0010, 0x6061'0008},
                                               {2, 0x6041'0010, 0x6064'0020},
                                               {2, 0x6041'0010, 0x606C'0020}};

void add_pdo(std::vector<ObjectSpec>& rows, std::uint16_t parameter, std::uint32_t cob_id,
             const std::uint32_t (&mapping)[3], bool transmit) {
  rows.push_back({parameter, 0, unsigned8, constant, Mappable::no, transmit ? 6 : 5});
  rows.push_back({parameter, 1, unsigned32, rw, Mappable::no, cob_id});
  rows.push_back({parameter, 2, unsigned8, rw, Mappable::no, 255});
  rows.push_back({parameter, 3, unsigned16, rw});
  rows.push_back({parameter, 5, unsigned16, rw});
  if (transmit) rows.push_back({parameter, 6, unsigned8, rw, Mappable::no, 0, 0, 240});
  const auto map = static_cast<std::uint16_t>(parameter + 0x200);
  rows.push_back({map, 0, unsigned8, rw, Mappable::no, mapping[0]});
  for (std::uint8_t i = 1; i <= kPdoEntries; ++i)
    rows.push_back({map, i, unsigned32, rw, Mappable::no, i <= mapping[0] ? mapping[i] : 0});
}

}  // namespace

std::vector<ObjectSpec> communication_objects(NodeId node, const DeviceIdentity& identity) {
  std::vector<ObjectSpec> rows(std::begin(kGeneral), std::end(kGeneral));
  rows.front().value = identity.device_type;
  for (ObjectSpec& row : rows)
    if (row.index == object::kDeviceName) row.text = identity.name;
  for (std::uint8_t i = 1; i <= 8; ++i) rows.push_back({object::kPredefinedErrorField, i, unsigned32, ro});
  rows.push_back({object::kCobIdEmcy, 0, unsigned32, rw, Mappable::no, cob::emcy(node)});
  for (std::uint8_t i = 1; i <= NodeMonitor::kConsumers; ++i)
    rows.push_back({object::kConsumerHeartbeatTime, i, unsigned32, rw});
  const std::uint32_t who[] = {identity.vendor_id, identity.product_code, identity.revision,
                               identity.serial_number};
  for (std::uint8_t i = 1; i <= 4; ++i)
    rows.push_back({object::kIdentity, i, unsigned32, ro, Mappable::no, who[i - 1]});
  rows.push_back({object::kSdoServerParameter, 1, unsigned32, ro, Mappable::no, cob::sdo_request(node)});
  rows.push_back({object::kSdoServerParameter, 2, unsigned32, ro, Mappable::no, cob::sdo_response(node)});
  for (int n = 0; n < kPdos; ++n) {
    const std::uint32_t off = n == 0 ? 0 : cob::kInvalid;
    const auto place = static_cast<std::uint16_t>(n);
    add_pdo(rows, static_cast<std::uint16_t>(object::kRpdoParameter + place), off | cob::rpdo(n + 1, node),
            kReceive[n], false);
    add_pdo(rows, static_cast<std::uint16_t>(object::kTpdoParameter + place),
            off | cob::kNoRemote | cob::tpdo(n + 1, node), kTransmit[n], true);
  }
  return rows;
}

}  // namespace servogate::canopen
