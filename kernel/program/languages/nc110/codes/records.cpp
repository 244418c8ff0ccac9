// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"

/// Files of records in the tables of the machine, so that a dry run, a search and a replay work on a copy.
/// Source: NC-110 programmer's manual, chapter 5 (specification B 16).
namespace servogate::program::nc110 {
namespace {

constexpr int kChannels = 9, kStructures = 255, kMostRecords = 32767;
constexpr std::size_t kMostFields = 17;
constexpr long long kMostItems = 100'000;  ///< of all files
constexpr std::string_view kOrders[] = {"OPN", "RED", "WRT", "CLO", "CRE", "CAN"};

/// Table 5.2 of the manual, as far as the faults exist here.
enum class Trouble : std::uint8_t {
  none = 0,
  channel = 1,
  channel_number = 2,
  no_file = 4,
  file_exists = 5,
  only_read = 6,
  file_open = 7,
  not_open = 8,
  layout = 10,
  no_record = 11,
  end_of_file = 13,
  device = 15,
  no_structure = 16,
  memory = 17,
};
constexpr struct {
  Trouble trouble;
  std::string_view english, russian;
} kWords[] = {
    {Trouble::channel,
     "another file is open on this channel, or CLO names one that is closed: check the channel",
     "на этом канале открыт другой файл, или CLO называет закрытый канал: проверьте канал"},
    {Trouble::channel_number, "the channels are 1 to 9", "каналы — с 1 по 9"},
    {Trouble::no_file, "there is no such file: create it by CRE", "такого файла нет: создайте его через CRE"},
    {Trouble::file_exists, "the file exists already: delete it by CAN first, or open it by OPN",
     "файл уже существует: сначала удалите его через CAN или откройте через OPN"},
    {Trouble::only_read, "the file is open for reading only: open it with W",
     "файл открыт только для чтения: откройте его с W"},
    {Trouble::file_open, "the file is open: close it by CLO first",
     "файл открыт: сначала закройте его через CLO"},
    {Trouble::not_open, "no file is open on this channel: open one by OPN",
     "на этом канале файл не открыт: откройте его через OPN"},
    {Trouble::layout, "the fields of the file are other ones than those of the structure: check DER",
     "поля файла отличаются от полей структуры: проверьте DER"},
    {Trouble::no_record, "the file has no record of this number", "в файле нет записи с таким номером"},
    {Trouble::end_of_file, "the last record has been passed", "последняя запись уже пройдена"},
    {Trouble::device, "the devices are MP0 to MP6", "устройства — с MP0 по MP6"},
    {Trouble::no_structure, "the structure is not defined: define it by DER",
     "структура не определена: определите её через DER"},
    {Trouble::memory, "all record files together hold at most 100000 fields: delete one by CAN",
     "все файлы записей вместе содержат не более 100000 полей: удалите лишний через CAN"},
};

int column(const Operand& item) { return static_cast<int>(item.begin) + 1; }

image::Format format_of_parameter(int index) {
  return index >= 30   ? image::Format::lr
         : index >= 25 ? image::Format::re
         : index >= 20 ? image::Format::li
         : index >= 10 ? image::Format::in
                       : image::Format::by;
}

/// One order of a block to the record files. Each function does nothing at all where it finds a trouble.
class Order {
 public:
  Order(Execution& run, const Operands& operands)
      : run_(run), operands_(operands), open_(run.state().records), tables_(run.state().frames.tables) {}

  Trouble carry_out() {
    const std::string_view code = operands_.rule->name;
    if (code == "OPN") return open();
    if (code == "CLO") return close();
    if (code == "CRE") return create();
    if (code == "CAN") return remove();
    return move(code == "WRT");
  }

 private:
  const Operand& item(std::size_t n) const { return operands_.items[n]; }
  int whole(std::size_t n) const { return run_.numbers().whole(item(n).value, operands_.rule->name); }

  /// The name before the device.
  Trouble file(std::size_t n, std::string& name) const {
    name = code::program_name(operands_, item(n));
    const std::string_view text = operands_.text(item(n));
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos) return Trouble::none;
    const std::string_view device = text.substr(slash + 1);
    const bool good = device.size() == 3 && device.starts_with("MP") && device[2] >= '0' && device[2] <= '6';
    return good ? Trouble::none : Trouble::device;
  }
  const RecordFile* find(const std::string& name) const {
    const auto at = tables_->record_files.find(name);
    return at == tables_->record_files.end() ? nullptr : &at->second;
  }
  bool is_open(const std::string& name, bool to_write, int but) const {
    return std::any_of(open_.channels.begin(), open_.channels.end(), [&](const auto& entry) {
      return entry.first != but && entry.second.file == name && (to_write || entry.second.writes);
    });
  }
  const OpenRecords::Structure* structure(std::size_t n) const {
    const auto at = open_.structures.find(whole(n));
    return at == open_.structures.end() ? nullptr : &at->second;
  }

  Trouble open() {
    bool writes = false;
    if (operands_.count > 2) {
      const std::string_view access = operands_.text(item(2));
      if (access != "R" && access != "W") fail(Wrong::record_access, column(item(2)), {std::string(access)});
      writes = access == "W";
    }
    std::string name;
    if (const Trouble wrong = file(1, name); wrong != Trouble::none) return wrong;
    const int channel = whole(0);
    if (channel < 1 || channel > kChannels) return Trouble::channel_number;
    const auto used = open_.channels.find(channel);
    if (used != open_.channels.end() && used->second.file != name) return Trouble::channel;
    if (find(name) == nullptr) return Trouble::no_file;
    if (is_open(name, writes, channel)) return Trouble::file_open;
    open_.channels[channel] = {name, writes, 1};
    return Trouble::none;
  }

  Trouble close() {
    if (operands_.count == 0) {
      open_.channels.clear();
      return Trouble::none;
    }
    const int channel = whole(0);
    if (channel < 1 || channel > kChannels) return Trouble::channel_number;
    return open_.channels.erase(channel) != 0 ? Trouble::none : Trouble::channel;
  }

  Trouble create() {
    const int records = whole(2);
    if (records < 1 || records > kMostRecords)
      fail(Wrong::record_count, item(2).value.column,
           {std::to_string(kMostRecords), std::to_string(records)});
    std::string name;
    if (const Trouble wrong = file(1, name); wrong != Trouble::none) return wrong;
    const OpenRecords::Structure* fields = structure(0);
    if (fields == nullptr) return Trouble::no_structure;
    if (find(name) != nullptr) return Trouble::file_exists;
    const auto items = [](long long sum, const auto& entry) {
      return sum + static_cast<long long>(entry.second.fields.size()) * entry.second.capacity;
    };
    const auto& files = tables_->record_files;
    if (std::accumulate(files.begin(), files.end(), static_cast<long long>(fields->fields.size()) * records,
                        items) > kMostItems)
      return Trouble::memory;
    change([&](RecordFiles& all) { all[name] = {fields->fields, records, {}}; });
    return Trouble::none;
  }

  Trouble remove() {
    std::string name;
    if (const Trouble wrong = file(0, name); wrong != Trouble::none) return wrong;
    if (find(name) == nullptr) return Trouble::no_file;
    if (is_open(name, true, 0)) return Trouble::file_open;
    change([&](RecordFiles& all) { all.erase(name); });
    return Trouble::none;
  }

  /// RED and WRT.
  Trouble move(bool writes) {
    const int number = whole(0);
    if (number < 1 || number > kChannels) return Trouble::channel_number;
    const auto channel = open_.channels.find(number);
    if (channel == open_.channels.end()) return Trouble::not_open;
    if (writes && !channel->second.writes) return Trouble::only_read;
    const OpenRecords::Structure* fields = structure(1);
    if (fields == nullptr) return Trouble::no_structure;
    const RecordFile* records = find(channel->second.file);
    if (records == nullptr) return Trouble::no_file;
    if (records->fields != fields->fields) return Trouble::layout;
    const bool named = operands_.count > 2;
    const int record = named ? whole(2) : channel->second.next;
    if (record < 1 || record > records->capacity) return named ? Trouble::no_record : Trouble::end_of_file;
    if (writes)
      write(channel->second.file, record, *fields);
    else
      read(*records, record, *fields);
    channel->second.next = record + 1;
    return Trouble::none;
  }

  void write(const std::string& name, int number, const OpenRecords::Structure& structure) {
    RecordFile::Record record;
    for (const OpenRecords::Variable& v : structure.variables) {
      RecordFile::Item& item = record.emplace_back();
      if (v.parameter >= 0) {
        item.number = run_.parameter(v.parameter, operands_.column);
      } else if (v.place.format == image::Format::ch) {
        run_.use_snapshot();
        item.text = run_.characters(v.place, operands_.column);
      } else {
        item.number = run_.place(v.place, operands_.column);
      }
    }
    change([&](RecordFiles& all) { all[name].records[number] = std::move(record); });
  }

  void read(const RecordFile& records, int number, const OpenRecords::Structure& structure) {
    const auto found = records.records.find(number);
    const RecordFile::Record blank(structure.fields.size());
    const RecordFile::Record record = found == records.records.end() ? blank : found->second;
    for (std::size_t n = 0; n < structure.variables.size(); ++n) {
      const OpenRecords::Variable& v = structure.variables[n];
      if (v.parameter >= 0)
        run_.state().parameters.set(v.parameter, record[n].number, operands_.column);
      else if (v.place.format == image::Format::ch)
        run_.write(v.place, record[n].text, operands_.column);
      else
        run_.write(v.place, record[n].number, operands_.column);
    }
  }

  template <typename Change>
  void change(Change make) {
    auto tables = std::make_shared<Tables>(*tables_);
    make(tables->record_files);
    tables_ = std::move(tables);
  }

  Execution& run_;
  const Operands& operands_;
  OpenRecords& open_;
  std::shared_ptr<const Tables>& tables_;
};

OpenRecords::Variable variable_of(const Execution& run, const Operands& operands, const Operand& item) {
  const std::string_view line = operands.block->line.substr(0, item.end);
  std::size_t pos = item.begin;
  OpenRecords::Variable variable;
  if (line[pos] == 'E') {
    variable.parameter = read_index(line, ++pos);
  } else if (names_place(line.substr(pos))) {
    variable.place = read_place(line, pos);
  } else {
    pos = item.begin;
  }
  if (pos != item.end || pos == item.begin)
    fail(Wrong::record_field, column(item), {std::string(operands.text(item))});
  if (variable.parameter >= 0) run.parameter(variable.parameter, column(item));
  return variable;
}

}  // namespace

namespace code {

bool orders_records(std::string_view code) {
  return std::find(std::begin(kOrders), std::end(kOrders), code) != std::end(kOrders);
}

void der(Execution& run, const Operands& operands) {
  const int number = run.numbers().whole(operands.items[0].value, operands.rule->name);
  if (number < 1 || number > kStructures)
    fail(Wrong::record_structure, operands.items[0].value.column,
         {"DER", std::to_string(kStructures), std::to_string(number)});
  if (operands.count > kMostFields + 1)
    fail(Wrong::record_fields, column(operands.items[kMostFields + 1]),
         {std::to_string(operands.count - 1), std::to_string(kMostFields)});
  OpenRecords::Structure structure;
  for (std::size_t n = 1; n < operands.count; ++n) {
    const OpenRecords::Variable v = variable_of(run, operands, operands.items[n]);
    RecordFile::Field field;
    field.format = v.parameter >= 0 ? format_of_parameter(v.parameter) : v.place.format;
    if (field.format == image::Format::ch) field.length = static_cast<std::uint8_t>(v.place.length);
    using image::Format;
    constexpr std::array kStored{Format::in, Format::re, Format::lr, Format::ch};
    if (std::find(kStored.begin(), kStored.end(), field.format) == kStored.end())
      fail(Wrong::record_field, column(operands.items[n]), {std::string(operands.text(operands.items[n]))});
    structure.variables.push_back(v);
    structure.fields.push_back(field);
  }
  run.state().records.structures[number] = std::move(structure);
}

/// OPN, RED, WRT, CLO, CRE and CAN. What goes wrong ends the program, or with ERR=1 it is told and the
/// program asks for it by IOSTA.
void record_file(Execution& run, const Operands& operands) {
  const Trouble trouble = Order(run, operands).carry_out();
  run.state().own[at(Own::iosta)] = static_cast<double>(trouble);
  if (trouble == Trouble::none) return;
  const auto words = std::find_if(std::begin(kWords), std::end(kWords),
                                  [&](const auto& row) { return row.trouble == trouble; });
  std::vector<std::string> arguments{std::string(operands.rule->name),
                                     std::to_string(static_cast<int>(trouble)),
                                     text::both(words->english, words->russian)};
  if (run.state().own[at(Own::err)] == 0.0) fail(Wrong::record_file, operands.column, std::move(arguments));
  Written place = run.capability().written(operands.column);
  run.capability().warn(place, entry(Wrong::record_file), std::move(arguments));
}

}  // namespace code

namespace variable {

void err(Execution& run, double value, int, int column) {
  if (value != 0.0 && value != 1.0)
    fail(Fault::variable_range, column, {"ERR", text::number(value), "0", "1"});
  run.state().own[at(Own::err)] = value;
}

}  // namespace variable
}  // namespace servogate::program::nc110
