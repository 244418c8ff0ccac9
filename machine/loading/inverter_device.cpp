// SPDX-License-Identifier: Apache-2.0
#include "machine/loading/inverter_device.hpp"

#include "machine/check/findings_inverter.hpp"

namespace servogate::machine {

namespace {

std::string needs_status() {
  return text::both("bits of the status need its address: `status`",
                    "битам состояния нужен его адрес: `status`");
}
std::string outside_mask() {
  return text::both("the value has bits that are none of the bits it is compared in",
                    "в значении есть биты, которых нет среди сравниваемых");
}
std::string must_be(const std::string& what) {
  return text::both("with protocol = \"huanyang\" it is " + what, "при protocol = \"huanyang\" это " + what);
}

}  // namespace

std::string_view DeviceConfig::required_text(std::uint16_t address, text::Language language) const {
  for (const InverterRequired& r : inverter.required)
    if (r.address == address) return language == text::Language::russian ? r.russian : r.english;
  return {};
}

void check_inverter_device(const DeviceConfig& device, Reading& reading) {
  const InverterMap& m = device.inverter;
  const auto at = [&](const std::string& key) { return device.where("inverter." + key); };
  const auto wrong = [&](const std::string& key, std::string words) {
    reading.error(at(key), finding::kInverterKey, {key, std::move(words)});
  };
  if (!device.places.contains("inverter"))
    return reading.error(device.where("kind"), finding::kNoInverter, {});
  for (const auto& [key, pair] :
       {std::pair("running", m.running), std::pair("at_speed", m.at_speed), std::pair("reversed", m.reversed),
        std::pair("tripped", m.tripped), std::pair("ready", m.ready)}) {
    if (!device.places.contains(std::string("inverter.") + key)) continue;
    if (m.status < 0) wrong(key, needs_status());
    if ((pair[1] & ~pair[0]) != 0 || pair[0] == 0) wrong(key, outside_mask());
  }
  if (m.write_function != 6 && m.write_function != 16)
    wrong("write_function", text::both("6 or 16", "6 или 16"));
  if (m.forward == m.stop) wrong("stop", text::both("it is `forward`", "совпадает с `forward`"));
  if (m.reverse >= 0 && (m.reverse == m.stop || m.reverse == m.forward))
    wrong("reverse", text::both("it is another command, too", "это уже другая команда"));
  if (m.reset_address >= 0 && m.reset < 0)
    wrong("reset_address", text::both("`reset` is missing", "нет `reset`"));
  for (std::size_t n = 0; n < m.required.size(); ++n)
    if (m.required[n].low > m.required[n].high)
      wrong("required", text::both("`low` is above `high`", "`low` больше `high`"));
  if (m.protocol != InverterProtocol::huanyang) return;
  if (m.command != 3) wrong("command", must_be("3"));
  if (m.frequency != 5) wrong("frequency", must_be("5"));
  if (m.output > 7) wrong("output", must_be("0-7"));
  if (m.status >= 0 && m.status != 3) wrong("status", must_be("3"));
  if (m.fault > 7) wrong("fault", must_be("0-7"));
  if (m.reset_address >= 0) wrong("reset_address", must_be("-1"));
  for (const InverterRequired& r : m.required)
    if (r.address > 255) wrong("required", must_be("PD0-PD255"));
}

}  // namespace servogate::machine
