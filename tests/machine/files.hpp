// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "tests/places/places.hpp"

namespace servogate::machine::test {

inline std::string source(const std::string& path) { return tests::source_dir() + "/" + path; }

inline std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void write_text(const std::string& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Findings as lines, with paths that do not depend on where the tree lies.
inline std::string lines_of(const std::vector<text::Finding>& findings, text::Language language) {
  std::string out;
  for (const text::Finding& f : findings) {
    text::Finding shown = f;
    shown.file = std::filesystem::path(f.file).filename().string();
    out += shown.str(language) + "\n";
  }
  const std::string root = tests::source_dir();
  for (std::size_t at = out.find(root); at != std::string::npos; at = out.find(root))
    out.replace(at, root.size(), "{source}");
  return out;
}

/// A folder of its own for one test, empty at its start.
inline std::string scratch(const std::string& name) {
  const auto path = std::filesystem::path(tests::binary_dir()) / "scratch_machine" / name;
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path.string();
}

/// The text of an example machine without its PLC sources, so that only the machine file is under test.
inline std::string example(const std::string& name) {
  std::string text = read_text(source("examples/" + name + "/machine.toml"));
  const std::size_t at = text.find("sources = [");
  if (at != std::string::npos) text.insert(at, "# ");
  return text;
}

}  // namespace servogate::machine::test
