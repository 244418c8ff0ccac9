// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/sheet_file.hpp"

#include <cerrno>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kWritten{"eds.written",
                           "{0}: EDS of node {1}, {2} entries; types guessed from the length: {3}",
                           "{0}: EDS узла {1}, записей: {2}; тип угадан по длине: {3}"};
const text::Entry kLeftOut{"eds.left-out",
                           "{0}: not described, as they cannot be read and their type is not known: {1}",
                           "{0}: не описаны, так как не читаются и тип неизвестен: {1}"};
const text::Entry kNoValue{"eds.no-value", "{0}: without a DefaultValue, as a line cannot hold it: {1}",
                           "{0}: без DefaultValue, в строку его не записать: {1}"};

std::string joined(const std::vector<std::string>& places) {
  std::string text;
  for (const std::string& place : places) text += (text.empty() ? "" : ", ") + place;
  return text;
}

}  // namespace

canopen::SheetOrigin sheet_origin(const std::string& path, const std::string& command) {
  canopen::SheetOrigin origin;
  origin.file = std::filesystem::path(path).filename().string();
  origin.command = command;
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  char text[48];
  std::snprintf(text, sizeof text, "%02d-%02d-%04d", parts.tm_mon + 1, parts.tm_mday, parts.tm_year + 1900);
  origin.date = text;
  std::snprintf(text, sizeof text, "%02d:%02d%s", (parts.tm_hour + 11) % 12 + 1, parts.tm_min,
                parts.tm_hour < 12 ? "AM" : "PM");
  origin.time = text;
  return origin;
}

int write_bytes(const std::string& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  if (file.flush()) return kDone;
  complain(kCannotWrite, {path, text::words_of(errno)});
  return kInfrastructure;
}

int write_sheet(const std::string& path, const canopen::DeviceSheet& sheet, canopen::NodeId node) {
  if (const int code = write_bytes(path, canopen::write_eds(sheet.eds)); code != kDone) return code;
  if (!sheet.left_out.empty()) complain(kLeftOut, {path, joined(sheet.left_out)});
  if (!sheet.no_value.empty()) complain(kNoValue, {path, joined(sheet.no_value)});
  const std::vector<std::string> facts{path, std::to_string(node), std::to_string(sheet.entries),
                                       std::to_string(sheet.guessed.size())};
  tell(text::render(kWritten, facts, text::user_language()));
  return kDone;
}

}  // namespace servogate::gateway::command
