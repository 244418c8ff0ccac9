// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plc/syntax/cursor.hpp"
#include "plc/terms/texts.hpp"

/// What other systems have and this one has not is told as that, once, and read over, so that the rest of the
/// file is checked as if it were not there.
namespace servogate::plc::syntax {

namespace {

struct Construct {
  std::string_view key, closer;
};
// Object orientation, namespaces and Sequential Function Chart of IEC 61131-3, and GOTO, which nobody has.
constexpr Construct kConstructs[] = {
    {"METHOD", "END_METHOD"},
    {"PROPERTY", "END_PROPERTY"},
    {"ACTION", "END_ACTION"},
    {"CLASS", "END_CLASS"},
    {"INTERFACE", "END_INTERFACE"},
    {"INITIAL_STEP", "END_STEP"},
    {"STEP", "END_STEP"},
    {"TRANSITION", "END_TRANSITION"},
    {"USING", ";"},
    {"GOTO", ";"},
    {"NAMESPACE", ""},
    {"END_NAMESPACE", ""},
};
constexpr std::string_view kSpecifiers[] = {"PUBLIC",   "PRIVATE", "PROTECTED", "INTERNAL",
                                            "ABSTRACT", "FINAL",   "OVERRIDE"};

}  // namespace

void Parser::refuse(const Token& t) {
  const std::string_view key = t.key == "END_NAMESPACE" ? "NAMESPACE" : std::string_view(t.key);
  if (!refused_.emplace(key).second) return;
  report_.error(t.location, texts::kUnsupported, {std::string(key)});
  ++unsupported_;
}

// Two words side by side begin no statement, so that variables may have these names.
bool Parser::skip_unsupported() {
  if (now().kind != TokenKind::word) return false;
  const auto c = std::find_if(std::begin(kConstructs), std::end(kConstructs),
                              [&](auto& k) { return k.key == now().key; });
  const bool closes = now().key == "END_NAMESPACE";
  if (c == std::end(kConstructs) || (!closes && ahead().kind != TokenKind::word)) return false;
  refuse(take());
  if (c->closer.empty()) {
    if (!closes) path_words();
    return true;
  }
  recover({c->closer, "END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK"});
  accept(c->closer);
  return true;
}

void Parser::skip_specifiers() {
  while (now().kind == TokenKind::word && ahead().kind == TokenKind::word &&
         std::find(std::begin(kSpecifiers), std::end(kSpecifiers), now().key) != std::end(kSpecifiers))
    refuse(take());
}

// EXTENDS a.b IMPLEMENTS c, d behind the name of a unit.
void Parser::skip_ancestry() {
  while (at_any({"EXTENDS", "IMPLEMENTS"}) && ahead().kind == TokenKind::word) {
    refuse(take());
    do path_words();
    while (accept(","));
  }
}

void Parser::path_words() {
  do
    if (now().kind == TokenKind::word && !is_keyword(now().key)) take();
  while (accept("."));
}

// A keyword where a name stands: `VAR if : INT;` and then `if := 1;`.
bool Parser::refuse_reserved() {
  if (now().kind != TokenKind::word || !is_keyword(now().key)) return false;
  if (refused_.insert(now().key).second) {
    report_.error(now().location, texts::kReservedWord, {now().text});
    ++unsupported_;
  }
  return true;
}

}  // namespace servogate::plc::syntax
