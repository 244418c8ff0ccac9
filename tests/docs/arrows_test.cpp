// SPDX-License-Identifier: Apache-2.0
// Who may include whom: the rooms as docs/architecture.md has them, and the folders of a room as its README
// orders them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/places/places.hpp"

namespace servogate::docs {
namespace {

namespace fs = std::filesystem;

struct Include {
  std::string from, to;  ///< paths from the root of the tree
};

std::vector<Include> includes_of(const std::string& room) {
  std::vector<Include> out;
  for (const auto& file : fs::recursive_directory_iterator(tests::source_dir() / fs::path(room))) {
    const std::string extension = file.path().extension().string();
    if (extension != ".hpp" && extension != ".cpp") continue;
    const std::string from = fs::relative(file.path(), tests::source_dir()).string();
    std::ifstream in(file.path());
    constexpr std::string_view kBegin = "#include \"";
    for (std::string line; std::getline(in, line);)
      if (line.starts_with(kBegin))
        out.push_back({from, line.substr(kBegin.size(), line.rfind('"') - kBegin.size())});
  }
  return out;
}

/// Number `n` of the names in a path, empty: it is the file's.
std::string folder(const std::string& path, std::size_t n) {
  std::istringstream in(path);
  std::string name;
  for (std::size_t i = 0; i <= n; ++i) std::getline(in, name, '/');
  return in.eof() ? std::string() : name;
}

TEST(Arrows, of_rooms_run_one_way) {
  const std::map<std::string, std::set<std::string>> allowed = {
      {"firmware_if", {"firmware_if"}},
      {"drivers", {"drivers", "firmware_if"}},
      {"kernel", {"kernel", "firmware_if"}},
      {"plc", {"plc", "firmware_if"}},
      {"bench", {"bench", "machine", "kernel", "plc", "firmware_if"}},
  };
  for (const auto& [room, others] : allowed) {
    const std::vector<Include> all = includes_of(room);
    EXPECT_GE(all.size(), 10u) << room;
    for (const Include& i : all)
      EXPECT_TRUE(others.contains(folder(i.to, 0))) << i.from << " includes " << i.to;
  }
}

/// The order that a README declares in the line behind this one.
std::vector<std::string> declared_order(const std::string& room) {
  std::ifstream in(tests::source_dir() / fs::path(room) / "README.md");
  std::string line;
  while (std::getline(in, line) && line != "Its folders, each of which uses only those before it:") {
  }
  std::getline(in, line);
  std::vector<std::string> out;
  std::istringstream names(line);
  for (std::string name; names >> name;) {
    if (name.ends_with(',')) name.pop_back();
    out.push_back(name);
  }
  return out;
}

TEST(Arrows, of_folders_run_as_the_readme_of_their_room_says) {
  for (const std::string room : {"plc", "kernel/program"}) {
    const std::vector<std::string> order = declared_order(room);
    const auto depth = static_cast<std::size_t>(std::count(room.begin(), room.end(), '/')) + 1;
    const auto place = [&](const std::string& name) { return std::find(order.begin(), order.end(), name); };
    int crossing = 0;
    for (const Include& i : includes_of(room)) {
      if (!i.to.starts_with(room + "/")) continue;
      const auto from = place(folder(i.from, depth)), to = place(folder(i.to, depth));
      EXPECT_NE(from, order.end()) << i.from << " is in no folder that the README of " << room << " names";
      EXPECT_LE(to, from) << i.from << " includes " << i.to;
      crossing += from == to ? 0 : 1;
    }
    EXPECT_GE(crossing, 20) << room;
  }
}

}  // namespace
}  // namespace servogate::docs
