// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "firmware_if/canopen/inspect/object_catalogue.hpp"
#include "firmware_if/canopen/inspect/object_walk.hpp"
#include "gateway/cli/options.hpp"

/// What the ways of `servogate od` have in common, and the two that look at a DCF. Not real-time safe.
namespace servogate::gateway::command {

/// What the command works on.
struct OdWork {
  const OdOptions& options;
  canopen::SdoAccess& access;
  std::function<bool()> over;
  std::uint32_t bit_rate;
  canopen::NodeId node() const { return static_cast<canopen::NodeId>(options.node); }
};

std::string say(const text::Entry& entry, const std::vector<std::string>& arguments);
/// "1018h:04 Identity object".
std::string place_words(const canopen::ObjectCatalogue& catalogue, std::uint16_t index,
                        std::uint8_t subindex);
nlohmann::json place_json(const canopen::ObjectCatalogue& catalogue, std::uint16_t index,
                          std::uint8_t subindex);
nlohmann::json head(const OdOptions& options);
void print_json(const nlohmann::json& out);

/// Names the parameters that are not as the file has them. kDone: there are none.
int compare_parameters(const OdWork& work, const canopen::Eds& file);
/// Writes those back that differ, on an idle bus, and compares before and after. A device of another kind
/// (vendor or product of 1018h) is refused. kDone: it is as the file has it.
int restore_parameters(const OdWork& work, const canopen::Eds& file);

}  // namespace servogate::gateway::command
