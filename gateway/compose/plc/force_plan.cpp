// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/plc/force_plan.hpp"

#include <algorithm>
#include <iterator>

#include "plc/types/direct_place.hpp"
#include "plc/types/type.hpp"
#include "plc/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::gateway {

namespace {

const plc::Type* by_format(const plc::TypeTable& types, image::Format format,
                           std::initializer_list<plc::Kind> kinds) {
  const auto i = static_cast<std::size_t>(format);
  return i < kinds.size() ? types.elementary(kinds.begin()[i]) : nullptr;
}

/// A request holds a number: characters are one for each. Empty: no such text.
std::vector<image::Request> of_characters(const image::Place& place, image::Request request,
                                          const std::string& value) {
  plc::Type text;
  text.kind = plc::Kind::string;
  text.size = 1 + place.bytes();
  std::vector<std::uint8_t> bytes(text.size, ' ');
  if (!plc::parse_value(text, value, bytes.data())) return {};
  std::fill(bytes.begin() + 1 + bytes[0], bytes.end(), ' ');
  request.format = static_cast<std::uint8_t>(image::Format::by);
  std::vector<image::Request> out;
  for (std::uint32_t n = 0; n < place.bytes(); ++n) {
    request.index = place.byte() + n;
    request.length = 1;
    request.value = bytes[1 + n];
    out.push_back(request);
  }
  return out;
}

}  // namespace

const plc::Type* number_type(const plc::TypeTable& types, image::Format format) {
  using plc::Kind;
  return by_format(types, format,
                   {Kind::boolean, Kind::usint, Kind::int_, Kind::dint, Kind::real, Kind::lreal});
}

const plc::Type* bit_string_type(const plc::TypeTable& types, image::Format format) {
  using plc::Kind;
  return by_format(types, format,
                   {Kind::boolean, Kind::byte, Kind::word, Kind::dword, Kind::dword, Kind::lword});
}

std::optional<image::Place> place_of(const machine::MachineConfig& machine, const plc::Engine* program,
                                     const std::string& name) {
  if (const auto handle = program == nullptr ? std::nullopt : program->find(name)) {
    if (handle->place < 0) return std::nullopt;
    return program->image().places[static_cast<std::size_t>(handle->place)].place;
  }
  if (const auto direct = plc::direct_place(name)) return direct;
  for (const image::Symbol& s : machine.symbol_table())
    if (plc::same_name(s.name, name)) return s.place;
  return image::parse_place(name);
}

ForcePlan plan_force(const machine::MachineConfig& machine, const plc::Engine* program,
                     const std::string& name, const std::string& value) {
  using Kind = ForcePlan::Kind;
  const auto variable = program == nullptr ? std::nullopt : program->find(name);
  const std::optional<image::Place> place = place_of(machine, program, name);
  // A string that a variable mirrors is held there.
  if (variable && (!place || place->format == image::Format::ch))
    return {program->prepare_force(*variable, value) ? Kind::variable : Kind::no_value, {}};
  if (!place) return {};
  image::Request request;
  request.kind = image::RequestKind::force;
  request.packet = static_cast<std::uint8_t>(place->packet);
  request.format = static_cast<std::uint8_t>(place->format);
  request.index = place->index;
  request.length = place->length;
  ForcePlan plan{Kind::places, {}};
  if (place->format == image::Format::ch) {
    plan.requests = of_characters(*place, request, value);
  } else {
    const plc::TypeTable types;
    std::uint8_t bytes[8] = {};
    const plc::Type& number = *number_type(types, place->format);
    if (plc::parse_value(number, value, bytes) ||
        (plc::direct_place(name) && plc::parse_value(*bit_string_type(types, place->format), value, bytes))) {
      request.value = plc::to_number(number, bytes);
      plan.requests.push_back(request);
    }
  }
  if (plan.requests.empty() || value.empty()) return {Kind::no_value, {}};
  return plan;
}

}  // namespace servogate::gateway
