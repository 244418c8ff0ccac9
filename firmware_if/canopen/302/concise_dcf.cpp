// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/concise_dcf.hpp"

#include "firmware_if/canopen/306/value_text.hpp"

namespace servogate::canopen {
namespace {

constexpr std::size_t kHead = 7;  ///< index, sub-index, size

void append(std::vector<std::uint8_t>& out, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

bool pdo_parameter(std::uint16_t index) noexcept { return index >= 0x1400 && index < 0x1C00; }

void add_entry(std::vector<ConfigurationEntry>& out, std::uint16_t index, std::uint8_t subindex,
               const EdsEntry& e, NodeId node) {
  if (!e.parameter_value || !eds_writable(e.access) || (e.flags & 1) || e.parameter_value == e.default_value)
    return;
  ConfigurationEntry entry{index, subindex, {}};
  if (e.parameter_value->number) {
    const auto bytes = static_cast<std::size_t>(eds_type_bits(e.data_type) + 7) / 8;
    append(entry.data, static_cast<std::uint64_t>(e.parameter_value->number->at(node)), bytes);
  } else {
    // Texts as they are, OCTET_STRING and the like from their hexadecimal digits. What is no value of its
    // type the reader of the file has told as an error.
    const ValueType* type = type_numbered(e.data_type);
    auto data = type != nullptr ? encode_value(e.parameter_value->text, *type) : std::nullopt;
    if (!data) return;
    entry.data = std::move(*data);
  }
  out.push_back(std::move(entry));
}

}  // namespace

std::optional<std::vector<ConfigurationEntry>> parse_concise_dcf(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4) return std::nullopt;
  const std::uint64_t count = load_le(bytes.first(4));
  bytes = bytes.subspan(4);
  std::vector<ConfigurationEntry> entries;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (bytes.size() < kHead) return std::nullopt;
    const auto size = static_cast<std::size_t>(load_le(bytes.subspan(3, 4)));
    if (size > bytes.size() - kHead) return std::nullopt;
    const auto data = bytes.subspan(kHead, size);
    entries.push_back(
        {static_cast<std::uint16_t>(load_le(bytes.first(2))), bytes[2], {data.begin(), data.end()}});
    bytes = bytes.subspan(kHead + size);
  }
  return entries;
}

std::vector<std::uint8_t> write_concise_dcf(std::span<const ConfigurationEntry> entries) {
  std::vector<std::uint8_t> out;
  append(out, entries.size(), 4);
  for (const ConfigurationEntry& e : entries) {
    append(out, e.index, 2);
    append(out, e.subindex, 1);
    append(out, e.data.size(), 4);
    out.insert(out.end(), e.data.begin(), e.data.end());
  }
  return out;
}

std::vector<ConfigurationEntry> configuration_of(const Eds& dcf, NodeId node) {
  std::vector<ConfigurationEntry> out;
  for (const auto& [index, object] : dcf.objects) {
    if (pdo_parameter(index)) continue;
    if (object.subs.empty()) add_entry(out, index, 0, object.entry, node);
    for (const auto& [subindex, entry] : object.subs) add_entry(out, index, subindex, entry, node);
  }
  return out;
}

}  // namespace servogate::canopen
