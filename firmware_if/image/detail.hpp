// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace servogate::image {

/// Whose fields a Detail holds. A new kind is a line here; the cycle looks at none of them.
enum class DetailKind : std::uint16_t { none, can_frame, canopen_boot, drive_report };

/// The own fields of a notice, which its device writes and the words for people read: one plain struct, by
/// value. Everything is real-time safe.
class Detail {
 public:
  static constexpr std::size_t kBytes = 64;

  /// T: a struct without padding whose kDetail says what it is, so that equal notices have equal bytes.
  template <typename T>
  void put(const T& fields) noexcept {
    static_assert(std::has_unique_object_representations_v<T> && sizeof(T) <= kBytes);
    bytes_ = {};
    std::memcpy(bytes_.data(), &fields, sizeof fields);
    kind_ = T::kDetail;
  }
  /// nullopt: these are the fields of something else, or none.
  template <typename T>
  std::optional<T> get() const noexcept {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= kBytes);
    if (kind_ != T::kDetail) return std::nullopt;
    T fields;
    std::memcpy(&fields, bytes_.data(), sizeof fields);
    return fields;
  }
  DetailKind kind() const noexcept { return kind_; }

 private:
  DetailKind kind_ = DetailKind::none;
  std::array<std::byte, kBytes> bytes_{};
};

}  // namespace servogate::image
