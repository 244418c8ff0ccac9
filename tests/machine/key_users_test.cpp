// SPDX-License-Identifier: Apache-2.0
// No key may be read, checked, documented, and then used by nobody: key_users.txt names for each of them who
// makes it work. A new key fails here until somebody has said so, and a file that drops a key fails too.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

void add_keys(const Section& section, const std::string& path, std::set<std::string>& out) {
  for (const Key& key : section.keys)
    if (key.child != nullptr)
      add_keys(key.child(), path + std::string(key.name) + ".", out);
    else
      out.insert(path + std::string(key.name));
}

struct User {
  std::string how, file, member;
};

std::map<std::string, User> users() {
  std::map<std::string, User> out;
  std::istringstream list(test::read_text(test::source("tests/machine/key_users.txt")));
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string key;
    User user;
    words >> key >> user.how >> user.file >> user.member;
    EXPECT_TRUE(out.emplace(key, user).second) << key << " stands there twice";
  }
  return out;
}

TEST(KeyUsers, every_key_of_the_files_has_somebody_who_makes_it_work) {
  std::set<std::string> keys;
  add_keys(section_of<MachineConfig>(), "", keys);
  add_keys(section_of<DeviceConfig>(), "device.", keys);
  const auto listed = users();
  for (const std::string& key : keys)
    EXPECT_TRUE(listed.contains(key)) << key << ": say in tests/machine/key_users.txt who makes it work";
  for (const auto& [key, user] : listed) EXPECT_TRUE(keys.contains(key)) << key << " is no key any more";
}

/// Checks and words about a machine; nothing that moves one.
bool only_speaks(const std::string& file) {
  return file.starts_with("machine/check/") || file.starts_with("machine/consequences");
}

/// As a word of a line that is no comment.
bool reads(const std::string& source, const std::string& member) {
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  std::istringstream lines(source);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line.compare(first, 2, "//") == 0) continue;
    for (std::size_t at = line.find(member); at != std::string::npos; at = line.find(member, at + 1)) {
      const std::size_t end = at + member.size();
      if ((at == 0 || !letter(line[at - 1])) && (end == line.size() || !letter(line[end]))) return true;
    }
  }
  return false;
}

TEST(KeyUsers, who_is_said_to_make_a_key_work_knows_it) {
  for (const auto& [key, user] : users()) {
    if (user.how == "people") continue;
    ASSERT_TRUE(user.how == "acts" || user.how == "check") << key << ": " << user.how;
    EXPECT_TRUE(user.file.starts_with("gateway/") || user.file.starts_with("machine/")) << key;
    EXPECT_EQ(user.how == "check", only_speaks(user.file) && user.file != "machine/check/names.cpp") << key;
    ASSERT_TRUE(std::filesystem::exists(test::source(user.file))) << key << ": " << user.file;
    EXPECT_TRUE(reads(test::read_text(test::source(user.file)), user.member))
        << key << ": " << user.file << " does not read " << user.member << " any more";
  }
}

}  // namespace
}  // namespace servogate::machine
