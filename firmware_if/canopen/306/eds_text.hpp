// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// What a reader of data sheets has to say, in both languages.
namespace servogate::canopen::eds_text {

using text::Entry;

inline constexpr Entry kUtf16{"eds-utf16", "the file is UTF-16; CiA 306 has ASCII",
                              "файл в UTF-16, по CiA 306 должен быть ASCII"},
    kCodePage{"eds-code-page", "letters beyond ASCII are read as Latin-1",
              "символы вне ASCII прочитаны как Latin-1"},
    kZeroBytes{"eds-zero-bytes", "{0} zero bytes left out", "пропущено нулевых байтов: {0}"},
    kComment{"eds-comment", "comment with # or //; CiA 306 has ;",
             "комментарий через # или //, по CiA 306 должен быть ;"},
    kNoBracket{"eds-no-bracket", "section [{0} has no closing bracket",
               "у секции [{0} нет закрывающей скобки"},
    kSectionTwice{"eds-section-twice", "section [{0}] came already in line {1}; joined",
                  "секция [{0}] уже была в строке {1}; объединены"},
    kOutside{"eds-outside", "a line before the first section; left out",
             "строка до первой секции; пропущена"},
    kNoEquals{"eds-no-equals", "\"{0}\" without =; the first word is taken for the key",
              "«{0}» без знака =; ключом считается первое слово"},
    kNoKey{"eds-no-key", "a value without a key; left out", "значение без ключа; пропущено"},
    kQuotes{"eds-quotes", "{0}: quotation marks taken off", "{0}: кавычки сняты"},
    kKeyTwice{"eds-key-twice", "{0} came already in line {1}, that one counts",
              "{0} уже есть в строке {1}, действует та"},
    kNotANumber{"eds-not-a-number", "{0} = \"{1}\" is not a number; left out",
                "{0} = «{1}» — не число; пропущено"},
    kLeadingZeros{"eds-leading-zeros", "{0} = {1} has leading zeros; read as decimal {2}",
                  "{0} = {1}: ведущие нули; прочитано как десятичное {2}"},
    kHexSuffix{"eds-hex-suffix", "{0} = {1}: hexadecimal by h; CiA 306 has 0x",
               "{0} = {1}: шестнадцатеричное через h, по CiA 306 нужно 0x"},
    kNodeIdSign{"eds-nodeid-sign", "{0} = {1}: read as $NODEID", "{0} = {1}: прочитано как $NODEID"},
    kBooleanWord{"eds-boolean-word", "{0} = {1}: a word where CiA 306 has 0 or 1; read as {2}",
                 "{0} = {1}: слово вместо 0 или 1; прочитано как {2}"},
    kTrailingText{"eds-trailing-text", "{0} = {1}: read as {2}, the rest is left out",
                  "{0} = {1}: прочитано как {2}, остальное пропущено"},
    kNotBoolean{"eds-not-boolean", "{0} = {1} where only 0 and 1 are possible; read as 1",
                "{0} = {1}, а возможны только 0 и 1; прочитано как 1"},
    kDataType{"eds-data-type", "[{0}] has no data type that CiA 301 knows ({1}); taken for UNSIGNED32",
              "[{0}]: тип данных неизвестен CiA 301 ({1}); принят UNSIGNED32"},
    kStructureType{
        "eds-structure-type",
        "[{0}] has the data type {1}, a structure of a standard, profile or manufacturer; no single "
        "object has one, its value stays text",
        "[{0}]: тип данных {1} — структура стандарта, профиля или изготовителя; у одиночного "
        "объекта её не бывает, значение остаётся текстом"},
    kNoDataType{"eds-no-data-type", "[{0}] has no DataType; taken for UNSIGNED32",
                "[{0}]: нет DataType; принят UNSIGNED32"},
    kObjectType{"eds-object-type", "[{0}] has the object type {1}; taken for {2}",
                "[{0}]: тип объекта {1}; принят {2}"},
    kAccess{"eds-access", "[{0}] has the access type \"{1}\"; taken for {2}",
            "[{0}]: тип доступа «{1}»; принят {2}"},
    kOutOfType{"eds-out-of-type", "[{0}] {1} = {2} does not fit its data type; left out",
               "[{0}] {1} = {2} не помещается в тип данных; пропущено"},
    kNotBytes{
        "eds-not-bytes",
        "[{0}] {1} = {2}: bytes are expected (data type {3}), two hexadecimal digits each; not used",
        "[{0}] {1} = {2}: нужны байты (тип данных {3}), по две шестнадцатеричные цифры; не используется"},
    kNotSixBytes{"eds-not-six-bytes",
                 "[{0}] {1} = {2}: a time (data type {3}) has six bytes, twelve hexadecimal digits; not used",
                 "[{0}] {1} = {2}: время (тип данных {3}) — это шесть байтов, двенадцать шестнадцатеричных "
                 "цифр; не используется"},
    kNoBytesOfType{"eds-no-bytes-of-type",
                   "[{0}] {1} = {2} cannot be written: the data type {3} is no single value",
                   "[{0}] {1} = {2} нельзя записать: тип данных {3} — не одиночное значение"},
    kLimits{"eds-limits", "[{0}] LowLimit is above HighLimit; both left out",
            "[{0}]: LowLimit больше HighLimit; оба пропущены"},
    kSectionName{"eds-section-name", "section [{0}] is read as [{1}]", "секция [{0}] прочитана как [{1}]"},
    kOrphan{"eds-orphan", "[{0}] has no object [{1}] above it; taken for a record",
            "[{0}]: нет объекта [{1}]; принята запись"},
    kSubNumber{"eds-sub-number", "[{0}] says SubNumber {1}, the file has {2} sub-objects",
               "[{0}]: SubNumber {1}, а субобъектов в файле {2}"},
    kNotListed{"eds-not-listed", "[{0}] is in none of the object lists",
               "[{0}] нет ни в одном списке объектов"},
    kNoSection{"eds-no-section", "{0} is listed in [{1}] but has no section",
               "{0} есть в списке [{1}], но секции нет"},
    kListCount{"eds-list-count", "[{0}] says {1} entries and has {2}",
               "[{0}]: заявлено записей {1}, а есть {2}"},
    kCompact{"eds-compact", "[{0}] CompactSubObj {1} is more than 254; cut off",
             "[{0}]: CompactSubObj {1} больше 254; урезано"},
    kNoName{"eds-no-name", "[{0}] has no ParameterName", "[{0}]: нет ParameterName"},
    kModule{"eds-module", "module {0} is connected but not described", "модуль {0} подключён, но не описан"},
    kNoObjects{"eds-no-objects", "no object in the file: this is no EDS or DCF",
               "в файле нет ни одного объекта: это не EDS и не DCF"};

}  // namespace servogate::canopen::eds_text
