// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/reading/parameters.hpp"

#include <algorithm>
#include <cctype>

#include "bench/scenario/reading/findings.hpp"

namespace servogate::scenario {

using machine::Element;

namespace {

/// Length of the name at the front of `text`.
std::size_t name_length(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && (std::isalnum(static_cast<unsigned char>(text[n])) != 0 || text[n] == '_')) ++n;
  return n;
}

const Element* find(const Parameters& parameters, std::string_view name) {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.first == name; });
  return found == parameters.end() ? nullptr : &found->second;
}

std::string names_of(const Parameters& parameters) {
  std::string names;
  for (const auto& [name, value] : parameters) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? text::both("none", "ни одного") : names;
}

}  // namespace

std::string words_of(const Element& value) {
  switch (value.kind) {
    case Element::Kind::boolean:
      return value.boolean ? "true" : "false";
    case Element::Kind::integer:
      return std::to_string(value.integer);
    case Element::Kind::real:
      return text::number(value.real, 6);
    case Element::Kind::table:
    case Element::Kind::array: {
      std::string words;
      for (const Element& child : value.children)
        words += (words.empty() ? "" : " ") + (child.key.empty() ? "" : child.key + "=") + words_of(child);
      return words;
    }
    default:
      return value.string;
  }
}

void substitute(Element& element, const Parameters& parameters, machine::Reading& reading) {
  for (Element& child : element.children) substitute(child, parameters, reading);
  if (element.kind != Element::Kind::string || element.string.find('$') == std::string::npos) return;
  std::string out;
  const std::string& text = element.string;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] != '$') {
      out += text[i++];
      continue;
    }
    if (text.substr(i, 2) == "$$") {
      out += '$';
      i += 2;
      continue;
    }
    const std::size_t length = name_length(std::string_view(text).substr(i + 1));
    const std::string name = text.substr(i + 1, length);
    const Element* const value = find(parameters, name);
    if (value == nullptr) {
      reading.error(element.at, finding::kNoParameter, {name, names_of(parameters)});
      return;
    }
    if (i == 0 && length + 1 == text.size()) {
      Element whole = *value;
      whole.key = element.key;
      whole.at = element.at;
      whole.key_at = element.key_at;
      element = std::move(whole);
      return;
    }
    out += words_of(*value);
    i += 1 + length;
  }
  element.string = std::move(out);
}

}  // namespace servogate::scenario
