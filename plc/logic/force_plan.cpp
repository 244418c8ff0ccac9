// SPDX-License-Identifier: Apache-2.0
#include "plc/logic/force_plan.hpp"

#include <algorithm>
#include <iterator>

#include "plc/types/direct_place.hpp"
#include "plc/types/type.hpp"
#include "plc/variables/places.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc {

namespace {

/// A request holds a number: characters are one for each. Empty: no such text.
std::vector<image::Request> of_characters(const image::Place& place, image::Request request,
                                          const std::string& value) {
  Type text;
  text.kind = Kind::string;
  text.size = 1 + place.bytes();
  std::vector<std::uint8_t> bytes(text.size, ' ');
  if (!parse_value(text, value, bytes.data())) return {};
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

std::optional<image::Place> place_of(std::span<const image::Symbol> symbols, const Engine* program,
                                     const std::string& name) {
  const auto handle = program == nullptr ? std::nullopt : program->find(name);
  if (!handle) return place_of(symbols, name);
  if (handle->place < 0) return std::nullopt;
  return program->image().places[static_cast<std::size_t>(handle->place)].place;
}

ForcePlan plan_force(std::span<const image::Symbol> symbols, const Engine* program, const std::string& name,
                     const std::string& value) {
  const auto variable = program == nullptr ? std::nullopt : program->find(name);
  const std::optional<image::Place> place = place_of(symbols, program, name);
  // A string that a variable mirrors is held there.
  if (variable && (!place || place->format == image::Format::ch))
    return {program->prepare_force(*variable, value) ? ForcePlan::Kind::variable : ForcePlan::Kind::no_value,
            {}};
  if (!place) return {};
  image::Request request;
  request.kind = image::RequestKind::force;
  request.packet = static_cast<std::uint8_t>(place->packet);
  request.format = static_cast<std::uint8_t>(place->format);
  request.index = place->index;
  request.length = place->length;
  ForcePlan plan{ForcePlan::Kind::places, {}};
  if (place->format == image::Format::ch) {
    plan.requests = of_characters(*place, request, value);
  } else {
    const TypeTable types;
    std::uint8_t bytes[8] = {};
    const Type& number = *number_type(types, place->format);
    if (parse_value(number, value, bytes) ||
        (direct_place(name) && parse_value(*bit_string_type(types, place->format), value, bytes))) {
      request.value = to_number(number, bytes);
      plan.requests.push_back(request);
    }
  }
  if (plan.requests.empty() || value.empty()) return {ForcePlan::Kind::no_value, {}};
  return plan;
}

}  // namespace servogate::plc
