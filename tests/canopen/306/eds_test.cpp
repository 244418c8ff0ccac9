// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/306/eds.hpp"
#include "tests/places/places.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

namespace servogate::canopen {
namespace {

std::string file(const std::string& name) {
  std::ifstream in(tests::source_dir() + "/tests/canopen/306/data/" + name, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string story(const std::vector<text::Finding>& findings) {
  std::string all;
  for (const auto& f : findings) all += f.str(text::Language::english) + "\n";
  return all;
}

/// A sheet with one object [2000] that has these lines.
EdsResult with_object(const std::string& lines) {
  return read_eds("[2000]\nParameterName=X\nObjectType=7\n" + lines, "x.eds");
}
const EdsEntry& object_2000(const EdsResult& r) { return r.eds.objects.at(0x2000).entry; }
/// Ids of all warnings, with their lines.
std::string odd(const EdsResult& r) {
  std::string all;
  for (const auto& f : r.findings)
    all += (all.empty() ? "" : " ") + std::string(f.entry->id) + ":" + std::to_string(f.line);
  return all;
}

TEST(Eds, a_clean_file_is_read_without_a_word) {
  const auto r = read_eds(file("clean.eds"), "clean.eds");
  EXPECT_EQ(story(r.findings), "");
  ASSERT_TRUE(r.ok());
  EXPECT_EQ(r.eds.objects.size(), 9u);
  EXPECT_EQ(r.eds.device("vendornumber"), "0x11");
  EXPECT_EQ(r.eds.find(0x1000, 0)->default_value->number->value, 0x20192);
  EXPECT_EQ(r.eds.find(0x1018, 1)->name, "Vendor-ID");
  EXPECT_EQ(r.eds.find(0x1018, 2), nullptr);
  EXPECT_EQ(r.eds.find(0x1400, 1)->default_value->number->at(5), 0x205);
  EXPECT_EQ(r.eds.find(0x607A, 0)->low_limit->number->value, -2147483648LL) << "written by its bits";
  EXPECT_EQ(r.eds.find(0x2000, 0)->default_value->number->value, 0x3FC00000) << "REAL32 by its bits";
  EXPECT_EQ(r.eds.find(0x2001, 0)->default_value->text, "X");
}

TEST(Eds, compact_sub_objects_are_there_one_by_one) {
  const auto r = read_eds(file("clean.eds"), "clean.eds");
  const EdsObject& errors = r.eds.objects.at(0x1003);
  ASSERT_EQ(errors.subs.size(), 4u);
  EXPECT_EQ(errors.subs.at(0).default_value->number->value, 3);
  EXPECT_EQ(errors.subs.at(1).name, "Pre-defined error field1");
  EXPECT_EQ(errors.subs.at(2).name, "The error before");
  EXPECT_EQ(errors.subs.at(3).data_type, 7);
  EXPECT_EQ(errors.subs.at(3).access, EdsAccess::ro);
}

struct Number {
  const char* text;
  std::int64_t value;
  bool plus_node;
  NumberOddity oddity;
};
class EdsNumbers : public ::testing::TestWithParam<Number> {};

TEST_P(EdsNumbers, are_understood) {
  const auto p = parse_eds_number(GetParam().text);
  ASSERT_TRUE(p) << GetParam().text;
  EXPECT_EQ(p->number.value, GetParam().value) << GetParam().text;
  EXPECT_EQ(p->number.plus_node, GetParam().plus_node) << GetParam().text;
  EXPECT_EQ(p->oddity, GetParam().oddity) << GetParam().text;
}
using N = NumberOddity;
INSTANTIATE_TEST_SUITE_P(
    All, EdsNumbers,
    ::testing::Values(Number{"0", 0, false, N::none}, Number{"42", 42, false, N::none},
                      Number{"-5", -5, false, N::none}, Number{"0x1A00", 0x1A00, false, N::none},
                      Number{"0X1a00", 0x1A00, false, N::none}, Number{"0010", 10, false, N::leading_zeros},
                      Number{"08", 8, false, N::leading_zeros}, Number{"1A00h", 0x1A00, false, N::hex_suffix},
                      Number{"$NODEID", 0, true, N::none}, Number{"$NODEID+0x180", 0x180, true, N::none},
                      Number{"0x180+$NODEID", 0x180, true, N::none},
                      Number{" $NodeID + 0x40000180 ", 0x40000180, true, N::none},
                      Number{"$NODEID+0x80+0x100", 0x180, true, N::none},
                      Number{"NODEID+0x80", 0x80, true, N::node_id_sign},
                      Number{"TRUE", 1, false, N::boolean_word}, Number{"no", 0, false, N::boolean_word},
                      Number{"5 ms", 5, false, N::trailing_text}, Number{"3.5", 3, false, N::trailing_text},
                      Number{"0xFFFFFFFFFFFFFFFF", -1, false, N::none}));

TEST(EdsNumber, of_nothing_is_none) {
  for (const char* text : {"", " ", "abc", "+", "-", "0x", "$NODE", "--1"})
    EXPECT_FALSE(parse_eds_number(text)) << text;
}

TEST(EdsNumber, is_written_as_it_reads) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 20'000; ++i) {
    const EdsNumber n{static_cast<std::int64_t>(random() >> random() % 64), random() % 2 == 0};
    const auto back = parse_eds_number(eds_number_text(n));
    ASSERT_TRUE(back) << eds_number_text(n);
    ASSERT_EQ(back->number, n);
    ASSERT_EQ(back->oddity, N::none);
  }
}

TEST(EdsOddity, a_missing_equals_sign_is_a_blank_or_colon_with_the_line_in_the_warning) {
  const auto r = with_object("DataType 0x0006\nAccessType: rw\n");
  EXPECT_EQ(odd(r), "eds-no-equals:4 eds-no-equals:5");
  EXPECT_EQ(object_2000(r).data_type, 6);
  EXPECT_EQ(object_2000(r).access, EdsAccess::rw);
}

TEST(EdsOddity, leading_zeros_are_decimal_and_said) {
  const auto r = with_object("DataType=0x0006\nAccessType=rw\nDefaultValue=0010\n");
  EXPECT_EQ(odd(r), "eds-leading-zeros:6");
  EXPECT_EQ(object_2000(r).default_value->number->value, 10);
  EXPECT_NE(story(r.findings).find("x.eds:6"), std::string::npos);
}

TEST(EdsOddity, a_boolean_may_be_a_word_or_any_number) {
  auto r = with_object("DataType=1\nAccessType=rw\nDefaultValue=True\nPDOMapping=yes\n");
  EXPECT_EQ(odd(r), "eds-boolean-word:7 eds-boolean-word:6");
  EXPECT_EQ(object_2000(r).default_value->number->value, 1);
  EXPECT_TRUE(object_2000(r).pdo_mapping);
  r = with_object("DataType=1\nAccessType=rw\nDefaultValue=0xFF\nPDOMapping=2\n");
  EXPECT_EQ(odd(r), "eds-not-boolean:7 eds-not-boolean:6");
  EXPECT_EQ(object_2000(r).default_value->number->value, 1);
}

TEST(EdsOddity, access_words_of_vendors_are_understood) {
  for (const auto& [word, access] : {std::pair{"RO", EdsAccess::ro},
                                     {"Const", EdsAccess::constant},
                                     {"r/w", EdsAccess::rw},
                                     {"read", EdsAccess::ro},
                                     {"?", EdsAccess::rw}}) {
    const auto r = with_object(std::string("DataType=5\nAccessType=") + word + "\n");
    EXPECT_EQ(object_2000(r).access, access) << word;
  }
  EXPECT_EQ(odd(with_object("DataType=5\nAccessType=?\n")), "eds-access:5");
  EXPECT_EQ(odd(with_object("DataType=5\n")), "eds-access:1");
}

TEST(EdsOddity, values_that_do_not_fit_and_limits_the_wrong_way_round_are_left_out) {
  auto r = with_object("DataType=5\nAccessType=rw\nDefaultValue=300\n");
  EXPECT_EQ(odd(r), "eds-out-of-type:6");
  EXPECT_FALSE(object_2000(r).default_value);
  r = with_object("DataType=5\nAccessType=rw\nLowLimit=10\nHighLimit=5\n");
  EXPECT_EQ(odd(r), "eds-limits:6");
  EXPECT_FALSE(object_2000(r).high_limit);
  r = with_object("DataType=2\nAccessType=rw\nDefaultValue=0xFF\n");
  EXPECT_EQ(odd(r), "");
  EXPECT_EQ(object_2000(r).default_value->number->value, -1);
}

TEST(EdsOddity, types_unknown_or_missing_become_unsigned32_and_variables) {
  EXPECT_EQ(odd(with_object("DataType=0x00FFFF\nAccessType=rw\n")), "eds-data-type:4");
  EXPECT_EQ(odd(with_object("AccessType=rw\n")), "eds-no-data-type:1");
  const auto r = read_eds("[2000]\nParameterName=X\nObjectType=77\nDataType=5\nAccessType=rw\n", "x.eds");
  EXPECT_EQ(odd(r), "eds-object-type:3");
  EXPECT_EQ(object_2000(r).type, EdsObjectType::variable);
}

TEST(EdsOddity, any_line_end_will_do) {
  const std::string text = "[2000]|ParameterName=X|ObjectType=7|DataType=5|AccessType=rw|DefaultValue=0010|";
  for (const char* end : {"\n", "\r\n", "\r", "\n\r"}) {
    std::string with_end;
    for (const char c : text) c == '|' ? with_end += end : with_end += c;
    const auto r = read_eds(with_end, "x.eds");
    EXPECT_EQ(odd(r), "eds-leading-zeros:6") << static_cast<int>(end[0]);
  }
}

TEST(EdsOddity, code_pages_and_utf16_are_read) {
  auto r = read_eds(
      "[2000]\nParameterName=\xC4"
      "chse\nObjectType=7\nDataType=5\nAccessType=rw\n",
      "x.eds");
  EXPECT_EQ(odd(r), "eds-code-page:2");
  EXPECT_EQ(object_2000(r).name,
            "\xC3\x84"
            "chse");
  r = read_eds(
      "\xEF\xBB\xBF[2000]\nParameterName=\xD0\x9E\xD1\x81\xD1\x8C\nObjectType=7\nDataType=5\nAccessType=rw\n",
      "x.eds");
  EXPECT_EQ(odd(r), "");
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("[2000]\nParameterName=X\nObjectType=7\nDataType=5\nAccessType=rw\n"))
    wide += c, wide += '\0';
  r = read_eds(wide, "x.eds");
  EXPECT_EQ(odd(r), "eds-utf16:1");
  EXPECT_EQ(object_2000(r).name, "X");
}

TEST(EdsOddity, a_section_that_comes_twice_is_joined_and_the_first_value_counts) {
  const auto r = with_object("DataType=5\n[2000]\nAccessType=ro\nDataType=6\nDataType=5\n");
  EXPECT_EQ(odd(r), "eds-section-twice:5 eds-key-twice:7");
  EXPECT_EQ(object_2000(r).data_type, 5);
  EXPECT_EQ(object_2000(r).access, EdsAccess::ro);
}

TEST(EdsOddity, names_of_sections_may_have_blanks_prefixes_and_no_bracket) {
  const auto r = read_eds(
      "[ 2000 \nParameterName=X\nSubNumber=1\nObjectType=9\n[0x2000 Sub 0]\nParameterName=N\n"
      "ObjectType=7\nDataType=5\nAccessType=ro\n",
      "x.eds");
  EXPECT_EQ(odd(r), "eds-no-bracket:1 eds-section-name:5");
  EXPECT_EQ(r.eds.find(0x2000, 0)->name, "N");
}

TEST(EdsOddity, a_sub_object_without_its_object_makes_a_record) {
  const auto r = read_eds("[2000sub1]\nParameterName=X\nObjectType=7\nDataType=5\nAccessType=ro\n", "x.eds");
  EXPECT_EQ(odd(r), "eds-orphan:1");
  EXPECT_EQ(object_2000(r).type, EdsObjectType::record);
}

TEST(EdsOddity, lists_and_counts_that_do_not_agree_are_told) {
  const auto r =
      with_object("DataType=5\nAccessType=rw\n[ManufacturerObjects]\nSupportedObjects=3\n1=0x2001\n");
  EXPECT_EQ(odd(r), "eds-no-section:8 eds-list-count:6 eds-not-listed:1");
  const auto s = read_eds(
      "[2000]\nParameterName=X\nObjectType=9\nSubNumber=4\n[2000sub0]\nParameterName=N\n"
      "ObjectType=7\nDataType=5\nAccessType=ro\n",
      "x.eds");
  EXPECT_EQ(odd(s), "eds-sub-number:4");
}

TEST(EdsOddity, only_a_file_without_objects_is_an_error) {
  for (const char* text : {"", "hello", "[FileInfo]\nx=1\n", "[DEAD]\ncode=1\n"}) {
    const auto r = read_eds(text, "x.eds");
    EXPECT_FALSE(r.ok());
    ASSERT_FALSE(r.findings.empty());
    EXPECT_EQ(r.findings.back().severity, text::Severity::error) << text;
  }
}

TEST(EdsOddity, every_warning_has_words_in_both_languages) {
  const auto r = read_eds(
      "x\n# c\n[2000\nParameterName \"X\"\nObjectType=99\nDataType=0FFFFh\nAccessType=q\n=3\n"
      "DefaultValue=NODEID+1\nLowLimit=5 V\nHighLimit=1\nPDOMapping=7\nCompactSubObj=999\n"
      "[2000]\n[3000sub0]\nParameterName=a\n",
      "x.eds");
  EXPECT_GE(r.findings.size(), 14u);
  for (const auto& f : r.findings) {
    EXPECT_GE(f.line, 1);
    EXPECT_EQ(f.str(text::Language::english).find('{'), std::string::npos) << f.str(text::Language::english);
    EXPECT_EQ(f.str(text::Language::russian).find('{'), std::string::npos) << f.str(text::Language::russian);
  }
}

constexpr const char* kModular =
    "[1000]\nParameterName=Type\nObjectType=7\nDataType=7\nAccessType=ro\n"
    "[SupportedModules]\nNrOfEntries=2\n"
    "[M1ModuleInfo]\nProductName=8 inputs\n"
    "[M1FixedObjects]\nNrOfEntries=1\n1=0x6005\n"
    "[M1FixedObj6005]\nParameterName=Interrupt\nObjectType=7\nDataType=1\nAccessType=rw\n"
    "[M1SubExtends]\nNrOfEntries=1\n1=0x6000\n"
    "[M1SubExt6000]\nParameterName=Inputs\nObjectType=7\nDataType=5\nAccessType=ro\nPDOMapping=1\nCount="
    "1\nObjExtend=0\n"
    "[M2ModuleInfo]\nProductName=16 inputs\n"
    "[M2SubExt6000]\nParameterName=Inputs\nObjectType=7\nDataType=5\nAccessType=ro\nPDOMapping=1\nCount=2\n"
    "[ConnectedModules]\nNrOfEntries=3\n1=1\n2=2\n3=1\n";

TEST(EdsModules, each_connected_one_adds_its_entries_and_its_objects_once) {
  const auto r = read_eds(kModular, "x.dcf");
  EXPECT_EQ(odd(r), "");
  const EdsObject& inputs = r.eds.objects.at(0x6000);
  ASSERT_EQ(inputs.subs.size(), 5u) << "8 + 16 + 8 inputs are four bytes and their count";
  EXPECT_EQ(inputs.subs.at(0).default_value->number->value, 4);
  EXPECT_TRUE(inputs.subs.at(4).pdo_mapping);
  EXPECT_TRUE(r.eds.objects.contains(0x6005));
  EXPECT_EQ(r.eds.modules.at(2).name, "16 inputs");
}

TEST(EdsWriter, what_is_written_reads_back_the_same_and_is_clean) {
  for (const std::string& text : {file("clean.eds"), std::string(kModular)}) {
    Eds eds = read_eds(text, "x.eds").eds;
    EXPECT_EQ(read_eds(write_eds(eds), "x.eds").eds.objects, eds.objects);
    eds.commissioning = EdsCommissioning{5, "X axis", "mill", 1, 1000, true, 0x1234};
    eds.find(0x1000, 0)->parameter_value = EdsValue{"0x7", EdsNumber{7, false}};
    eds.find(0x1000, 0)->denotation = "what it is";
    const auto back = read_eds(write_dcf(eds), "x.dcf");
    EXPECT_EQ(story(back.findings), "");
    EXPECT_EQ(back.eds, eds);
  }
}

TEST(EdsWriter, an_eds_has_no_values_of_one_device) {
  Eds eds = read_eds(file("clean.eds"), "clean.eds").eds;
  eds.commissioning = EdsCommissioning{};
  eds.find(0x1000, 0)->parameter_value = EdsValue{"0x7", EdsNumber{7, false}};
  const std::string text = write_eds(eds);
  EXPECT_EQ(text.find("ParameterValue"), std::string::npos);
  EXPECT_EQ(text.find("DeviceComissioning"), std::string::npos);
}

// Seeds of dirt: lines shuffled, doubled, cut and spoiled. Whatever is understood is written and understood
// the same again.
TEST(EdsWriter, whatever_was_understood_of_a_spoiled_file_reads_back_the_same) {
  std::mt19937 random(306);
  const std::string clean = file("clean.eds") + kModular;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    std::string text = clean;
    for (int n = 0; n < 40; ++n) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text.erase(at, random() % 6);
          break;
        case 1:
          text.insert(at, text.substr(random() % text.size(), random() % 30));
          break;
        case 2:
          text[at] = static_cast<char>(random());
          break;
        default:
          text[at] = "=[]\n;\"$x0"[random() % 9];
      }
    }
    Eds eds = read_eds(text, "x.eds").eds;
    if (!eds.commissioning) eds.commissioning = EdsCommissioning{};
    if (eds.objects.empty()) continue;
    ASSERT_EQ(read_eds(write_dcf(eds), "x.eds").eds, eds);
  }
}

TEST(EdsOddity, a_data_type_that_no_single_object_has_is_told_with_its_line) {
  const auto r = with_object("DataType=0x99\nAccessType=rw\nDefaultValue=5\n");
  EXPECT_NE(odd(r).find("eds-structure-type:4"), std::string::npos) << odd(r);
  EXPECT_EQ(object_2000(r).data_type, 0x99);
  EXPECT_TRUE(object_specs(r.eds, 1).empty());
}

TEST(EdsNode, a_configuration_follows_the_node_id_of_another_node) {
  const auto sub = [](const char* index, const char* lines) {
    return std::string("[") + index + "]\nParameterName=X\nObjectType=7\nDataType=7\nAccessType=rw\n" +
           lines + "\n";
  };
  const auto record = [](const char* index) {
    return std::string("[") + index + "]\nParameterName=X\nObjectType=9\nSubNumber=1\n";
  };
  Eds eds =
      read_eds(
          "[DeviceComissioning]\nNodeID=9\n" + record("1800") + sub("1800sub1", "ParameterValue=0x40000189") +
              record("1801") + sub("1801sub1", "ParameterValue=0x401") + record("1402") +
              sub("1402sub1", "ParameterValue=0x80000409") + sub("1014", "ParameterValue=0x89") +
              sub("2000", "DefaultValue=$NODEID+0x10\nParameterValue=0x19") + sub("2001", "ParameterValue=9"),
          "x.dcf")
          .eds;
  EXPECT_EQ(follow_node(eds), 4);
  const auto at_10 = [&](std::uint16_t index, std::uint8_t subindex) {
    return eds.find(index, subindex)->value()->number->at(10);
  };
  EXPECT_EQ(at_10(0x1800, 1), 0x4000'018A);
  EXPECT_EQ(at_10(0x1801, 1), 0x401) << "mapped by its user";
  EXPECT_EQ(at_10(0x1402, 1), 0x8000'040A);
  EXPECT_EQ(at_10(0x1014, 0), 0x8A);
  EXPECT_EQ(at_10(0x2000, 0), 0x1A);
  EXPECT_EQ(at_10(0x2001, 0), 9) << "a number that only looks like it";
  EXPECT_EQ(eds.find(0x1800, 1)->value()->number->at(9), 0x4000'0189);
  EXPECT_EQ(follow_node(eds), 0) << "once";
}

TEST(EdsObjects, become_rows_of_a_dictionary_of_this_node) {
  const Eds eds = read_eds(file("clean.eds"), "clean.eds").eds;
  ObjectDictionary dictionary({object_specs(eds, 5)});
  EXPECT_EQ(dictionary.get(0x1000), 0x20192);
  EXPECT_EQ(dictionary.get(0x1400, 1), 0x205);
  EXPECT_EQ(dictionary.get(0x1003, 0), 3);
  const auto target = dictionary.spec(dictionary.find(0x607A, 0));
  EXPECT_EQ(target.low, -2147483648LL);
  EXPECT_EQ(target.mappable, Mappable::both);
  EXPECT_EQ(dictionary.spec(dictionary.find(0x6040, 0)).mappable, Mappable::rpdo);
  EXPECT_EQ(dictionary.text(dictionary.find(0x2001, 0)), "X");
}

}  // namespace
}  // namespace servogate::canopen
