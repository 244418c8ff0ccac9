// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace servogate::shell {

/// What a line of shell left behind.
struct Ended {
  int code = -1;  ///< of the line; 124 when it did not end in time
  std::string out, err;
  bool out_has(std::string_view part) const { return out.find(part) != std::string::npos; }
  bool err_has(std::string_view part) const { return err.find(part) != std::string::npos; }
};

/// A folder of the test's own in which lines of shell run, removed with everything in it at the end.
class Desk {
 public:
  Desk();
  ~Desk();
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  /// Runs a line with `/bin/sh`. $SG: the program; $MILL, $BRACKET: the example's machine and part program.
  /// Ends it after ten minutes: what hangs, not what is slow.
  Ended line(const std::string& line, const std::string& language = "C") const;
  /// Writes a file of this folder.
  void write(const std::string& name, const std::string& content) const;
  /// Its content, "" when there is none.
  std::string text(const std::string& name) const;
  bool has(const std::string& name) const;
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
};

/// A file of the source tree.
std::string source(const std::string& path);

}  // namespace servogate::shell
