// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/places/places.hpp"

namespace servogate::plc {

/// One case of a data file: `=== title`, the program, `---`, the rest. Lines count from 1.
struct DataCase {
  std::string title;
  int line = 0;
  std::string source;
  std::vector<std::string> rest;
};

inline std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::vector<std::string> out;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) out.push_back(line);
  return out;
}

inline std::vector<DataCase> cases_of(const std::filesystem::path& path) {
  std::vector<DataCase> out;
  bool rest = false;
  int number = 0;
  for (const std::string& line : lines_of(path)) {
    ++number;
    if (line.starts_with("=== ")) {
      out.push_back({line.substr(4), number, "", {}});
      rest = false;
    } else if (out.empty()) {
      continue;  // introduction of the file
    } else if (line == "---") {
      rest = true;
    } else if (rest) {
      if (!line.empty() && line[0] != '#') out.back().rest.push_back(line);
    } else {
      out.back().source += line + "\n";
    }
  }
  return out;
}

/// All files below tests/plc/`folder` that end in `extension`, sorted.
inline std::vector<std::string> data_files(const std::string& folder, const std::string& extension) {
  std::vector<std::string> out;
  for (const auto& e : std::filesystem::directory_iterator(tests::source_dir() + "/tests/plc/" + folder))
    if (e.path().extension() == extension) out.push_back(e.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

inline std::string stem(const std::string& path) {
  std::string s = std::filesystem::path(path).stem().string();
  std::replace(s.begin(), s.end(), '-', '_');
  return s;
}

}  // namespace servogate::plc
