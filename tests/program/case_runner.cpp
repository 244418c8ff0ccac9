// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/places/places.hpp"
#include "tests/program/case_judge.hpp"

namespace servogate::program::tests {
namespace {

const std::string kFolder = servogate::tests::source_dir() + "/tests/program";

class ProgramCase : public testing::TestWithParam<std::string> {};

TEST_P(ProgramCase, gives_what_its_file_expects) {
  CaseFile c;
  ASSERT_NO_THROW(c = read_case(GetParam()));
  for (const std::string& failure : failures_of(c)) ADD_FAILURE() << failure;
}

std::string case_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = std::filesystem::relative(info.param, kFolder).replace_extension().string();
  for (char& ch : name)
    if (std::isalnum(static_cast<unsigned char>(ch)) == 0) ch = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, ProgramCase, testing::ValuesIn(case_paths(kFolder)), case_name);

}  // namespace
}  // namespace servogate::program::tests
