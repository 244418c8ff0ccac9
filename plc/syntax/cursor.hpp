// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "plc/syntax/lexer.hpp"
#include "plc/syntax/parser.hpp"

namespace servogate::plc::syntax {

/// Thrown inside the parser after a finding was reported; caught where reading can go on.
struct SyntaxError {};

/// Reads the tokens of one file in order. The parser is this class with its parts: declarations, statements,
/// expressions, and what is not supported, one file each.
class Parser {
 public:
  Parser(std::string_view text, const Location& begin, Source& source, Report& report)
      : text_(text), list_(tokens(text, begin, report)), source_(source), report_(report) {}

  void file();
  ExpressionPtr expression();
  ExpressionPtr initializer();
  ExpressionPtr whole(ExpressionPtr e);
  StatementPtr whole_statement();
  Block whole_body(bool instructions, const std::vector<Variable>& variables);
  /// The text is a piece of something else: it ends, but no file does.
  void piece() { piece_ = true; }
  bool at_end() const { return list_[at_].kind == TokenKind::end; }

 private:
  // Tokens.
  const Token& now() const { return list_[at_]; }
  const Token& ahead(std::size_t n = 1) const { return list_[std::min(at_ + n, list_.size() - 1)]; }
  const Token& take() { return at_ + 1 < list_.size() ? list_[at_++] : list_[at_]; }
  bool at(std::string_view key) const { return now().is(key); }
  bool at_any(std::initializer_list<std::string_view> keys) const;
  bool accept(std::string_view key);
  void expect(std::string_view key);
  void expect_closing(std::string_view key, std::string_view opener, const Location& begin);
  std::string identifier(std::string what);
  [[noreturn]] void fail(std::string wanted);
  std::string found() const;
  void recover(std::initializer_list<std::string_view> stops);

  // Declarations.
  void declaration();
  void unit(UnitKind kind);
  void variables(std::vector<Variable>& out, Section section, bool in_unit);
  void variable_list(std::vector<Variable>& out, const Variable& prototype);
  bool nameless_place() const;
  void address(Variable& v);
  TypeReference type_reference();
  void array_type(TypeReference& t);
  void structure_type(TypeReference& t);
  void enumeration_type(TypeReference& t);
  void types();
  void configuration();
  void configuration_part(Configuration& c, int& resources, Location& resource);
  void task(Configuration& c);
  void program_instance(Configuration& c);
  void program_elements(ProgramInstance& p);
  void path_part(std::vector<std::string>& out);
  void paths(Configuration& c, bool access);
  ExpressionPtr list_initializer();
  ExpressionPtr record_initializer();
  bool at_record() const;

  // Statements.
  Block block(std::initializer_list<std::string_view> ends);
  void tell_foreign_elsif();
  bool too_deep();
  StatementPtr statement();
  StatementPtr simple_statement();
  [[noreturn]] void foreign_assignment(const Expression& target);
  ExpressionPtr header(std::string_view closer);
  StatementPtr if_statement();
  StatementPtr case_statement();
  StatementPtr for_statement();
  StatementPtr while_statement();
  StatementPtr repeat_statement();
  std::vector<Label> labels();
  bool at_label() const;

  // What is not supported: told once, then read over.
  void refuse(const Token& t);
  bool skip_unsupported();
  void skip_specifiers();
  void skip_ancestry();
  void path_words();
  bool refuse_reserved();

  // Instruction List.
  friend class InstructionList;
  bool at_instruction_list() const;
  Block instruction_list(const std::vector<Variable>& variables);
  bool at_parameter_list() const;
  ExpressionPtr parameter_list();

  // Expressions.
  ExpressionPtr binary(int level);
  void foreign_word(std::string_view own);
  ExpressionPtr unary();
  ExpressionPtr primary();
  ExpressionPtr postfix(ExpressionPtr e);
  ExpressionPtr typed();
  void arguments(Expression& call);
  void argument(Expression& call);
  static ExpressionPtr make(ExpressionKind kind, const Location& at);

  struct Nesting {
    Parser& p;
    explicit Nesting(Parser& parser);
    ~Nesting() { --p.depth_; }
  };

  std::string_view text_;
  std::vector<Token> list_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool piece_ = false;
  std::uint64_t holds_ = 0;
  class InstructionList* list_body_ = nullptr;  ///< the list being read
  std::set<std::string, std::less<>> refused_;  ///< words that were told to be not supported
  std::size_t unsupported_ = 0;                 ///< how many were
  Source& source_;
  Report& report_;
};

/// Words that cannot be names.
bool is_keyword(std::string_view key);

}  // namespace servogate::plc::syntax
