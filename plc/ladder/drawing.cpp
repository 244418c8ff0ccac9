// SPDX-License-Identifier: Apache-2.0
// A ladder as people draw it with characters:
//   |--+--| start |--+--|/ stop |--( motor )--|
//   |  +--| motor |--+                        |
#include "plc/ladder/drawing.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include "plc/ladder/network.hpp"
#include "plc/syntax/parser.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::ladder {

namespace {

struct Row {
  int line = 0;
  std::string text;             ///< bytes
  std::vector<std::size_t> at;  ///< offset of each column in `text`, and its end
  std::size_t columns() const { return at.size() - 1; }
  char operator[](std::size_t column) const { return column < columns() ? text[at[column]] : ' '; }
  std::string between(std::size_t from, std::size_t to) const {
    return text.substr(at[from], at[to] - at[from]);
  }
};

bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string trimmed(std::string s) {
  while (!s.empty() && blank(s.back())) s.pop_back();
  std::size_t n = 0;
  while (n < s.size() && blank(s[n])) ++n;
  return s.substr(n);
}

struct PowerPins {
  std::string_view type, in, out;
};
// The input and output of a standard block that lie in the rung where none are named.
constexpr PowerPins kPower[] = {
    {"TON", "IN", "Q"},     {"TOF", "IN", "Q"},     {"TP", "IN", "Q"},  {"CTU", "CU", "Q"},
    {"CTD", "CD", "Q"},     {"CTUD", "CU", "QU"},   {"SR", "S1", "Q1"}, {"RS", "S", "Q1"},
    {"R_TRIG", "CLK", "Q"}, {"F_TRIG", "CLK", "Q"},
};

class Drawing {
 public:
  Drawing(syntax::Unit& unit, syntax::Report& report) : unit_(unit), report_(report) {}

  void run() {
    int line = unit_.ladder_location.line;
    std::vector<Row> rung;
    for (std::size_t begin = 0; begin < unit_.ladder.size();) {
      std::size_t end = unit_.ladder.find('\n', begin);
      if (end == std::string::npos) end = unit_.ladder.size();
      Row r = row(unit_.ladder.substr(begin, end - begin), line++);
      begin = end + 1;
      const std::string text = trimmed(r.text);
      if (text.empty()) continue;
      if (text[0] == '|') {
        rung.push_back(std::move(r));
        continue;
      }
      finish(rung);
      heading(r, text);
    }
    finish(rung);
    lower(std::move(elements_), unit_, report_);
  }

 private:
  Location where(const Row& r, std::size_t column) const {
    return {unit_.ladder_location.file, r.line, static_cast<int>(column) + 1};
  }

  // Comments become blanks; columns are characters, not bytes.
  Row row(const std::string& text, int line) {
    std::string shown;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (!comment_ && text.compare(i, 2, "//") == 0) break;
      if (!comment_ && text.compare(i, 2, "(*") == 0) {
        comment_ = true;
        shown += "  ";
        ++i;
      } else if (comment_ && text.compare(i, 2, "*)") == 0) {
        comment_ = false;
        shown += "  ";
        ++i;
      } else if (!comment_) {
        shown += text[i];
      } else if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) {
        shown += ' ';
      }
    }
    Row r;
    r.line = line;
    for (std::size_t i = 0; i < shown.size(); ++i)
      if ((static_cast<unsigned char>(shown[i]) & 0xC0) != 0x80) r.at.push_back(i);
    r.at.push_back(shown.size());
    r.text = std::move(shown);
    return r;
  }

  // RUNG, RUNG name (a label to jump to)
  void heading(const Row& r, const std::string& text) {
    const std::size_t column = r.text.find_first_not_of(" \t");
    const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
    if (!same_name(text.substr(0, end), "RUNG")) {
      report_.error(where(r, column), texts::kExpected,
                    {text::both("RUNG, '|' or END_LADDER", "RUNG, '|' или END_LADDER"),
                     "'" + text.substr(0, end) + "'"});
      return;
    }
    const std::string name = trimmed(text.substr(end));
    if (name.empty()) return;
    const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    });
    if (!plain) {
      report_.error(where(r, column + end + 1), texts::kExpected,
                    {text::both("the name of the rung", "имя цепи"), "'" + name + "'"});
      return;
    }
    Element e;
    e.kind = ElementKind::label;
    e.location = where(r, column);
    e.name = name;
    e.y = r.line;
    elements_.push_back(std::move(e));
  }

  // ---- one rung ----
  struct Cell {
    std::size_t row, column;
    bool operator<(const Cell& o) const { return std::tie(row, column) < std::tie(o.row, o.column); }
  };

  void finish(std::vector<Row>& rung) {
    if (rung.empty()) return;
    rows_ = std::move(rung);
    rung.clear();
    nodes_.clear();
    groups_.clear();
    ends_.clear();
    drawn_.clear();
    rail_ = rows_[0].text.find('|');
    for (std::size_t r = 0; r < rows_.size(); ++r) scan(r);
    join_upright();
    connect();
  }

  int node(std::size_t row, std::size_t column) {
    const auto [at, fresh] = nodes_.emplace(Cell{row, column}, static_cast<int>(groups_.size()));
    if (fresh) groups_.push_back(at->second);
    return at->second;
  }
  int root(int n) const {
    while (groups_[static_cast<std::size_t>(n)] != n) n = groups_[static_cast<std::size_t>(n)];
    return n;
  }
  void join(int a, int b) { groups_[static_cast<std::size_t>(root(a))] = root(b); }

  /// An element between two nodes.
  struct Drawn {
    int left, right;
    int element;
    std::string in, out;
  };

  void scan(std::size_t r) {
    const Row& row = rows_[r];
    int last = -1;  // the node that ends in the column before
    for (std::size_t c = 0; c < row.columns();) {
      const char x = row[c];
      const bool wired = last >= 0;
      const bool behind_wire = c > 0 && row[c - 1] == '-';
      const bool goes_on = x == '|' && wired && behind_wire && !rest_blank(row, c + 1);
      if (x == '-' || x == '+' || (x == '|' && !goes_on)) {
        const int n = node(r, c);
        // An upright meets what stands beside it only by '-'.
        if (wired && (x != '|' || behind_wire)) join(last, n);
        last = x == '|' && row[c + 1] != '-' ? -1 : n;
        ++c;
      } else if (goes_on || ((x == '(' || x == '[' || x == '>') && wired)) {
        c = element(r, c, last);
        last = c < row.columns() && (row[c] == '-' || row[c] == '+' || row[c] == '|') ? right_ : -1;
      } else if (blank(x)) {
        last = -1;
        ++c;
      } else {
        report_.error(where(row, c), texts::kLadderCharacter, {row.between(c, c + 1)});
        return;
      }
    }
  }
  static bool rest_blank(const Row& row, std::size_t c) {
    for (; c < row.columns(); ++c)
      if (!blank(row[c])) return false;
    return true;
  }

  // The column of the closing character, with brackets and strings inside skipped.
  std::size_t closing(const Row& row, std::size_t c, char with) const {
    int depth = 0;
    char quote = '\0';
    for (++c; c < row.columns(); ++c) {
      const char x = row[c];
      if (quote != '\0') {
        if (x == quote) quote = '\0';
      } else if (x == '\'' || x == '"') {
        quote = x;
      } else if (depth == 0 && x == with) {
        return c;
      } else if (x == '(' || x == '[') {
        ++depth;
      } else if (x == ')' || x == ']') {
        --depth;
      }
    }
    return 0;
  }

  // Reads the element at column c; the column behind it. Its right node is right_.
  std::size_t element(std::size_t r, std::size_t c, int left) {
    const Row& row = rows_[r];
    const char open = row[c];
    if (open == '>') return jump(r, c, left);
    const char close = open == '(' ? ')' : open == '[' ? ']' : '|';
    const std::size_t end = closing(row, c, close);
    if (end == 0) {
      report_.error(where(row, c), texts::kLadderOpen, {std::string(1, close)});
      return row.columns();
    }
    right_ = node(r, end);
    ends_[{r, end}] = true;
    Element e;
    e.location = where(row, c);
    e.x = static_cast<double>(c);
    e.y = row.line;
    e.inputs.emplace_back();
    drawn_.push_back({left, right_, static_cast<int>(elements_.size()), "", ""});
    std::size_t begin = c + 1;
    while (begin < end && blank(row[begin])) ++begin;
    if (begin == end) {
      report_.error(where(row, c), texts::kExpected,
                    {text::both("a name", "имя"), text::both("nothing", "ничего")});
      e.operand = syntax::parse_expression("FALSE", e.location, report_);
      e.kind = ElementKind::contact;
    } else if (open == '[') {
      box(row, begin, end, e);
    } else {
      begin = modifier(row, begin, end, e, open == '(');
      e.kind = open == '(' ? ElementKind::coil : ElementKind::contact;
      e.operand = syntax::parse_expression(row.between(begin, end), where(row, begin), report_);
    }
    elements_.push_back(std::move(e));
    return end + 1;
  }

  // '/', P, N, S, R before the operand, where an operand follows.
  std::size_t modifier(const Row& row, std::size_t begin, std::size_t end, Element& e, bool coil) const {
    std::size_t next = begin + 1;
    while (next < end && blank(row[next])) ++next;
    const char x = row[begin];
    if (x == '/') {
      e.inverted = true;
      return begin + 1;
    }
    if (next == begin + 1 || next >= end) return begin;
    const char key = static_cast<char>(std::toupper(static_cast<unsigned char>(x)));
    const char first = row[next];
    if (std::isalpha(static_cast<unsigned char>(first)) == 0 && first != '_' && first != '%') return begin;
    if (key == 'P' || key == 'N')
      e.edge = key == 'P' ? 1 : -1;
    else if (coil && (key == 'S' || key == 'R'))
      e.storage = key == 'S' ? Storage::set : Storage::reset;
    else
      return begin;
    return next;
  }

  static bool word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

  // [IN timer(PT := T#1s) Q], [F(a, b)], [x := a + b]
  void box(const Row& row, std::size_t begin, std::size_t end, Element& e) {
    std::string text = row.between(begin, end);
    std::size_t skipped = 0;
    const auto leading = [&]() -> std::string {  // a word followed by another word
      std::size_t n = 0;
      while (n < text.size() && word(text[n])) ++n;
      std::size_t next = n;
      while (next < text.size() && blank(text[next])) ++next;
      if (n == 0 || next == n || next >= text.size() || !word(text[next])) return {};
      std::string out = text.substr(0, n);
      skipped += next;
      text.erase(0, next);
      return out;
    };
    std::string in = leading();
    text = trimmed(text);
    std::string out;
    if (const std::size_t close = text.rfind(')'); close != std::string::npos) {
      std::string tail = trimmed(text.substr(close + 1));
      if (!tail.empty() && std::all_of(tail.begin(), tail.end(), word)) {
        out = tail;
        text.resize(close + 1);
      }
    }
    const Location at = where(row, begin + skipped);
    e.statement = syntax::parse_statement(text, at, report_);
    if (e.statement->kind == syntax::StatementKind::assign) {
      e.kind = ElementKind::action;
      if (!in.empty() || !out.empty())
        report_.error(e.location, texts::kExpected, {"[x := ...]", "'" + (in.empty() ? out : in) + "'"});
      return;
    }
    e.kind = ElementKind::block;
    syntax::Expression* call = e.statement->value.get();
    if (call == nullptr || call->kind != syntax::ExpressionKind::call) {
      e.kind = ElementKind::action;  // reported
      return;
    }
    call_box(*call, in, out, e);
  }

  void call_box(syntax::Expression& call, std::string in, std::string out, Element& e) {
    const std::string callee = dotted(*call.operands[0]);
    const syntax::Variable* v = nullptr;
    for (const syntax::Variable& known : unit_.variables)
      if (same_name(known.name, callee.substr(0, callee.find('.')))) v = &known;
    if (v != nullptr || !in.empty() || !out.empty()) {
      e.instance = callee;
    } else {
      e.name = callee;
    }
    if (v != nullptr && v->type)
      for (const PowerPins& p : kPower)
        if (same_name(p.type, v->type->name)) {
          if (in.empty()) in = p.in;
          if (out.empty()) out = p.out;
        }
    e.inputs[0].name = in.empty() ? "EN" : in;
    drawn_.back().out = out.empty() ? "ENO" : out;
    e.written = std::move(call.arguments);
    e.statement = nullptr;
  }
  static std::string dotted(const syntax::Expression& e) {
    return e.kind == syntax::ExpressionKind::member ? dotted(*e.operands[0]) + "." + e.name : e.name;
  }

  // >> name, >> RETURN
  std::size_t jump(std::size_t r, std::size_t c, int left) {
    const Row& row = rows_[r];
    std::size_t begin = c;
    while (begin < row.columns() && (row[begin] == '>' || blank(row[begin]))) ++begin;
    std::size_t end = begin;
    while (end < row.columns() && word(row[end])) ++end;
    Element e;
    e.location = where(row, c);
    e.x = static_cast<double>(c);
    e.y = row.line;
    e.inputs.emplace_back();
    e.name = row.between(begin, end);
    e.kind = same_name(e.name, "RETURN") ? ElementKind::leave : ElementKind::jump;
    if (e.name.empty())
      report_.error(e.location, texts::kExpected,
                    {text::both("a label", "метка"), text::both("nothing", "ничего")});
    while (end < row.columns() && (blank(row[end]) || row[end] == '-')) ++end;
    right_ = node(r, end);
    drawn_.push_back({left, right_, static_cast<int>(elements_.size()), "", ""});
    elements_.push_back(std::move(e));
    return end;
  }

  // '+' and '|' that stand above one another are one wire. An upright of an element is none.
  void join_upright() {
    for (const auto& [cell, n] : nodes_) {
      const char x = rows_[cell.row][cell.column];
      if (x != '+' && x != '|') continue;
      const auto below = nodes_.find({cell.row + 1, cell.column});
      if (below == nodes_.end()) continue;
      const char y = rows_[cell.row + 1][cell.column];
      const bool ends_element = ends_.contains(cell) || ends_.contains(below->first);
      if ((y == '+' || y == '|') && !ends_element) join(n, below->second);
    }
  }

  void connect() {
    Element rail;
    rail.location = where(rows_[0], rail_);
    const int rail_element = static_cast<int>(elements_.size());
    elements_.push_back(std::move(rail));
    std::vector<int> rails;
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if (const auto n = nodes_.find({r, rail_}); n != nodes_.end()) rails.push_back(root(n->second));
    for (const Drawn& d : drawn_) {
      Pin& pin = elements_[static_cast<std::size_t>(d.element)].inputs[0];
      if (std::find(rails.begin(), rails.end(), root(d.left)) != rails.end()) {
        pin.wires.push_back({rail_element, ""});
        continue;
      }
      for (const Drawn& from : drawn_)
        if (root(from.right) == root(d.left)) pin.wires.push_back({from.element, from.out});
    }
  }

  syntax::Unit& unit_;
  syntax::Report& report_;
  std::vector<Element> elements_;
  bool comment_ = false;
  std::vector<Row> rows_;
  std::size_t rail_ = 0;
  std::map<Cell, int> nodes_;
  std::map<Cell, bool> ends_;  ///< the right uprights of contacts
  std::vector<int> groups_;
  std::vector<Drawn> drawn_;
  int right_ = -1;
};

}  // namespace

void read_drawing(syntax::Unit& unit, syntax::Report& report) { Drawing(unit, report).run(); }

}  // namespace servogate::plc::ladder
