// SPDX-License-Identifier: Apache-2.0
#include "gateway/machine/keys/document.hpp"

#include <algorithm>

#include "firmware_if/text/finding.hpp"
#include "gateway/machine/keys/json.hpp"

// toml++ 3.3 asserts on what stands after `[` before it checks it and says so properly ("[=" in a header).
// Its assertions are switched off, and NDEBUG with them, which would make undefined behaviour of them.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#define TOML_EXCEPTIONS 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

namespace servogate::machine {

namespace {

Where where(const toml::source_position& p) { return {static_cast<int>(p.line), static_cast<int>(p.column)}; }

Element convert(const toml::node& node);

void convert_table(const toml::table& table, Element& out) {
  out.kind = Element::Kind::table;
  for (auto&& [key, value] : table) {
    Element child = convert(value);
    child.key = std::string(key.str());
    child.key_at = where(key.source().begin);
    out.children.push_back(std::move(child));
  }
  // The library sorts by name; people read by place.
  std::stable_sort(out.children.begin(), out.children.end(), [](const Element& a, const Element& b) {
    return std::pair(a.key_at.line, a.key_at.column) < std::pair(b.key_at.line, b.key_at.column);
  });
}

Element convert(const toml::node& node) {
  Element out;
  out.at = out.key_at = where(node.source().begin);
  if (const auto* table = node.as_table()) {
    convert_table(*table, out);
  } else if (const auto* array = node.as_array()) {
    out.kind = Element::Kind::array;
    for (const toml::node& element : *array) out.children.push_back(convert(element));
  } else if (const auto* text = node.as_string()) {
    out.kind = Element::Kind::string;
    out.string = text->get();
  } else if (const auto* integer = node.as_integer()) {
    out.kind = Element::Kind::integer;
    out.integer = integer->get();
  } else if (const auto* real = node.as_floating_point()) {
    out.kind = Element::Kind::real;
    out.real = real->get();
  } else if (const auto* boolean = node.as_boolean()) {
    out.kind = Element::Kind::boolean;
    out.boolean = boolean->get();
  } else {
    out.kind = Element::Kind::date;
  }
  return out;
}

/// Marks which bytes of a TOML text stand inside a string or a comment, as far as the text is well-formed.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ >= text_.size(); }
  std::size_t position() const { return at_; }
  /// Passes a string or comment that begins here, otherwise one byte; true: the byte stood outside both.
  bool next() {
    const char c = text_[at_];
    if (c == '#' && !broken_) {
      at_ = std::min(text_.find('\n', at_), text_.size());
      return false;
    }
    if ((c == '"' || c == '\'') && can_begin_string()) {
      pass_string(c);
      return false;
    }
    ++at_;
    return true;
  }

 private:
  /// A quote after anything else is an error for sure: from there on nothing counts as a string.
  bool can_begin_string() {
    if (at_ > 0 && std::string_view(" \t\r\n=[{,.").find(text_[at_ - 1]) == std::string_view::npos)
      broken_ = true;
    return !broken_;
  }

  void pass_string(char quote) {
    const bool block = text_.substr(at_, 3) == std::string(3, quote);
    at_ += block ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      if (!block && text_[at_] == '\n') return;
      if (quote == '"' && text_[at_] == '\\') {
        ++at_;
      } else if (text_[at_] == quote && !block) {
        ++at_;
        return;
      } else if (block && text_.substr(at_, 3) == std::string(3, quote)) {
        at_ += 3;  // up to two quotes more belong to the string
        for (int more = 0; more < 2 && at_ < text_.size() && text_[at_] == quote; ++more) ++at_;
        return;
      }
    }
    at_ = text_.size();
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool broken_ = false;
};

/// toml++ 3.3 has undefined behaviour on many characters beyond ASCII where a key or value is expected (its
/// search tables end in "unreachable"). They are never right there: each becomes one '?', which it refuses,
/// at the same column.
std::string ascii_outside_strings(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  const std::size_t from =
      text.starts_with("\xEF\xBB\xBF") ? 3 : 0;  // the byte order mark may stand at the front
  out.append(text.substr(0, from));
  Scanner rest(text.substr(from));
  while (!rest.at_end()) {
    const std::size_t begin = from + rest.position();
    const bool outside = rest.next();
    const std::string_view part = text.substr(begin, from + rest.position() - begin);
    if (!outside || static_cast<unsigned char>(part[0]) < 0x80) {
      out.append(part);
    } else if (const std::size_t size = utf8_sequence(text.substr(begin)); size > 1) {
      out += '?';
      for (std::size_t i = 1; i < size; ++i) rest.next();
    } else {
      out.append(part);  // no UTF-8: the reader says so
    }
  }
  return out;
}

/// The character at a line and column (code points), empty when there is none.
std::string character_at(std::string_view text, Where at) {
  for (int line = 1; line < at.line; ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  if (at.line == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (int column = 1; !text.empty(); ++column) {
    const std::size_t size = std::max<std::size_t>(1, utf8_sequence(text));
    if (column == at.column) return std::string(text.substr(0, size));
    text.remove_prefix(size);
  }
  return {};
}

}  // namespace

const Element* Element::find(std::string_view name) const {
  for (const Element& child : children)
    if (child.key == name) return &child;
  return nullptr;
}

Document read_document(std::string_view source) {
  Document out;
  out.root.at = out.root.key_at = {1, 1};
  const std::string text = ascii_outside_strings(source);
  try {
    convert_table(toml::parse(text), out.root);
  } catch (const toml::parse_error& error) {
    out.root.children.clear();
    out.error = std::string(error.description());
    if (out.error.empty()) out.error.assign(1, '?');
    out.error_at = where(error.source().begin);
    const std::string character = character_at(source, out.error_at);
    if (character.size() > 1 && character_at(text, out.error_at) == "?")
      out.error = text::both("'" + character + "' can only stand inside quotes",
                             "«" + character + "» допустимо только в кавычках");
  }
  return out;
}

std::string quoted(std::string_view text) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (u < 0x20 || u == 0x7F) {
      out += "\\u00";
      out += kHex[u >> 4];
      out += kHex[u & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace servogate::machine
