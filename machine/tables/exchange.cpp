// SPDX-License-Identifier: Apache-2.0
#include "machine/tables/exchange.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "firmware_if/text/csv.hpp"
#include "machine/state/state_text.hpp"
#include "machine/state/table_text.hpp"

namespace servogate::machine {

namespace {

constexpr text::Entry kBadHeader{"tables.header", "the first line must begin with `{0}`, as {1}",
                                 "первая строка должна начинаться с `{0}`, например {1}"};
constexpr text::Entry kBadColumn{"tables.column", "unknown column `{0}`; known: {1}",
                                 "неизвестный столбец «{0}»; допустимы: {1}"};
constexpr text::Entry kBadFields{"tables.fields", "{0} fields, and the header has {1}",
                                 "полей: {0}, а в заголовке {1}"};
constexpr text::Entry kBadValue{"tables.value", "`{0}`: '{1}' is not {2}", "«{0}»: «{1}» — не {2}"};
constexpr text::Entry kTwice{"tables.twice", "number {0} stands in the file twice",
                             "номер {0} записан в файле дважды"};
constexpr text::Entry kBadWord{"tables.word", "'{0}' is no word of a LinuxCNC tool table",
                               "«{0}» — не слово таблицы инструментов LinuxCNC"};
constexpr text::Entry kNoNumber{"tables.no-number", "the line has no T", "в строке нет T"};
constexpr text::Entry kOnlyTools{"tables.only-tools", "a LinuxCNC tool table has no origins; give a CSV file",
                                 "в таблице инструментов LinuxCNC нет начал отсчёта; нужен файл CSV"};

std::string number(double value) {
  char digits[40];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string cell(const std::map<std::string, double>& row, const std::string& axis) {
  const auto found = row.find(axis);
  return found == row.end() ? std::string() : number(found->second);
}

/// A field with its place in the file.
struct Cell {
  std::string text;
  int line = 1, column = 1;
};

/// Rows of a CSV text; a quoted field may hold commas, quotes and line breaks.
std::vector<std::vector<Cell>> rows_of(std::string_view text) {
  std::vector<std::vector<Cell>> rows;
  std::vector<Cell> row;
  Cell now;
  int line = 1, column = 1;
  bool quoted = false;
  const auto end_field = [&] {
    row.push_back(now);
    now = {};
  };
  const auto end_row = [&] {
    end_field();
    const bool empty = row.size() == 1 && row[0].text.find_first_not_of(" \t") == std::string::npos;
    if (!empty) rows.push_back(row);
    row.clear();
  };
  now = {{}, 1, 1};
  for (std::size_t i = 0; i < text.size(); ++i, ++column) {
    const char c = text[i];
    if (quoted) {
      if (c == '"' && i + 1 < text.size() && text[i + 1] == '"')
        now.text += '"', ++i, ++column;
      else if (c == '"')
        quoted = false;
      else
        now.text += c;
    } else if (c == '"' && now.text.empty()) {
      quoted = true;
    } else if (c == ',') {
      end_field();
      now.line = line, now.column = column + 1;
    } else if (c == '\n') {
      end_row();
      now.line = line + 1, now.column = 1;
    } else if (c != '\r') {
      now.text += c;
    }
    if (c == '\n') ++line, column = 0;
  }
  if (!now.text.empty() || !row.empty()) end_row();
  return rows;
}

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t");
  return from == std::string::npos ? std::string() : text.substr(from, to - from + 1);
}

/// What both forms fill, with the words of their mistakes.
class TableBuilder {
 public:
  TableBuilder(const std::string& file, TableKind kind, const std::vector<std::string>& axes,
               std::vector<text::Finding>& findings)
      : file_(file), kind_(kind), axes_(axes), findings_(findings) {}

  bool good() const { return good_; }
  void wrong(const Cell& at, const text::Entry& entry, std::vector<std::string> arguments) {
    findings_.push_back({text::Severity::error, file_, at.line, at.column, &entry, std::move(arguments)});
    good_ = false;
  }
  bool is_axis(const std::string& name) const {
    return std::find(axes_.begin(), axes_.end(), name) != axes_.end();
  }
  /// nullopt: it was said.
  std::optional<double> value(const Cell& cell, const std::string& name, double min, double max,
                              bool whole = false) {
    std::string digits = trimmed(cell.text);
    if (digits.starts_with('+')) digits.erase(0, 1);
    double v = 0.0;
    const char* const end = digits.data() + digits.size();
    const auto [at, error] = std::from_chars(digits.data(), end, v);
    if (!digits.empty() && error == std::errc{} && at == end && std::isfinite(v) && v >= min && v <= max &&
        (!whole || v == std::floor(v)))
      return v;
    const std::string range = number(min) + ".." + number(max);
    wrong(cell, kBadValue,
          {name, cell.text,
           whole ? text::both("a whole number, " + range, "целое число, " + range)
                 : text::both("a number, " + range, "число, " + range)});
    return std::nullopt;
  }
  /// The row of this number, made for it; nullptr: it was said.
  program::Tables::Corrector* tool(const Cell& cell) {
    const auto n = value(cell, "tool", 1.0, kLastTool, true);
    if (!n) return nullptr;
    const auto [at, fresh] = tables.correctors.try_emplace(static_cast<int>(*n));
    if (!fresh) wrong(cell, kTwice, {number(*n)});
    return &at->second;
  }
  std::map<std::string, double>* origin(const Cell& cell) {
    const auto n = value(cell, "origin", 0.0, kLastOrigin, true);
    if (!n) return nullptr;
    const auto [at, fresh] = tables.origins.try_emplace(static_cast<int>(*n));
    if (!fresh) wrong(cell, kTwice, {number(*n)});
    return &at->second;
  }
  TableKind kind() const { return kind_; }
  const std::vector<std::string>& axes() const { return axes_; }

  program::Tables tables;

 private:
  const std::string& file_;
  TableKind kind_;
  const std::vector<std::string>& axes_;
  std::vector<text::Finding>& findings_;
  bool good_ = true;
};

/// Limits of the wear are columns where a row has one.
std::string header(TableKind kind, const std::vector<std::string>& axes, bool limits = false) {
  std::string out = kind == TableKind::origins
                        ? "origin"
                        : "tool,name,radius,radius_wear,quadrant,life_min,used_min,alternate";
  for (const std::string& a : axes) out += "," + text::csv_field(a);
  if (kind == TableKind::tools)
    for (const std::string& a : axes) out += ",wear_" + text::csv_field(a);
  if (limits) out += ",radius_wear_limit";
  if (limits)
    for (const std::string& a : axes) out += ",wear_limit_" + text::csv_field(a);
  return out;
}

void set_tool_field(TableBuilder& b, program::Tables::Corrector& tool, const std::string& column,
                    const Cell& cell) {
  if (column == "name") {
    tool.name = cell.text;
    return;
  }
  if (trimmed(cell.text).empty()) return;
  const bool of_quadrant = column == "quadrant", of_radius = column == "radius";
  if (column == "life_min" || column == "used_min" || column == "alternate") {
    const bool of_alternate = column == "alternate";
    const auto v = b.value(cell, column, 0.0, of_alternate ? kLastTool : kLongestLife, of_alternate);
    if (v && of_alternate) tool.alternate = static_cast<int>(*v);
    if (v && !of_alternate) (column == "life_min" ? tool.life_min : tool.used_min) = *v;
    return;
  }
  const bool of_limit = column == "radius_wear_limit" || column.starts_with("wear_limit_");
  const auto v = b.value(cell, column, of_quadrant || of_radius || of_limit ? 0.0 : -kLongestEntry,
                         of_quadrant ? 9.0 : kLongestEntry, of_quadrant);
  if (!v) return;
  if (of_quadrant)
    tool.quadrant = static_cast<int>(*v);
  else if (of_radius)
    tool.radius = *v;
  else if (column == "radius_wear")
    tool.radius_wear = *v;
  else if (column == "radius_wear_limit")
    tool.radius_wear_limit = *v;
  else if (of_limit)
    tool.wear_limit[column.substr(11)] = *v;
  else if (column.starts_with("wear_"))
    tool.wear[column.substr(5)] = *v;
  else
    tool.length[column] = *v;
}

bool known_column(const TableBuilder& b, const std::string& name) {
  if (b.is_axis(name)) return true;
  if (b.kind() == TableKind::origins) return false;
  return name == "name" || name == "radius" || name == "radius_wear" || name == "quadrant" ||
         name == "life_min" || name == "used_min" || name == "alternate" || name == "radius_wear_limit" ||
         (name.starts_with("wear_limit_") && b.is_axis(name.substr(11))) ||
         (name.starts_with("wear_") && b.is_axis(name.substr(5)));
}

void read_csv(std::string_view text, TableBuilder& b) {
  const std::vector<std::vector<Cell>> rows = rows_of(text);
  const std::string first = b.kind() == TableKind::origins ? "origin" : "tool";
  if (rows.empty() || trimmed(rows[0][0].text) != first)
    return b.wrong(rows.empty() ? Cell{} : rows[0][0], kBadHeader, {first, header(b.kind(), b.axes())});
  std::vector<std::string> columns;
  for (std::size_t c = 0; c < rows[0].size(); ++c) {
    columns.push_back(trimmed(rows[0][c].text));
    if (c > 0 && !known_column(b, columns[c]))
      b.wrong(rows[0][c], kBadColumn, {columns[c], header(b.kind(), b.axes())});
  }
  if (!b.good()) return;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::vector<Cell>& row = rows[r];
    if (row.size() != columns.size()) {
      b.wrong(row[0], kBadFields, {std::to_string(row.size()), std::to_string(columns.size())});
      continue;
    }
    if (b.kind() == TableKind::tools) {
      program::Tables::Corrector* tool = b.tool(row[0]);
      for (std::size_t c = 1; tool != nullptr && c < row.size(); ++c)
        set_tool_field(b, *tool, columns[c], row[c]);
      continue;
    }
    std::map<std::string, double>* origin = b.origin(row[0]);
    for (std::size_t c = 1; origin != nullptr && c < row.size(); ++c)
      if (!trimmed(row[c].text).empty())
        if (const auto v = b.value(row[c], columns[c], -kLongestEntry, kLongestEntry))
          (*origin)[columns[c]] = *v;
  }
}

/// One line of a LinuxCNC tool table; `line` without what stands behind a semicolon, which is the name.
void read_tool_line(std::string_view line, int number_of_line, const std::string& name, TableBuilder& b) {
  program::Tables::Corrector* tool = nullptr;
  std::vector<std::pair<char, Cell>> words;
  for (std::size_t i = 0; i < line.size();) {
    if (line[i] == ' ' || line[i] == '\t' || line[i] == '\r') {
      ++i;
      continue;
    }
    const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
    const Cell cell{std::string(line.substr(i + 1, end - i - 1)), number_of_line, static_cast<int>(i) + 1};
    const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(line[i])));
    if (letter == 'T')
      tool = b.tool(cell);
    else
      words.emplace_back(letter, cell);
    i = end;
  }
  if (words.empty() && tool == nullptr) return;
  if (tool == nullptr) {
    if (b.good()) b.wrong({{}, number_of_line, 1}, kNoNumber, {});
    return;
  }
  tool->name = name;
  for (const auto& [letter, cell] : words) {
    const std::string word(1, letter);
    if (letter == 'P' || letter == 'I' || letter == 'J') continue;  // pocket, angles of the edges
    if (letter == 'D') {
      if (const auto v = b.value(cell, word, 0.0, kLongestEntry)) tool->radius = *v / 2.0;
    } else if (letter == 'Q') {
      if (const auto v = b.value(cell, word, 0.0, 9.0, true)) tool->quadrant = static_cast<int>(*v);
    } else if (b.is_axis(word)) {
      if (const auto v = b.value(cell, word, -kLongestEntry, kLongestEntry)) tool->length[word] = *v;
    } else if (std::string_view("XYZABCUVW").find(letter) == std::string_view::npos) {
      b.wrong(cell, kBadWord, {word + cell.text});
    } else if (const auto v = b.value(cell, word, -kLongestEntry, kLongestEntry); v && *v != 0.0) {
      b.wrong(cell, finding::kTableAxis, {word, header(TableKind::origins, b.axes()).substr(7)});
    }
  }
}

void read_linuxcnc(std::string_view text, TableBuilder& b) {
  if (b.kind() == TableKind::origins) return b.wrong({}, kOnlyTools, {});
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view whole = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t semicolon = std::min(whole.find(';'), whole.size());
    std::string name(whole.substr(std::min(semicolon + 1, whole.size())));
    while (!name.empty() && name.back() == '\r') name.pop_back();
    read_tool_line(whole.substr(0, semicolon), line, trimmed(name), b);
  }
}

}  // namespace

std::string life_words(double life_min, double used_min, int alternate) {
  std::string out;
  if (life_min > 0.0)
    out = text::both("used for ", "отработал ") + text::number(used_min, 1) + text::both(" of ", " из ") +
          text::number(life_min, 2) + text::both(" min", " мин");
  if (alternate != 0)
    out += (out.empty() ? "" : ", ") + text::both("alternate T", "замена T") + std::to_string(alternate);
  return out;
}

bool names_linuxcnc(std::string_view file) { return file.ends_with(".tbl") || file.ends_with(".tool"); }

std::string to_csv(const program::Tables& tables, TableKind kind, const std::vector<std::string>& axes) {
  const bool limits = std::any_of(tables.correctors.begin(), tables.correctors.end(), [](const auto& row) {
    return !row.second.wear_limit.empty() || row.second.radius_wear_limit != 0.0;
  });
  std::string out = header(kind, axes, limits) + "\r\n";
  if (kind == TableKind::origins) {
    for (const auto& [n, row] : tables.origins) {
      out += std::to_string(n);
      for (const std::string& a : axes) out += "," + cell(row, a);
      out += "\r\n";
    }
    return out;
  }
  for (const auto& [n, c] : tables.correctors) {
    out += std::to_string(n) + "," + text::csv_field(c.name) + "," + number(c.radius) + "," +
           number(c.radius_wear) + "," + std::to_string(c.quadrant) + "," + number(c.life_min) + "," +
           number(c.used_min) + "," + std::to_string(c.alternate);
    for (const std::string& a : axes) out += "," + cell(c.length, a);
    for (const std::string& a : axes) out += "," + cell(c.wear, a);
    if (limits) out += "," + number(c.radius_wear_limit);
    if (limits)
      for (const std::string& a : axes) out += "," + cell(c.wear_limit, a);
    out += "\r\n";
  }
  return out;
}

std::string to_linuxcnc(const program::Tables& tables, const std::vector<std::string>& axes) {
  std::string out;
  char value[48];
  for (const auto& [n, c] : tables.correctors) {
    out += "T" + std::to_string(n) + " P" + std::to_string(n);
    for (const std::string& a : axes) {
      const double length = c.length_of(a);
      if (length == 0.0 || std::string_view("XYZABCUVW").find(a) == std::string_view::npos) continue;
      std::snprintf(value, sizeof value, " %s%+.6f", a.c_str(), length);
      out += value;
    }
    std::snprintf(value, sizeof value, " D%.6f", 2.0 * (c.radius + c.radius_wear));
    out += value;
    if (c.quadrant != 0) out += " Q" + std::to_string(c.quadrant);
    if (!c.name.empty()) out += " ;" + c.name;
    out += "\n";
  }
  return out;
}

bool read_exchange(std::string_view text, const std::string& file, TableKind kind,
                   const std::vector<std::string>& axes, program::Tables& tables,
                   std::vector<text::Finding>& findings) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  TableBuilder b(file, kind, axes, findings);
  if (names_linuxcnc(file))
    read_linuxcnc(text, b);
  else
    read_csv(text, b);
  if (!b.good()) return false;
  for (auto& [n, row] : b.tables.origins) tables.origins[n] = std::move(row);
  for (auto& [n, row] : b.tables.correctors) tables.correctors[n] = std::move(row);
  return true;
}

}  // namespace servogate::machine
