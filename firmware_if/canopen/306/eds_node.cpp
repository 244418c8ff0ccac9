// SPDX-License-Identifier: Apache-2.0
// The configuration of one node taken for another.
#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::canopen {
namespace {

constexpr int kPredefinedPdos = 4;
constexpr std::uint16_t kEmcyCobId = 0x1014, kSdoServer = 0x1200, kRpdo = 0x1400, kTpdo = 0x1800;
constexpr std::int64_t kIdentifier = 0x1FFF'FFFF;  ///< of a COB-ID; above it are flags

/// The identifier that this object has in the pre-defined connection set; 0: none. Source: CiA 301, 7.3.5.
std::uint32_t predefined(std::uint16_t index, std::uint8_t subindex, NodeId node) noexcept {
  if (index == kEmcyCobId && subindex == 0) return cob::emcy(node);
  if (index == kSdoServer && subindex == 1) return cob::sdo_request(node);
  if (index == kSdoServer && subindex == 2) return cob::sdo_response(node);
  if (subindex != 1) return 0;
  if (index >= kRpdo && index < kRpdo + kPredefinedPdos) return cob::rpdo(index - kRpdo + 1, node);
  if (index >= kTpdo && index < kTpdo + kPredefinedPdos) return cob::tpdo(index - kTpdo + 1, node);
  return 0;
}

bool follow(std::uint16_t index, std::uint8_t subindex, EdsEntry& e, NodeId node) {
  if (!e.parameter_value || !e.parameter_value->number || e.parameter_value->number->plus_node) return false;
  EdsNumber& number = *e.parameter_value->number;
  const bool by_default = e.default_value && e.default_value->number && e.default_value->number->plus_node &&
                          e.default_value->number->at(node) == number.value;
  const std::uint32_t identifier = predefined(index, subindex, node);
  if (!by_default && (identifier == 0 || (number.value & kIdentifier) != identifier)) return false;
  number = {number.value - node, true};
  e.parameter_value->text = eds_number_text(number);
  return true;
}

}  // namespace

int follow_node(Eds& eds) {
  if (!eds.commissioning || eds.commissioning->node == 0) return 0;
  const NodeId node = eds.commissioning->node;
  int count = 0;
  for (auto& [index, object] : eds.objects) {
    if (object.subs.empty()) count += follow(index, 0, object.entry, node);
    for (auto& [subindex, entry] : object.subs) count += follow(index, subindex, entry, node);
  }
  return count;
}

}  // namespace servogate::canopen
