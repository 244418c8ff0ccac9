// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::machine_run {

/// A folder of the test's own, removed with everything in it at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path(std::string_view name) const { return folder_ + "/" + std::string(name); }
  /// Writes a file and returns its path.
  std::string write(std::string_view name, std::string_view content) const;

 private:
  std::string folder_;
};

/// Content of a file; a failed test and "" where it cannot be read.
std::string read_all(const std::string& path);
/// Path inside the source tree.
std::string source(std::string_view path);

/// The example mill, and it with something replaced, in a folder where its PLC source is found.
std::string mill_file();
std::string changed_mill(const Scratch& scratch, const std::string& from, const std::string& to);

/// How the servogate program ended.
struct Ending {
  int code = -1;  ///< exit code; 1000 + signal when a signal ended it
  std::string out, err;
};
using Environment = std::map<std::string, std::string>;

/// The servogate program, started with `arguments`; LANG is C unless `environment` says otherwise.
class Program {
 public:
  explicit Program(const std::vector<std::string>& arguments, const Environment& environment = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  void signal(int number) const;
  /// Waits for the end; kills it after ten minutes, when it hangs.
  Ending wait();

 private:
  Scratch scratch_;
  pid_t pid_ = -1;
};

/// Starts the program and waits for its end.
Ending servogate(const std::vector<std::string>& arguments, const Environment& environment = {});

/// A trace file read back: named columns of numbers, one row a cycle.
class TraceFile {
 public:
  explicit TraceFile(const std::string& path);
  std::size_t rows() const { return rows_.size(); }
  /// Index of a column; a failed test and 0 where there is none.
  std::size_t column(std::string_view name) const;
  double at(std::size_t row, std::size_t column) const { return rows_[row][column]; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> rows_;
};

}  // namespace servogate::machine_run
