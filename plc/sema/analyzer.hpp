// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "plc/ir/ir.hpp"
#include "plc/syntax/report.hpp"
#include "plc/terms/options.hpp"

namespace servogate::plc::sema {

using ir::Constant;
using ir::Expr;
using ir::ExprPtr;
using ir::Native;
using ir::Op;
using syntax::Expression;
using syntax::Location;

/// A declared variable.
struct Variable {
  std::string name;
  Location at;
  syntax::Section section = syntax::Section::local;
  const Type* type = nullptr;
  ir::Root root = ir::Root::instance;
  std::uint32_t cell = 0;
  bool constant = false;
  bool retain = false;
  std::optional<Constant> value;  ///< of an elementary constant
  std::vector<std::uint8_t> initial;
  bool used = false;
  bool written = false;
  int edge = 0;  ///< R_EDGE 1, F_EDGE -1
  /// Bound to the caller's variable instead of copied.
  bool bound() const {
    return section == syntax::Section::in_out ||
           (section == syntax::Section::input && root == ir::Root::reference);
  }
  std::string resource;   ///< of a global variable, empty: of none
  std::string area;       ///< "%Q*": VAR_CONFIG gives each instance its location
  std::set<int> writers;  ///< units that assign it
};

struct UnitScope {
  const syntax::Unit* source = nullptr;
  std::vector<Variable> variables;  ///< in order of declaration
  std::map<std::string, std::size_t> by_name;
  Type* frame = nullptr;
  const Type* result = nullptr;
  int result_variable = -1;
  std::set<int> calls;
  int depth_state = 0;  ///< of the search for recursion
  bool ready = false;   ///< frame laid out
  bool laying_out = false;
  bool from_library = false;
  std::string resource;  ///< whose global variables it sees where several have one of a name
};

/// Bytes that one variable may take; all of a program together four times as much.
inline constexpr std::uint32_t kMaxBytes = 16u << 20;

constexpr std::uint32_t aligned(std::uint32_t at, std::uint32_t to) noexcept {
  return (at + to - 1) / to * to;
}

/// Turns the trees of all files into the typed representation and reports everything that does not hold. One
/// object, one compilation; its parts are the .cpp files of this folder.
class Analyzer {
 public:
  Analyzer(const syntax::Source& source, const std::vector<image::Symbol>& symbols, const Options& options,
           int library_file, syntax::Report& report);

  /// The program; complete only when the report has no error.
  ir::Program run();

 private:
  friend class Scope;

  // declarations.cpp: names, frames, globals.
  void declare_names();
  std::string seen_at(const Location& there, const Location& here) const;
  void lay_out(int unit);
  void declare_variable(UnitScope& u, const syntax::Variable& v);
  void declare_edge(UnitScope& u, const syntax::Variable& v);
  void declare_globals(bool constants);
  void declare_located(Variable& out, const syntax::Variable& v, bool configured = false);
  void warn_overlaps(const std::string& address, const image::Place& place, const Location& at,
                     bool direct = false);
  void check_sections(const UnitScope& u, const syntax::Variable& v);
  std::uint32_t allocate(const Type& type);

  // written_types.cpp: types as they are written, and their layout.
  void resolve_types();
  const Type* resolve_declared(std::size_t index);
  const Type* resolve(const syntax::TypeReference& t, const std::string& name = {});
  const Type* resolve_written(const syntax::TypeReference& t, const std::string& name);
  const Type* resolve_named(const syntax::TypeReference& t);
  const Type* resolve_array(const syntax::TypeReference& t);
  const Type* resolve_open_array(const syntax::TypeReference& t, const Type* element, bool allowed);
  struct MemberBits {
    std::int64_t low, high;
    const syntax::Variable* member;
  };
  void check_member_place(const syntax::Variable& m, const Type& type, std::vector<MemberBits>& taken);
  const Type* resolve_structure(const syntax::TypeReference& t, const std::string& name);
  const Type* resolve_reference(const syntax::TypeReference& t);
  const Type* resolve_enumeration(const syntax::TypeReference& t, const std::string& name);
  const Type* resolve_subrange(const syntax::TypeReference& t, const Type* base, const std::string& name);
  std::uint32_t append(Type& owner, Field field, const Location& at);
  void place_initial(std::vector<std::uint8_t>& image, std::uint32_t offset, const Type& type,
                     const std::vector<std::uint8_t>& bytes);
  const Type* limits_type();

  // resources.cpp: global variables of one name in several resources.
  void part_resources();
  std::vector<std::set<std::string>> all_mentions() const;
  int copy_unit(std::size_t unit);
  void refuse_shared_types();
  std::string resource_here() const;
  std::string global_key(std::string_view name) const;
  int unit_named(std::string_view name) const;

  // places.cpp: packet places.
  std::optional<image::Place> parse_address(const std::string& text, const Location& at);
  std::uint32_t shared(const std::string& name, const image::Place& place, const Type* type,
                       const Location& at);
  const Type* type_of(const image::Place& place);
  const image::Symbol* symbol(std::string_view name) const;
  bool axis_of_programs(const Expression& e, const Type& wanted);
  std::optional<ir::Place> axis_reference(const std::string& name, const Location& at);
  void check_place_writer(std::uint32_t place, const Location& at, const std::string& shown);
  void lay_out_places();

  // constants.cpp: folding, initial values.
  /// `hint`: the type whose named values are meant, when it is not `type` itself.
  std::optional<Constant> constant(const Expression& e, const Type* type, const Type* hint = nullptr);
  std::optional<std::int64_t> constant_integer(const Expression& e);
  std::vector<std::uint8_t> initial_bytes(const Expression& e, const Type& type);
  void initial_list(const Expression& e, const Type& type, std::vector<std::uint8_t>& out);
  void initial_record(const Expression& e, const Type& type, std::vector<std::uint8_t>& out);
  ExprPtr fold(ExprPtr e);
  ExprPtr fold_function(ExprPtr e);
  ExprPtr fold_conversion(ExprPtr e);
  ExprPtr make_constant(const Type* type, Constant c, const Location& at);
  ExprPtr truth(const Location& at);  ///< the constant TRUE

  // names.cpp: from a name to a place.
  Variable* find_variable(std::string_view name, bool& global);
  bool dotted_symbol(const Expression& e, std::string& name) const;
  bool leads_global(const Expression& e);
  std::optional<ir::Place> place(const Expression& e, bool write);
  std::optional<ir::Place> place_of_name(const Expression& e, bool write);
  std::optional<ir::Place> place_of_member(const Expression& e, bool write);
  std::optional<ir::Place> place_of_index(const Expression& e, bool write);
  std::optional<ir::Place> place_of_bit(const Expression& e, bool write);
  bool changeable(const Expression& instance);
  ir::Place limits_of(const ir::Place& array);
  ir::Step open_step(const ir::Place& array, ExprPtr index);
  std::optional<ir::Place> character_of(ir::Place base, const Expression& subscript);
  std::optional<ir::Place> place_of_symbol(const std::string& name, const Location& at, bool write);
  void note_write(Variable& v, bool global, const Location& at);
  std::vector<std::string> names_in_scope();
  ExprPtr enumeration_value(std::string_view name, const Location& at, const Type* hint);

  // expressions.cpp
  ExprPtr expression(const Expression& e, const Type* hint = nullptr);
  ExprPtr literal(const Expression& e, const Type* hint);
  ExprPtr typed_literal(const Expression& e);
  ExprPtr name_expression(const Expression& e, const Type* hint);
  ExprPtr unary(const Expression& e, const Type* hint);
  ExprPtr unary(syntax::Operator op, ExprPtr a, const Expression& e, const Type* hint);
  ExprPtr binary(const Expression& e, const Type* hint);
  ExprPtr combine(Op op, ExprPtr a, ExprPtr b, const Location& at, std::string_view shown);
  ExprPtr combine_times(Op op, ExprPtr& a, ExprPtr& b, const Location& at);
  ExprPtr power(ExprPtr a, ExprPtr b, const Location& at);
  ExprPtr convert(ExprPtr e, const Type* to);
  ExprPtr scaled_time(ExprPtr e, const Type* to, const Location& at);
  ExprPtr recoded(ExprPtr e, const Type* to, const Location& at);
  bool conversion_name(std::string_view key) const;
  const Type* converted_type(std::string_view name);
  ExprPtr to_enumeration(ExprPtr e, const Type* to, const Location& at);
  ExprPtr explicit_conversion(ExprPtr e, const Type* to, bool truncate, const Location& at);
  /// For an assignment: reports what does not fit, warns of narrowing.
  ExprPtr assignable(ExprPtr e, const Type* to);
  ExprPtr settle(ExprPtr e, const Type* hint);
  ExprPtr load(ir::Place p, const Location& at);
  ExprPtr bad(const Location& at);
  ExprPtr node(ir::ExprKind kind, const Type* type, const Location& at);
  ExprPtr native(Native n, const Type* type, const Location& at, std::vector<ExprPtr> args);

  // standard.cpp: functions of the standard.
  bool is_standard(std::string_view key) const;
  ExprPtr standard_call(const Expression& e, std::string_view key, const Type* hint);
  ExprPtr numeric_call(std::string_view key, const Expression& e, const Type* hint);
  ExprPtr selection_call(std::string_view key, const Expression& e, const Type* hint);
  ExprPtr operator_call(std::string_view key, const Expression& e, const Type* hint);
  ExprPtr shift_call(std::string_view key, const Expression& e, const Type* hint);
  ExprPtr text_call(std::string_view key, const Expression& e);
  ExprPtr time_call(std::string_view key, const Expression& e);
  ExprPtr order_call(std::string_view key, const Expression& e, const Type* hint, bool turns);
  ExprPtr bound_call(std::string_view key, const Expression& e);
  std::vector<const Expression*> numbered_inputs(const Expression& e, std::string_view name);
  ExprPtr conversion_call(std::string_view key, const Expression& e);
  /// The inputs of a standard function, converted to one common type (`fixed`, when given); empty: reported.
  std::vector<ExprPtr> common_inputs(const std::vector<const Expression*>& in, std::string_view name,
                                     const Type* hint, bool (*accepts)(Kind), const char* wanted);
  std::vector<ExprPtr> typed_inputs(const std::vector<const Expression*>& in,
                                    const std::vector<const Type*>& types);
  using Kept = std::vector<std::pair<std::int64_t, ExprPtr>>;  ///< number and value
  ExprPtr once(ExprPtr e, Kept& kept);
  ExprPtr around(ExprPtr e, Kept kept);
  ExprPtr chain(Op op, std::vector<ExprPtr> args, const Location& at, std::string_view shown);
  std::vector<const Expression*> inputs(const Expression& e, std::string_view name,
                                        std::initializer_list<const char*> names, std::size_t least,
                                        std::size_t most);

  // references.cpp: REF_TO, REF, ^, NULL, ?=.
  /// A reference that begins with REF(x): its cell and the variable, both in the frame or at fixed addresses.
  struct InitialReference {
    const Type* frame;  ///< null: `cell` is an address
    std::uint32_t cell;
    std::optional<ir::Place> target;  ///< nothing: NULL
  };
  ExprPtr reference_to(const Expression& e);
  bool lasts(const Expression& variable);
  std::optional<ir::Place> place_of_dereference(const Expression& e);
  ExprPtr attempted(ExprPtr value, const Type& to);
  /// Of a declared variable. `lasting`: references to others may be in it; keep_references() then says where
  /// the variable lies.
  std::vector<std::uint8_t> initial_bytes(const syntax::Variable& s, const Type& type, bool lasting);
  bool gather_reference(const Expression& e, const Type& type);
  void repeat_references(std::size_t from, std::int64_t times, std::uint32_t stride);
  void keep_references(const Type* frame, std::uint32_t cell);
  void check_references();
  const Type* gives_references(const Type& type, std::map<const Type*, const Type*>& known) const;
  void bind_references();
  void bind_references(const Type& type, std::uint32_t address);
  void bind_reference(const InitialReference& r, std::uint32_t base);

  // calls.cpp
  ExprPtr call(const Expression& e, const Type* hint, bool as_statement);
  ExprPtr enabled_call(const Expression& e, const Type* hint);
  ExprPtr function_call(const Expression& e, int unit);
  int function_named(const Expression& callee);
  ExprPtr initial_value(const Variable& v, int unit, const Location& at);
  void block_call(const Expression& e, const ir::Place& instance, int unit, ir::Block& out);
  bool drawn_as(const Expression& call, const Type& instance);
  void block_input(const syntax::Argument& a, const Variable& parameter, const ir::Place& instance,
                   ir::Block& out);
  const Variable* match(const syntax::Argument& a, std::size_t position, int unit, bool with_outputs = false);
  bool check_arguments(const Expression& e, int unit, std::vector<const Variable*>& matched);
  ir::Place actual_limits(const ir::Place& array);
  ir::Parameter limits_parameter(const Variable& parameter, const ir::Place& actual);
  std::optional<ir::Place> bound_argument(const syntax::Argument& a, const Variable& parameter);
  void output_argument(const syntax::Argument& a, const ir::Place& from, ir::Block& out);
  bool inverts(const syntax::Argument& a, const Type& output);
  bool guarded(const syntax::Statement& s, ir::Block& out);
  ExprPtr enabled_value(const Expression& e);

  // statements.cpp
  ir::Block block(const syntax::Block& b);
  void statement(const syntax::Statement& s, ir::Block& out);
  void assignment(const syntax::Statement& s, ir::Block& out);
  void assign(ir::Place target, ExprPtr value, const Location& at, ir::Block& out);
  void if_statement(const syntax::Statement& s, ir::Block& out);
  void case_statement(const syntax::Statement& s, ir::Block& out);
  struct Chosen {
    Constant low, high;
    Location at;
  };
  void warn_chosen_twice(const std::vector<Chosen>& seen, const Type& type);
  void case_label(const syntax::Label& l, const Type& type, std::vector<Chosen>& seen);
  void for_statement(const syntax::Statement& s, ir::Block& out);
  void loop_statement(const syntax::Statement& s, ir::Block& out);
  void hold(const syntax::Statement& s, ir::Block& out);
  bool drawn_call(const syntax::Statement& s, ir::Block& out);
  bool result_pin(int unit, const std::string& name) const;
  void set_statement(const syntax::Statement& s, ir::Block& out);
  std::int32_t label(const syntax::Statement& s);
  void collect_labels(const syntax::Block& b);
  ExprPtr condition(const Expression& e);
  void body(int unit);

  // tasks.cpp
  void default_task();
  void configured_tasks();
  void all_bound(int unit, const std::vector<const Variable*>& given, const Location& at);
  ir::Task task_of(const syntax::Task& t);
  bool program_call(const syntax::ProgramInstance& p, const std::string& name, ir::Block& out);
  int program_unit(const syntax::ProgramInstance& p);
  std::string program_name(const syntax::Configuration& c, const syntax::ProgramInstance& p);
  void block_task(const syntax::BlockTask& b, const ir::Global& program, ir::Block& out);
  void check_block_tasks();
  std::uint32_t instance(const std::string& name, int unit, bool retain);
  // locations.cpp: the paths of VAR_CONFIG and VAR_ACCESS, AT %Q*.
  struct Reached {
    std::uint32_t cell;
    const Type* type;
    const Type* owner;  ///< of a variable AT %Q*: the block or program; `cell` is its reference
    std::string name;   ///< without the resource
  };
  using Missing = std::map<const Variable*, std::vector<std::string>>;
  void configured_paths(const syntax::Configuration& c);
  std::optional<Reached> reach_path(const syntax::Configuration& c, const syntax::PathDeclaration& p);
  bool path_step(const syntax::PathDeclaration& p, std::size_t part, Reached& out);
  bool declare_unlocated(UnitScope& u, Variable& v, const syntax::Variable& s);
  bool lies_in(const std::string& area, const image::Place& place, const std::string& address) const;
  void locate(const syntax::PathDeclaration& p, const Reached& found);
  void find_missing(const std::string& name, const Type& type, std::uint32_t address, bool lasting,
                    Missing& out);
  void check_locations();
  void bind_locations();

  // tasks.cpp, of the whole program.
  void check_recursion();
  bool visit(int unit, std::vector<int>& path);
  void check_usage();
  void check_writers();
  void check_overlapping_writers();
  void reach(int unit, std::set<int>& out) const;

  UnitScope& here() { return scopes_[static_cast<std::size_t>(current_)]; }
  const Type* elementary(Kind k) const { return types_->elementary(k); }

  const syntax::Source& source_;
  const std::vector<image::Symbol>& symbols_;
  const Options& options_;
  int library_file_;
  syntax::Report& report_;
  ir::Program program_;
  TypeTable* types_;

  std::map<std::string, std::size_t> declared_types_;
  std::vector<const Type*> resolved_;
  std::vector<bool> resolving_;
  std::vector<UnitScope> scopes_;
  std::map<std::string, int> units_by_name_;
  std::vector<Variable> globals_;
  std::map<std::string, std::size_t> globals_by_name_;
  std::set<std::string> shared_names_;                      ///< of global variables, in several resources
  std::map<std::pair<int, std::string>, int> by_resource_;  ///< unit, resource -> the unit in it
  std::string resource_;                                    ///< of what is being looked at outside of units
  std::map<std::string, std::vector<const Type*>> enumerations_;  ///< value name -> types
  std::map<std::string, std::size_t> symbols_by_name_;
  std::map<std::string, std::uint32_t> shared_by_name_;
  struct Located {
    std::string name, text;
    image::Place place;
    Location at;
  };
  std::vector<Located> located_;
  struct Configured {
    const Variable* variable;
    int unit;            ///< that declares it
    std::int32_t place;  ///< index of places, -1: reported
    std::string name;
    Location at;
  };
  /// An instance of a function block by the unit that declares it and its cell there.
  using Instance = std::pair<int, std::uint32_t>;
  std::set<Instance> called_;
  std::vector<std::pair<Instance, const syntax::BlockTask*>> block_tasks_;
  std::map<std::uint32_t, Configured> locations_;  ///< by the cell of an AT %Q* in its instance
  std::vector<std::set<int>> place_writers_;
  std::set<std::string> direct_;              ///< addresses used without a declaration
  std::set<std::uint32_t> read_only_places_;  ///< declared AT %I
  std::set<std::string> unknown_;             ///< names reported in the current unit
  std::size_t names_offered_ = 0;             ///< to suggestion(), in the whole compilation
  std::vector<const Variable*> for_variables_;
  std::vector<int> instances_;  ///< programs: number of instances a unit has
  int current_ = -1;
  std::map<std::pair<const syntax::TypeReference*, std::string>, const Type*> nameless_;
  int loops_ = 0;
  std::int64_t lets_ = 0;
  std::map<std::uint64_t, ir::Place> held_;  ///< of the current body
  std::map<std::string, std::int32_t> labels_;
  std::map<const Type*, std::uint32_t> limits_;  ///< where the limits of an array lie that was bound
  std::map<std::pair<int, std::uint32_t>, std::uint32_t> initial_values_;  ///< of inputs: unit, cell -> where
  const Type* limits_type_ = nullptr;
  std::map<std::string, const Type*> open_types_;  ///< structures whose members are being resolved
  std::vector<InitialReference> initial_references_;
  std::vector<InitialReference> gathered_;  ///< of the variable being declared, counted from it
  std::uint32_t gather_at_ = 0;             ///< where in it the value being read lies
  bool gathers_ = false;
  std::set<int> referenced_units_;       ///< REF is taken of variables of their instances, inside
  bool open_arrays_ = false;             ///< the type being resolved may be ARRAY[*]
  const Expression* guarded_ = nullptr;  ///< the call whose EN and ENO are being dealt with
  bool misplaced_ = false;               ///< a location of VAR_CONFIG went to nobody
  bool no_marks_ = false;                ///< reads do not count as use
};

/// The bytes of a constant as the machine holds them.
void store_constant(const Type& type, const Constant& c, std::uint8_t* out);
/// A named value as a constant of its type.
Constant named_constant(const Type& type, const EnumValue& value);
/// The reverse of store_constant, of an elementary type.
Constant stored_constant(const Type& type, const std::uint8_t* bytes);
std::string constant_text(const Type& type, const Constant& c);

}  // namespace servogate::plc::sema
