// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/pdo_mapping.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint32_t key_of(std::uint16_t index, std::uint8_t subindex) noexcept {
  return static_cast<std::uint32_t>(index) << 8 | subindex;
}
constexpr std::uint32_t key_of(const ObjectSpec& s) noexcept { return key_of(s.index, s.subindex); }

constexpr bool writable(const ObjectSpec& s) noexcept {
  return s.access == Access::rw || s.access == Access::wo;
}

double real_of(DataType type, std::int64_t bits) noexcept {
  if (type == DataType::real32) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  return std::bit_cast<double>(bits);
}

/// The limits of a REAL are bits as its value is; none where they are wider than any number.
AbortCode check_real(const ObjectSpec& s, std::int64_t bits) noexcept {
  const double value = real_of(s.type, bits);
  if (s.high != std::numeric_limits<std::int64_t>::max() && value > real_of(s.type, s.high))
    return AbortCode::value_too_high;
  if (s.low != std::numeric_limits<std::int64_t>::min() && value < real_of(s.type, s.low))
    return AbortCode::value_too_low;
  return AbortCode::none;
}

}  // namespace

ObjectDictionary::ObjectDictionary(std::initializer_list<std::span<const ObjectSpec>> tables) {
  for (const auto table : tables) specs_.insert(specs_.end(), table.begin(), table.end());
  std::stable_sort(specs_.begin(), specs_.end(),
                   [](const ObjectSpec& a, const ObjectSpec& b) { return key_of(a) < key_of(b); });
  std::vector<ObjectSpec> unique;
  for (const ObjectSpec& s : specs_) {
    if (!unique.empty() && key_of(unique.back()) == key_of(s)) unique.pop_back();
    unique.push_back(s);
  }
  specs_ = std::move(unique);
  for (const ObjectSpec& s : specs_) {
    const bool text = size_of(s.type) == 0;
    text_of_.push_back(text ? static_cast<int>(texts_.size()) : -1);
    if (text) texts_.push_back({nullptr, std::max<std::size_t>({s.room, s.text.size(), kMaxText}), 0});
    stored_.push_back(s.value);
  }
  values_ = stored_;
  make_texts();
}

void ObjectDictionary::make_texts() {
  std::size_t all = 0, longest = 0;
  for (const Text& t : texts_) {
    all += t.room;
    longest = std::max(longest, t.room);
  }
  text_memory_ = std::make_unique_for_overwrite<char[]>(all);
  staging_ = std::make_unique_for_overwrite<std::uint8_t[]>(longest);
  char* next = text_memory_.get();
  for (Text& t : texts_) {
    t.bytes = next;
    next += t.room;
  }
  for (Slot slot = 0; slot < size(); ++slot) set_text(slot, spec(slot).text);
}

ObjectDictionary::Slot ObjectDictionary::find(std::uint16_t index, std::uint8_t subindex) const noexcept {
  const std::uint32_t key = key_of(index, subindex);
  const auto it = std::lower_bound(specs_.begin(), specs_.end(), key,
                                   [](const ObjectSpec& s, std::uint32_t k) { return key_of(s) < k; });
  return it != specs_.end() && key_of(*it) == key ? static_cast<Slot>(it - specs_.begin()) : kNone;
}

bool ObjectDictionary::has_index(std::uint16_t index) const noexcept {
  const auto it = std::lower_bound(specs_.begin(), specs_.end(), key_of(index, 0),
                                   [](const ObjectSpec& s, std::uint32_t k) { return key_of(s) < k; });
  return it != specs_.end() && it->index == index;
}

void ObjectDictionary::hide(Slot slot) {
  if (slot == kNone) return;
  hidden_.resize(specs_.size());
  hidden_[static_cast<std::size_t>(slot)] = true;
}

ObjectDictionary::Slot ObjectDictionary::find_visible(std::uint16_t index,
                                                      std::uint8_t subindex) const noexcept {
  const Slot slot = find(index, subindex);
  const bool hidden = slot != kNone && !hidden_.empty() && hidden_[static_cast<std::size_t>(slot)];
  return hidden ? kNone : slot;
}

bool ObjectDictionary::index_visible(std::uint16_t index) const noexcept {
  if (hidden_.empty()) return has_index(index);
  auto it = std::lower_bound(specs_.begin(), specs_.end(), key_of(index, 0),
                             [](const ObjectSpec& s, std::uint32_t k) { return key_of(s) < k; });
  for (; it != specs_.end() && it->index == index; ++it)
    if (!hidden_[static_cast<std::size_t>(it - specs_.begin())]) return true;
  return false;
}

std::int64_t& ObjectDictionary::variable(std::uint16_t index, std::uint8_t subindex) {
  const Slot slot = find(index, subindex);
  if (slot == kNone) throw std::out_of_range("the object dictionary lacks an object that its owner needs");
  return values_[static_cast<std::size_t>(slot)];
}

std::int64_t ObjectDictionary::get(std::uint16_t index, std::uint8_t subindex) const noexcept {
  const Slot slot = find(index, subindex);
  return slot == kNone ? 0 : value(slot);
}

void ObjectDictionary::set(std::uint16_t index, std::uint8_t subindex, std::int64_t value) noexcept {
  const Slot slot = find(index, subindex);
  if (slot != kNone) set_value(slot, value);
}

void ObjectDictionary::set_default(std::uint16_t index, std::uint8_t subindex, std::int64_t value) noexcept {
  const Slot slot = find(index, subindex);
  if (slot == kNone) return;
  const auto i = static_cast<std::size_t>(slot);
  specs_[i].value = stored_[i] = values_[i] = value;
}

std::string_view ObjectDictionary::text(Slot slot) const noexcept {
  const int place = text_of_[static_cast<std::size_t>(slot)];
  if (place < 0) return {};
  const Text& t = texts_[static_cast<std::size_t>(place)];
  return {t.bytes, t.length};
}

void ObjectDictionary::set_text(Slot slot, std::string_view text) noexcept {
  const int place = text_of_[static_cast<std::size_t>(slot)];
  if (place < 0) return;
  Text& t = texts_[static_cast<std::size_t>(place)];
  t.length = std::min(text.size(), t.room);
  std::copy_n(text.begin(), t.length, t.bytes);
}

std::span<std::uint8_t> ObjectDictionary::staging(Slot slot) noexcept {
  const int place = text_of_[static_cast<std::size_t>(slot)];
  if (place < 0) return {};
  return {staging_.get(), texts_[static_cast<std::size_t>(place)].room};
}

std::size_t ObjectDictionary::encode(Slot slot, std::span<std::uint8_t> bytes) const noexcept {
  const std::size_t size = size_of(spec(slot).type);
  if (size > 0) {
    store_le(static_cast<std::uint64_t>(value(slot)), bytes.first(size));
    return size;
  }
  const std::string_view t = text(slot).substr(0, bytes.size());
  std::copy(t.begin(), t.end(), bytes.begin());
  return t.size();
}

AbortCode ObjectDictionary::decode(Slot slot, std::span<const std::uint8_t> bytes,
                                   std::int64_t& value) const noexcept {
  const ObjectSpec& s = spec(slot);
  if (!writable(s)) return AbortCode::read_only;
  const std::size_t size = size_of(s.type);
  if (size == 0) {
    const auto place = static_cast<std::size_t>(text_of_[static_cast<std::size_t>(slot)]);
    return bytes.size() > texts_[place].room ? AbortCode::length_too_high : AbortCode::none;
  }
  if (bytes.size() > size) return AbortCode::length_too_high;
  if (bytes.size() < size) return AbortCode::length_too_low;
  const std::uint64_t raw = load_le(bytes);
  value = is_signed(s.type) ? sign_extend(raw, static_cast<std::uint32_t>(8 * size))
                            : static_cast<std::int64_t>(raw);
  return check_range(slot, value);
}

AbortCode ObjectDictionary::check_range(Slot slot, std::int64_t value) const noexcept {
  const ObjectSpec& s = spec(slot);
  if (s.type == DataType::boolean && value > 1) return AbortCode::value_too_high;
  if (is_real(s.type)) return check_real(s, value);
  if (s.type == DataType::unsigned64 && value < 0)  // beyond 2^63 - 1
    return s.high == std::numeric_limits<std::int64_t>::max() ? AbortCode::none : AbortCode::value_too_high;
  if (value > s.high) return AbortCode::value_too_high;
  return value < s.low ? AbortCode::value_too_low : AbortCode::none;
}

void ObjectDictionary::store(Range range) noexcept {
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (specs_[i].index >= range.first && specs_[i].index <= range.last && writable(specs_[i]))
      stored_[i] = values_[i];
}

void ObjectDictionary::forget(Range range) noexcept {
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (specs_[i].index >= range.first && specs_[i].index <= range.last) stored_[i] = specs_[i].value;
}

void ObjectDictionary::reset(Range range) noexcept {
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (specs_[i].index >= range.first && specs_[i].index <= range.last) values_[i] = stored_[i];
}

}  // namespace servogate::canopen
