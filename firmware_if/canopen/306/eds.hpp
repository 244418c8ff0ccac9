// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/canopen/306/eds_number.hpp"
#include "firmware_if/canopen/306/ini.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// AccessType. rwr and rww are rw that may be mapped into a TPDO or RPDO only.
enum class EdsAccess : std::uint8_t { ro, wo, rw, rwr, rww, constant };
/// ObjectType, by its number in CiA 301, 7.4.3.
enum class EdsObjectType : std::uint8_t {
  null = 0,
  domain = 2,
  deftype = 5,
  defstruct = 6,
  variable = 7,
  array = 8,
  record = 9,
};

/// A value as the file has it; `number` where its data type is one.
struct EdsValue {
  std::string text;
  std::optional<EdsNumber> number;
  std::string octets = {};  ///< read from a file, of a type of bytes (OCTET_STRING, DOMAIN ...): those bytes
  bool operator==(const EdsValue&) const = default;
};

/// What the file says of one index or sub-index.
struct EdsEntry {
  std::string name;
  EdsObjectType type = EdsObjectType::variable;
  std::uint16_t data_type = 0x0007;  ///< by its number in CiA 301, 7.4.7; 0 for arrays and records
  EdsAccess access = EdsAccess::rw;
  bool pdo_mapping = false;
  std::uint32_t flags = 0;  ///< ObjFlags: bit 0 not written by a download of a DCF, bit 1 not read by a scan
  std::optional<EdsValue> default_value, low_limit, high_limit;
  std::optional<EdsValue> parameter_value;  ///< of a DCF; an empty text is the empty string
  std::string denotation;                   ///< of a DCF: the user's name of it
  bool operator==(const EdsEntry&) const = default;

  /// The value of the configured device: the DCF's, otherwise the default. nullptr: none is said.
  const EdsValue* value() const noexcept {
    return parameter_value ? &*parameter_value : default_value ? &*default_value : nullptr;
  }
};

/// One index with its sub-indices; those of CompactSubObj are there one by one.
struct EdsObject {
  EdsEntry entry;
  std::map<std::uint8_t, EdsEntry> subs;  ///< empty for a variable or domain
  bool operator==(const EdsObject&) const = default;
};

/// DeviceComissioning of a DCF (with the spelling of CiA 306).
struct EdsCommissioning {
  NodeId node = 0;
  std::string node_name, network_name;
  std::uint32_t network = 0;
  std::uint32_t kbit_s = 0;
  bool manager = false;
  std::uint32_t lss_serial = 0;
  bool operator==(const EdsCommissioning&) const = default;
};

/// A module of a modular device: what an object gets for each of it that is connected.
struct EdsModule {
  std::string name;
  std::map<std::uint16_t, EdsObject> fixed;  ///< objects that are there once such a module is
  struct Extension {
    EdsEntry entry;
    std::uint8_t count = 1;
    bool operator==(const Extension&) const = default;
  };
  std::map<std::uint16_t, Extension> extensions;  ///< sub-indices added at the end of an object
  bool operator==(const EdsModule&) const = default;
};

/// A data sheet. What a device says of itself stays as text, since tools only show it.
struct Eds {
  using Fields = std::vector<std::pair<std::string, std::string>>;
  Fields file_info, device_info, dummy_usage, comments;
  std::map<std::uint16_t, EdsObject> objects;
  std::optional<EdsCommissioning> commissioning;
  std::map<int, EdsModule> modules;    ///< by number, from 1
  std::vector<int> connected_modules;  ///< of a DCF, by slot; already part of `objects`
  bool operator==(const Eds&) const = default;

  /// Entry of an index or sub-index; sub-index 0 of a variable is the index itself. nullptr: none.
  const EdsEntry* find(std::uint16_t index, std::uint8_t subindex) const noexcept;
  EdsEntry* find(std::uint16_t index, std::uint8_t subindex) noexcept;
  /// Text of a key of DeviceInfo in any case; empty when there is none.
  std::string_view device(std::string_view key) const noexcept;
};

struct EdsResult {
  Eds eds;
  std::vector<text::Finding> findings;
  /// There is at least one object, and no error.
  bool ok() const noexcept;
};

/// Reads an EDS or DCF. `file` is how findings call it. Every oddity is a warning with its line. Errors are a
/// file without objects, and a ParameterValue that is to be written into the device and is no value of its
/// type of bytes. An empty ParameterValue is the empty string of VISIBLE_STRING, OCTET_STRING and
/// UNICODE_STRING, and none of other types. Not real-time safe, as everything here.
EdsResult read_eds(std::string_view bytes, std::string_view file);

/// The data sheet as CiA 306 has it: sections in order, lists counted, numbers hexadecimal.
std::string write_eds(const Eds& eds);
/// The same with DeviceComissioning and the values of the configured device. `eds.commissioning` is needed;
/// without one node 0 is written.
std::string write_dcf(const Eds& eds);

/// Makes the values of a DCF that follow from the node-ID it is of ($NODEID in the default, identifiers of
/// the pre-defined connection set) sums with $NODEID, so that they are right for another node, too. How many.
int follow_node(Eds& eds);

/// Rows for an ObjectDictionary of this node, so that a device can be simulated from its data sheet that was
/// read from a file. Structure types are left out, as no object of one value has them. Texts and domains have
/// room for 1024 and 65536 bytes, or their longer default. They point into `eds`, which must live as long.
std::vector<ObjectSpec> object_specs(const Eds& eds, NodeId node);

/// Bits of a data type of CiA 301; 0: text, domain or unknown.
int eds_type_bits(std::uint16_t data_type) noexcept;
bool eds_type_signed(std::uint16_t data_type) noexcept;
bool eds_type_known(std::uint16_t data_type) noexcept;
/// VISIBLE_STRING, OCTET_STRING, UNICODE_STRING: a value may be empty.
constexpr bool eds_type_string(std::uint16_t data_type) noexcept {
  return data_type >= 0x09 && data_type <= 0x0B;
}
/// A download may write it: rw, rwr, rww, wo.
constexpr bool eds_writable(EdsAccess access) noexcept {
  return access != EdsAccess::ro && access != EdsAccess::constant;
}
/// REAL32, REAL64: values are written as decimal fractions.
constexpr bool eds_type_real(std::uint16_t data_type) noexcept {
  return data_type == 0x08 || data_type == 0x11;
}
/// "ro", "rwr", "const".
std::string_view eds_access_word(EdsAccess access) noexcept;

}  // namespace servogate::canopen
