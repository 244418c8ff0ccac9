// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/junit.hpp"

#include <map>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/markup.hpp"

namespace servogate::gateway::command {

namespace {

using Result = JUnitCase::Result;

/// For XML 1.0: what has a meaning there, and the characters that it cannot hold.
std::string xml(std::string_view words) {
  std::string out;
  for (const char c : words) {
    const auto code = static_cast<unsigned char>(c);
    if (const std::string_view entity = text::entity_of(c); !entity.empty())
      out += entity;
    else if (c == '\n' || c == '\t')
      out += "&#" + std::to_string(code) + ";";
    else if (code < 0x20 || code == 0x7F)
      out += std::string("\\x") + "0123456789ABCDEF"[code >> 4] + "0123456789ABCDEF"[code & 15];
    else
      out += c;
  }
  return out;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + xml(value) + "\"";
}

std::string counts(const std::vector<const JUnitCase*>& cases) {
  int failures = 0, errors = 0, skipped = 0;
  double time_s = 0.0;
  for (const JUnitCase* c : cases) {
    failures += c->result == Result::failed ? 1 : 0;
    errors += c->result == Result::error ? 1 : 0;
    skipped += c->result == Result::skipped ? 1 : 0;
    time_s += c->time_s;
  }
  return attribute("tests", std::to_string(cases.size())) + attribute("failures", std::to_string(failures)) +
         attribute("errors", std::to_string(errors)) + attribute("skipped", std::to_string(skipped)) +
         attribute("time", text::number(time_s, 6));
}

std::string testcase(const JUnitCase& c) {
  std::string out = "    <testcase" + attribute("classname", c.classname) + attribute("name", c.name) +
                    attribute("file", c.file) + attribute("line", std::to_string(c.line)) +
                    attribute("time", text::number(c.time_s, 6)) + ">\n";
  if (!c.properties.empty()) out += "      <properties>\n";
  for (const auto& [name, value] : c.properties)
    out += "        <property" + attribute("name", name) + attribute("value", value) + "/>\n";
  if (!c.properties.empty()) out += "      </properties>\n";
  if (c.result == Result::skipped)
    out += "      <skipped" + attribute("message", c.message) + "/>\n";
  else if (c.result != Result::passed) {
    const std::string element = c.result == Result::failed ? "failure" : "error";
    out += "      <" + element + attribute("message", c.message) + attribute("type", c.type) + ">" +
           xml(c.body) + "</" + element + ">\n";
  }
  std::string attached;
  for (const std::string& file : c.attachments) attached += "[[ATTACHMENT|" + file + "]]\n";
  if (!attached.empty()) out += "      <system-out>" + xml(attached) + "</system-out>\n";
  return out + "    </testcase>\n";
}

}  // namespace

std::string junit(const std::string& name, const std::vector<JUnitCase>& cases) {
  std::map<std::string, std::vector<const JUnitCase*>> files;
  std::vector<const JUnitCase*> every;
  for (const JUnitCase& c : cases) {
    files[c.file].push_back(&c);
    every.push_back(&c);
  }
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + attribute("name", name) +
                    counts(every) + ">\n";
  for (const auto& [file, of] : files) {
    out += "  <testsuite" + attribute("name", file) + attribute("file", file) + counts(of) + ">\n";
    for (const JUnitCase* c : of) out += testcase(*c);
    out += "  </testsuite>\n";
  }
  return out + "</testsuites>\n";
}

}  // namespace servogate::gateway::command
