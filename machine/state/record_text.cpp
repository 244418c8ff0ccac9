// SPDX-License-Identifier: Apache-2.0
#include "machine/state/record_text.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include "machine/state/state_text.hpp"

namespace servogate::machine {

namespace {

using image::Format;
using program::RecordFile;

constexpr std::int64_t kMostRecords = 32767;
constexpr int kMostCharacters = 255;

std::string name_of(const RecordFile::Field& field) {
  return field.format == Format::in   ? "IN"
         : field.format == Format::re ? "RE"
         : field.format == Format::lr ? "LR"
                                      : std::to_string(field.length) + "CH";
}

std::optional<RecordFile::Field> field_of(const std::string& name) {
  if (name == "IN") return RecordFile::Field{Format::in};
  if (name == "RE") return RecordFile::Field{Format::re};
  if (name == "LR") return RecordFile::Field{Format::lr};
  int length = 0;
  const char* const end = name.data() + name.size();
  const auto [at, error] = std::from_chars(name.data(), end, length);
  if (error != std::errc{} || std::string_view(at, end) != "CH" || length < 1 || length > kMostCharacters)
    return std::nullopt;
  return RecordFile::Field{Format::ch, static_cast<std::uint8_t>(length)};
}

std::string as_characters(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | u >> 6);
      out += static_cast<char>(0x80 | (u & 0x3F));
    }
  }
  return out;
}

/// nullopt: a character is beyond U+00FF.
std::optional<std::string> as_bytes(std::string_view characters) {
  std::string out;
  for (std::size_t i = 0; i < characters.size(); ++i) {
    const auto u = static_cast<unsigned char>(characters[i]);
    if (u < 0x80) {
      out += characters[i];
      continue;
    }
    if ((u & 0xFC) != 0xC0 || i + 1 == characters.size()) return std::nullopt;
    out += static_cast<char>((u & 0x03) << 6 | (static_cast<unsigned char>(characters[++i]) & 0x3F));
  }
  return out;
}

class RecordReader {
 public:
  RecordReader(const std::string& file, std::vector<text::Finding>& findings)
      : file_(file), findings_(findings) {}

  void read(const Element& root, program::RecordFiles& files) {
    const Element* list = root.find("file");
    if (list == nullptr) return;
    if (list->kind != Element::Kind::array) return wrong(*list, "file", "[[file]]", "[[file]]");
    for (const Element& e : list->children) {
      const Element* name = e.find("name");
      if (name == nullptr || name->kind != Element::Kind::string || files.contains(name->string))
        wrong(name == nullptr ? e : *name, "name", "a name of its own", "собственное имя");
      else
        one(e, files[name->string]);
    }
  }

 private:
  void wrong(const Element& e, const std::string& name, std::string_view english, std::string_view russian) {
    findings_.push_back({text::Severity::error,
                         file_,
                         e.at.line,
                         e.at.column,
                         &finding::kStateValue,
                         {name, text::both(english, russian)}});
  }
  /// The members of a list; none, and told, where it is no list.
  const std::vector<Element>& list(const Element& around, const std::string& name) {
    static const std::vector<Element> kNone;
    const Element* e = around.find(name);
    if (e != nullptr && e->kind == Element::Kind::array) return e->children;
    wrong(e == nullptr ? around : *e, name, "a list", "список");
    return kNone;
  }
  std::int64_t whole(const Element& around, const std::string& name, std::int64_t max) {
    const Element* e = around.find(name);
    if (e != nullptr && e->kind == Element::Kind::integer && e->integer >= 1 && e->integer <= max)
      return e->integer;
    const std::string range = "1.." + std::to_string(max);
    wrong(e == nullptr ? around : *e, name, "a whole number, " + range, "целое число, " + range);
    return 1;
  }
  void one(const Element& e, RecordFile& out) {
    out.capacity = static_cast<int>(whole(e, "capacity", kMostRecords));
    for (const Element& text : list(e, "fields")) {
      const auto field = text.kind == Element::Kind::string ? field_of(text.string) : std::nullopt;
      if (!field)
        return wrong(text, "fields", "\"IN\", \"RE\", \"LR\" or \"nCH\"",
                     "\"IN\", \"RE\", \"LR\" или \"nCH\"");
      out.fields.push_back(*field);
    }
    for (const Element& record : list(e, "records")) {
      const auto number = static_cast<int>(whole(record, "number", out.capacity));
      const std::vector<Element>& items = list(record, "items");
      if (items.size() != out.fields.size())
        return wrong(record, "items", "an item for each field", "значение для каждого поля");
      if (out.records.contains(number))
        return wrong(record, "number", "a number of its own", "собственный номер");
      RecordFile::Record& row = out.records[number];
      for (std::size_t n = 0; n < items.size(); ++n) row.push_back(item(items[n], out.fields[n]));
    }
  }
  RecordFile::Item item(const Element& e, const RecordFile::Field& field) {
    RecordFile::Item out;
    if (field.format == Format::ch) {
      const auto bytes = e.kind == Element::Kind::string ? as_bytes(e.string) : std::nullopt;
      if (bytes && bytes->size() <= field.length)
        out.text = *bytes;
      else
        wrong(e, "items", "a text of the field's length", "текст длиной не больше поля");
    } else if (e.numeric() && std::isfinite(e.number())) {
      out.number = e.number();
    } else {
      wrong(e, "items", "a finite number", "конечное число");
    }
    return out;
  }

  const std::string& file_;
  std::vector<text::Finding>& findings_;
};

}  // namespace

std::string write_records(const program::RecordFiles& files) {
  std::string out;
  for (const auto& [name, file] : files) {
    out += "\n[[file]]\nname = " + quoted(name) + "\ncapacity = " + std::to_string(file.capacity) +
           "\nfields = [";
    for (std::size_t n = 0; n < file.fields.size(); ++n)
      out += (n == 0 ? "" : ", ") + quoted(name_of(file.fields[n]));
    out += "]\nrecords = [";
    for (const auto& [number, record] : file.records) {
      out += "\n  { number = " + std::to_string(number) + ", items = [";
      for (std::size_t n = 0; n < record.size(); ++n)
        out += (n == 0 ? "" : ", ") + (file.fields[n].format == Format::ch
                                           ? quoted(as_characters(record[n].text))
                                           : toml_real(record[n].number));
      out += "] },";
    }
    out += file.records.empty() ? "]\n" : "\n]\n";
  }
  return out;
}

void read_records(const Element& root, const std::string& file, program::RecordFiles& files,
                  std::vector<text::Finding>& findings) {
  files.clear();
  RecordReader(file, findings).read(root, files);
}

}  // namespace servogate::machine
