// SPDX-License-Identifier: Apache-2.0
// The same random logic written in Structured Text, Instruction List and as a drawn ladder must give the
// same.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <random>

#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"

namespace servogate::plc {
namespace {

constexpr int kInputs = 5, kResults = 12, kScans = 12;

struct Tree;
using TreePtr = std::unique_ptr<Tree>;

/// An operation; leaves carry their text. `boolean`: the type of the result.
struct Tree {
  std::string leaf, st, il;
  bool boolean = true;
  TreePtr a, b;
};

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}
  int pick(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }

  TreePtr leaf(bool boolean) {
    auto t = std::make_unique<Tree>();
    t->boolean = boolean;
    t->leaf = (boolean ? "b" : "n") + std::to_string(pick(kInputs));
    if (pick(6) == 0)
      t->leaf = boolean ? (pick(2) == 0 ? "TRUE" : "FALSE") : std::to_string(pick(2000) - 1000);
    return t;
  }
  TreePtr tree(bool boolean, int depth) {
    if (depth <= 0 || pick(5) == 0) return leaf(boolean);
    auto t = std::make_unique<Tree>();
    t->boolean = boolean;
    struct Operation {
      const char *st, *il;
    };
    constexpr Operation logical[] = {{"AND", "AND"}, {"OR", "OR"}, {"XOR", "XOR"}};
    constexpr Operation comparing[] = {{"<", "LT"},  {">", "GT"}, {"<=", "LE"},
                                       {">=", "GE"}, {"=", "EQ"}, {"<>", "NE"}};
    constexpr Operation numeric[] = {{"+", "ADD"}, {"-", "SUB"}, {"*", "MUL"}, {"MOD", "MOD"}};
    const bool compares = boolean && pick(4) == 0;
    if (boolean && !compares && pick(5) == 0) {
      t->st = t->il = "NOT";
      t->a = tree(true, depth - 1);
      return t;
    }
    const Operation& o = compares ? comparing[pick(6)] : boolean ? logical[pick(3)] : numeric[pick(4)];
    t->st = o.st;
    t->il = o.il;
    t->a = tree(boolean && !compares, depth - 1);
    t->b = tree(boolean && !compares, depth - 1);
    return t;
  }

 private:
  std::mt19937_64 random_;
};

std::string in_st(const Tree& t) {
  if (!t.leaf.empty()) return t.leaf;
  if (!t.b) return "NOT (" + in_st(*t.a) + ")";
  return "(" + in_st(*t.a) + " " + t.st + " " + in_st(*t.b) + ")";
}

/// Leaves the value of the tree as the current result. `maker` chooses among the ways to write the same.
void in_il(const Tree& t, Maker& maker, std::string& out) {
  if (!t.leaf.empty()) {
    out += "LD " + t.leaf + "\n";
    return;
  }
  if (!t.b && !t.a->leaf.empty() && maker.pick(2) == 0) {
    out += "LDN " + t.a->leaf + "\n";
    return;
  }
  in_il(*t.a, maker, out);
  if (!t.b) {
    out += "NOT\n";
    return;
  }
  const Tree* right = t.b.get();
  const bool logical = t.il == "AND" || t.il == "OR" || t.il == "XOR";
  const bool inverted = logical && right->st == "NOT" && maker.pick(2) == 0;
  if (inverted) right = right->a.get();
  out += t.il + (inverted ? "N" : "");
  if (!right->leaf.empty() && maker.pick(4) != 0) {
    out += " " + right->leaf + "\n";
    return;
  }
  out += "(\n";
  in_il(*right, maker, out);
  out += ")\n";
}

std::string declarations() {
  std::string out = "VAR_GLOBAL\n";
  for (int i = 0; i < kInputs; ++i)
    out += "b" + std::to_string(i) + " : BOOL; n" + std::to_string(i) + " : DINT;\n";
  for (const char* way : {"one", "two"})
    for (int i = 0; i < kResults; ++i) {
      out += std::string(way) + std::to_string(i) + " : BOOL; ";
      out += std::string(way) + "n" + std::to_string(i) + " : DINT;\n";
    }
  return out + "END_VAR\n";
}

/// Runs both programs of `source` on random inputs; the first difference, or empty.
std::string difference(const std::string& source, std::uint64_t seed) {
  Options options;
  options.warnings = false;
  const CompileResult r = compile({{"both.st", source}}, {}, options);
  if (!r.ok()) return r.findings.empty() ? "no image" : r.findings[0].str(text::Language::english);
  Engine engine(r.image);
  image::Packets packets;
  std::mt19937_64 random(seed);
  for (int scan = 0; scan < kScans; ++scan) {
    for (int i = 0; i < kInputs; ++i) {
      engine.write(packets, *engine.find("b" + std::to_string(i)), random() % 2 == 0 ? "TRUE" : "FALSE");
      engine.write(packets, *engine.find("n" + std::to_string(i)),
                   std::to_string(static_cast<std::int32_t>(random() % 7 == 0 ? random() : random() % 100)));
    }
    if (engine.scan(packets, scan * image::kMillisecond).fault != Fault::none) return "fault";
    for (int i = 0; i < kResults; ++i)
      for (const char* kind : {"", "n"}) {
        const std::string tail = kind + std::to_string(i);
        const std::string one = engine.read(*engine.find("one" + tail));
        const std::string two = engine.read(*engine.find("two" + tail));
        if (one != two)
          return "result " + tail + ": " + one + " and " + two + " in scan " + std::to_string(scan);
      }
  }
  return {};
}

std::uint64_t first_seed() {
  const char* given = std::getenv("SERVOGATE_SEED");
  return given != nullptr ? std::strtoull(given, nullptr, 10) : 20'260'301;
}

TEST(Languages, instruction_list_gives_what_structured_text_gives) {
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 60; ++seed) {
    Maker maker(seed);
    std::string st = "PROGRAM One\n", il = "PROGRAM Two\nLD 0\n";
    for (int i = 0; i < kResults; ++i) {
      const bool boolean = maker.pick(2) == 0;
      const std::string name = (boolean ? "" : "n") + std::to_string(i);
      const TreePtr t = maker.tree(boolean, 5), other = maker.tree(boolean, 3), when = maker.tree(true, 3);
      const std::string assign = " := " + in_st(*t) + ";\n";
      switch (maker.pick(boolean ? 5 : 3)) {
        case 0: {  // IF and a jump, the current result carried to the label
          const std::string label = "l" + std::to_string(i);
          st += "IF " + in_st(*when) + " THEN one" + name + " := " + in_st(*other) + "; ELSE one" + name +
                assign + "END_IF;\n";
          in_il(*when, maker, il);
          il += "JMPC yes" + label + "\n";
          in_il(*t, maker, il);
          il += "JMP end" + label + "\nyes" + label + ":\n";
          in_il(*other, maker, il);
          il += "end" + label + ":\nST two" + name + "\n";
          break;
        }
        case 3:
          st += "IF " + in_st(*t) + " THEN one" + name + " := TRUE; END_IF;\n";
          in_il(*t, maker, il);
          il += "S two" + name + "\n";
          break;
        case 4:
          st += "one" + name + " := NOT " + in_st(*t) + ";\n";
          in_il(*t, maker, il);
          il += "STN two" + name + "\n";
          break;
        default:
          st += "one" + name + assign;
          in_il(*t, maker, il);
          il += "ST two" + name + "\n";
      }
    }
    const std::string source = declarations() + st + "END_PROGRAM\n" + il + "END_PROGRAM\n";
    ASSERT_EQ(difference(source, seed), "") << "seed " << seed << "\n" << source;
  }
}

/// A part of a rung: power enters and leaves in the first row.
using Drawing = std::vector<std::string>;

Drawing beside(const Drawing& a, const Drawing& b) {
  Drawing out(std::max(a.size(), b.size()));
  for (std::size_t r = 0; r < out.size(); ++r)
    out[r] = (r < a.size() ? a[r] : std::string(a[0].size(), ' ')) +
             (r < b.size() ? b[r] : std::string(b[0].size(), ' '));
  return out;
}
Drawing above(Drawing a, Drawing b) {
  const std::size_t width = std::max(a[0].size(), b[0].size());
  for (Drawing* d : {&a, &b})
    for (std::size_t r = 0; r < d->size(); ++r) (*d)[r].resize(width, r == 0 ? '-' : ' ');
  Drawing out;
  for (std::size_t r = 0; r < a.size(); ++r) out.push_back(r == 0 ? "+-" + a[r] + "-+" : "| " + a[r] + " |");
  out.push_back("| " + std::string(width, ' ') + " |");  // '+' above '+' would be one wire
  for (std::size_t r = 0; r < b.size(); ++r) out.push_back(r == 0 ? "+-" + b[r] + "-+" : "  " + b[r] + "  ");
  return out;
}

Drawing ladder(Maker& maker, int depth, std::string& st) {
  if (depth <= 0 || maker.pick(4) == 0) {
    const std::string number = std::to_string(maker.pick(kInputs));
    switch (maker.pick(7)) {
      case 0:
        st = "NOT b" + number;
        return {"--|/b" + number + "|-"};
      case 1:
        st = "p" + number + ".Q";
        return {"--|P b" + number + " |-"};
      case 2:
        st = "f" + number;
        return {"-| N b" + number + "|-"};
      case 3:
        st = "(n" + number + " > 50)";
        return {"--| n" + number + " > 50 |--"};
      default:
        st = "b" + number;
        return {"--| b" + number + " |--"};
    }
  }
  std::string a, b;
  const Drawing x = ladder(maker, depth - 1, a), y = ladder(maker, depth - 1, b);
  const bool parallel = maker.pick(2) == 0;
  st = "(" + a + (parallel ? " OR " : " AND ") + b + ")";
  return parallel ? above(x, y) : beside(x, y);
}

TEST(Languages, a_drawn_ladder_gives_what_structured_text_gives) {
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 60; ++seed) {
    Maker maker(seed);
    std::string st = "PROGRAM One\nVAR ", drawn = "PROGRAM Two\nLADDER\n";
    for (int i = 0; i < kInputs; ++i)
      st += "p" + std::to_string(i) + " : R_TRIG; f" + std::to_string(i) + ", m" + std::to_string(i) +
            " : BOOL; ";
    st += "END_VAR\n";
    for (int i = 0; i < kInputs; ++i)
      st += "p" + std::to_string(i) + "(CLK := b" + std::to_string(i) + "); f" + std::to_string(i) + " := m" +
            std::to_string(i) + " AND NOT b" + std::to_string(i) + "; m" + std::to_string(i) + " := b" +
            std::to_string(i) + ";\n";
    for (int i = 0; i < kResults; ++i) {
      std::string logic;
      Drawing d = ladder(maker, 5, logic);
      const std::string name = std::to_string(i);
      drawn += "RUNG\n";
      const int coil = maker.pick(4);
      for (std::size_t r = 0; r < d.size(); ++r)
        drawn += std::string(r == 0 ? "|-" : "| ") + d[r] +
                 (r > 0       ? ""
                  : coil == 0 ? "--(S two" + name + ")--|"
                  : coil == 1 ? "-(/two" + name + ")-|"
                              : "-( two" + name + " )|") +
                 "\n";
      st += coil == 0   ? "IF " + logic + " THEN one" + name + " := TRUE; END_IF;\n"
            : coil == 1 ? "one" + name + " := NOT " + logic + ";\n"
                        : "one" + name + " := " + logic + ";\n";
    }
    const std::string source = declarations() + st + "END_PROGRAM\n" + drawn + "END_LADDER\nEND_PROGRAM\n";
    ASSERT_EQ(difference(source, seed), "") << "seed " << seed << "\n" << source;
  }
}

}  // namespace
}  // namespace servogate::plc
