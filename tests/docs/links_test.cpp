// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/docs/markdown.hpp"
#include "tests/places/places.hpp"

namespace servogate::docs {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// All Markdown files of the source tree; builds and what runs leave behind are no part of it.
std::vector<fs::path> documents() {
  std::vector<fs::path> out;
  fs::recursive_directory_iterator it(tests::source_dir()), end;
  for (; it != end; ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory() && (name == ".git" || name == "out" || name.rfind("build", 0) == 0))
      it.disable_recursion_pending();
    else if (it->is_regular_file() && it->path().extension() == ".md")
      out.push_back(it->path());
  }
  return out;
}

/// Relative links that lead nowhere, as `line: target`.
std::vector<std::string> dead_links(const fs::path& folder, const std::string& text) {
  std::vector<std::string> out;
  for (const Link& link : read_markdown(text).links) {
    if (link.target.find("://") != std::string::npos || link.target.rfind("mailto:", 0) == 0) continue;
    const std::string file = link.target.substr(0, link.target.find('#'));
    if (!file.empty() && !fs::exists(folder / file))
      out.push_back(std::to_string(link.line) + ": " + link.target);
  }
  return out;
}

TEST(Links, lead_to_files_that_exist) {
  const std::vector<fs::path> all = documents();
  ASSERT_GE(all.size(), 30u);
  int links = 0;
  for (const fs::path& document : all) {
    const std::string text = content(document);
    links += static_cast<int>(read_markdown(text).links.size());
    for (const std::string& dead : dead_links(document.parent_path(), text))
      ADD_FAILURE() << document.string() << ":" << dead;
  }
  EXPECT_GE(links, 30);
}

TEST(Links, a_dead_one_would_be_noticed) {
  const fs::path folder = tests::source_dir();
  EXPECT_EQ(
      dead_links(folder,
                 "[a](README.md) [b](docs/none.md#x)\n```\n[c](gone)\n```\n[d](#here) [e](http://x.y/z)\n"),
      (std::vector<std::string>{"1: docs/none.md#x"}));
}

TEST(Folders, each_says_in_a_readme_what_lives_there) {
  const fs::path tree = tests::source_dir();
  std::set<fs::path> folders;
  for (const char* room : {"tests", "examples", "devices", "docs"}) {
    folders.insert(tree / room);
    for (const auto& entry : fs::recursive_directory_iterator(tree / room))
      // Every file of a corpus is an input: their folders are told of in the one above.
      if (entry.is_directory() && entry.path().filename() != "corpus" && entry.path().filename() != "state" &&
          entry.path().filename() != "__pycache__")
        folders.insert(entry.path());
  }
  for (const char* room : {"firmware_if", "drivers", "kernel", "plc", "bench", "gateway"}) {
    folders.insert(tree / room);
    for (const auto& entry : fs::recursive_directory_iterator(tree / room))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp")
        folders.insert(entry.path().parent_path());
  }
  for (const fs::path& folder : folders) EXPECT_TRUE(fs::exists(folder / "README.md")) << folder;
}

}  // namespace
}  // namespace servogate::docs
