// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "kernel/program/execution/state/record_files.hpp"
#include "machine/keys/document.hpp"

/// The record files of part programs as text: a part of the state. Not real-time safe.
namespace servogate::machine {

/// What stands behind the head of the file. Bytes of a text beyond ASCII are written as the characters of the
/// same number, since they need not be UTF-8.
std::string write_records(const program::RecordFiles& files);
/// Each error has its place and names `file`; with an error `files` is half read.
void read_records(const Element& root, const std::string& file, program::RecordFiles& files,
                  std::vector<text::Finding>& findings);

}  // namespace servogate::machine
