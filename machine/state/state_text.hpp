// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>

#include "firmware_if/text/finding.hpp"
#include "machine/state/state.hpp"

namespace servogate::machine {

/// "origins", "tools" ...: name of the file and of its `part` key.
std::string_view part_name(StatePart part);

/// People edit it: what they have written is taken or refused with its place, never replaced by a copy from
/// before.
constexpr bool edited_by_people(StatePart part) {
  return part == StatePart::origins || part == StatePart::tools;
}

/// A double that TOML reads back as the same bits, with a point so that it stays a float.
std::string toml_real(double value);

/// CRC-32 of IEEE 802.3.
std::uint32_t crc32(std::string_view bytes);

namespace finding {
inline constexpr text::Entry kPreviousTaken{"state.previous_taken",
                                            "damaged; the previous generation is used, from {0}",
                                            "повреждён; взято предыдущее поколение из {0}"};
inline constexpr text::Entry kOtherCopyTaken{
    "state.other_copy_taken",
    "the retained values are those of this copy, generation {0}: the other is damaged",
    "сохраняемые значения взяты из этой копии, поколение {0}: другая повреждена"};
inline constexpr text::Entry kRetainedLost{"state.retained_lost",
                                           "the retained values of the PLC are lost: both this copy and {0} "
                                           "are damaged; move both away to start with the initial values",
                                           "сохраняемые значения ПЛК утрачены: и эта копия, и {0} "
                                           "повреждены; уберите обе, чтобы начать с начальных значений"};
/// {0} the other generation's file; {1} what is lost, {2} what to do then: halves of text::both.
inline constexpr text::Entry kPartLost{
    "state.part_lost",
    "both this file and {0}, the previous generation, are damaged: {1}; move both away, and {2}",
    "и этот файл, и {0}, предыдущее поколение, повреждены: {1}; уберите оба, и {2}"};
inline constexpr text::Entry kPartLostAlone{
    "state.part_lost",
    "this file is damaged, and there is no other generation ({0}): {1}; move it away, and {2}",
    "файл повреждён, а другого поколения ({0}) нет: {1}; уберите его, и {2}"};
inline constexpr text::Entry kChecksum{
    "state.checksum", "checksum {0} does not match the content ({1}): the file is cut off or changed",
    "контрольная сумма {0} не подходит к содержимому ({1}): обрезан или изменён"};
inline constexpr text::Entry kEdited{"state.edited", "edited by hand (checksum = \"none\"); used as it is",
                                     "изменён вручную (checksum = \"none\"); взят как есть"};
inline constexpr text::Entry kStateSyntax{"state.syntax", "TOML syntax: {0}", "синтаксис TOML: {0}"};
inline constexpr text::Entry kStateSchema{"state.schema", "schema {0} is not 1", "schema {0}, а не 1"};
inline constexpr text::Entry kStatePart{"state.part", "this file holds `{0}`, not `{1}`",
                                        "этот файл содержит «{0}», а не «{1}»"};
inline constexpr text::Entry kStateHead{"state.head", "does not begin with checksum = \"...\"",
                                        "не начинается с checksum = \"...\""};
inline constexpr text::Entry kTableEdited{"state.table_edited",
                                          "edited since the control wrote it; used as it is",
                                          "изменён после записи системой управления; взят как есть"};
inline constexpr text::Entry kTableCut{"state.table_cut",
                                       "the file is cut off: the line \"# end\" is missing",
                                       "файл обрезан: нет строки «# end»"};
inline constexpr text::Entry kTableAxis{"state.table_axis", "the machine has no axis {0}; it has {1}",
                                        "у станка нет оси {0}; есть {1}"};
inline constexpr text::Entry kTableTwice{"state.table_twice", "tool {0} stands in the file twice",
                                         "инструмент {0} записан в файле дважды"};
/// {0} the generation before.
inline constexpr text::Entry kTableRefused{
    "state.table_refused",
    "this file is not used, and nothing in it was changed: mend it, or go back to what the control wrote "
    "before: {0}",
    "файл не используется, и ничего в нём не изменено: исправьте его или вернитесь к записанному раньше: "
    "{0}"};
inline constexpr text::Entry kStateValue{"state.value", "`{0}`: {1} is expected", "«{0}»: ожидалось {1}"};
}  // namespace finding

}  // namespace servogate::machine
