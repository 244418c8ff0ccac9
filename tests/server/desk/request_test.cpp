// SPDX-License-Identifier: Apache-2.0
// Lines that are no requests, or whose fields have another type: each is answered with a sentence of our own.
#include <gtest/gtest.h>

#include "gateway/control/server/protocol/request_form.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// What is said of a line; empty: it is a request.
std::string said(const std::string& line, text::Language language) {
  FormProblem problem;
  if (read_request(line, problem)) return {};
  return text::render(*problem.entry, problem.arguments, language);
}
std::string said(const std::string& line) { return said(line, text::Language::english); }

TEST(Request, names_the_field_of_another_type_and_what_was_expected) {
  const struct {
    const char *line, *words;
  } rows[] = {
      {R"({"cmd":5})", "'cmd' must be a string, and is a number"},
      {R"({})", "'cmd' must be a string, and is missing"},
      {R"({"cmd":"status","language":["ru"]})", "'language' must be 'en' or 'ru', and is a list"},
      {R"({"cmd":"status","language":"de"})", "'language' must be 'en' or 'ru', and is 'de'"},
      {"", "a request is an object as {\"cmd\":\"status\"}, and this is an empty line"},
      {R"({"cmd":"status","asker":null})", "'asker' must be a string, and is null"},
      {R"({"cmd":"jog","axis":1,"value":1})", "'axis' must be a string, and is a number"},
      {R"({"cmd":"jog","axis":"X","value":"1"})", "'value' must be a number, and is a string"},
      {R"({"cmd":"jog","axis":"X","value":1,"unit":{}})", "'unit' must be a string, and is an object"},
      {R"({"cmd":"home","axes":"X"})", "'axes' must be a list of strings, and is a string"},
      {R"({"cmd":"home","axes":["X",1]})", "'axes' must be a list of strings, and is a list"},
      {R"({"cmd":"mdi","block":true})", "'block' must be a string, and is true"},
      {R"({"cmd":"load"})", "'program' must be a string, and is missing"},
      {R"({"cmd":"jog","value":1})", "'axis' must be a string, and is missing"},
      {R"({"cmd":"load","program":7})", "'program' must be a string, and is a number"},
      {R"({"cmd":"load","program":"a.nc","dialect":7})", "'dialect' must be a string, and is a number"},
      {R"({"cmd":"input","point":1})", "'point' must be a string, and is a number"},
      {R"({"cmd":"input","point":"a","value":[1]})",
       "'value' must be a number, true, false or a string, and is a list"},
      {R"({"cmd":"plc_force","name":"A","value":1})", "'value' must be a string, and is a number"},
      {R"({"cmd":"plc_force","name":"A","value":"1","stay":1})",
       "'stay' must be true or false, and is a number"},
      {R"({"cmd":"plc_watch","names":[1]})", "'names' must be a list of strings, and is a list"},
      {R"({"cmd":"plc_watch","body":1})", "'body' must be a string, and is a number"},
      {R"({"cmd":"plc_watch","names":[],"times":"yes"})", "'times' must be true or false, and is a string"},
      {R"({"cmd":"plc_load","files":"a.st"})", "'files' must be a list of strings, and is a string"},
      {R"({"cmd":"plc_load","online":0})", "'online' must be true or false, and is a number"},
      {R"({"cmd":"sdo_read","node":"1"})", "'node' must be a number, and is a string"},
      {R"([{"cmd":"status"}])", "a request is an object as {\"cmd\":\"status\"}, and this is a list"},
      {"5", "a request is an object as {\"cmd\":\"status\"}, and this is a number"},
      {"null", "a request is an object as {\"cmd\":\"status\"}, and this is null"},
      {"{\"cmd\":", "this is no JSON: {\"cmd\":"},
      {R"({"cmd":"override","value":1e999})", R"(this is no JSON: {"cmd":"override","value":1e999})"},
  };
  for (const auto& row : rows) EXPECT_EQ(said(row.line), row.words) << row.line;
  EXPECT_EQ(said(R"({"cmd":5})", text::Language::russian), "«cmd»: ожидается строка, а здесь число");
}

TEST(Request, passes_with_every_field_as_it_should_be) {
  for (const char* line :
       {R"({"cmd":"status"})", R"({"cmd":"input","point":"a","value":true})",
        R"({"cmd":"input","point":"a","value":"auto"})", R"({"cmd":"plc_force","name":"A","value":"1"})",
        R"({"cmd":"home","axes":["X","Y"]})", R"({"cmd":"status","unknown":{"a":[1]}})"})
    EXPECT_EQ(said(line), "") << line;
}

TEST(Request, that_is_nested_absurdly_is_refused_whatever_its_depth) {
  for (const std::size_t depth : {5u, 100u, 60'000u}) {
    const std::string open(depth, '['), close(depth, ']');
    EXPECT_EQ(said(open + close), "a request is nested at most 3 deep");
    EXPECT_EQ(said("{\"cmd\":\"status\",\"x\":" + open + close + "}"), "a request is nested at most 3 deep");
    EXPECT_EQ(said("{\"cmd\":" + open), "a request is nested at most 3 deep");
  }
}

TEST(Request, that_can_be_read_in_two_ways_is_refused) {
  EXPECT_EQ(said(R"({"cmd":"stop","cmd":"start"})"), "'cmd' stands twice in the request");
  EXPECT_EQ(said(R"({"cmd":"jog","axis":"X","value":1,"axis":"Y"})"), "'axis' stands twice in the request");
  EXPECT_EQ(said(R"({"cmd":"load","program":"part.nc\u0000x"})"),
            "'program' must be a string, and is a string with a zero character");
  EXPECT_EQ(said(R"({"cmd":"home","axes":["X\u0000"]})"), "'axes' must be a list of strings, and is a list");
}

TEST(Request, of_the_wrong_form_is_answered_in_its_own_language_and_the_control_goes_on) {
  Shell shell;
  shell.up();
  const json answer = shell.ask({{"cmd", 5}, {"language", "ru"}});
  EXPECT_EQ(answer["exit"], 2);
  EXPECT_EQ(answer["code"], "socket.wrong-type");
  EXPECT_EQ(answer["text"], "«cmd»: ожидается строка, а здесь число");
  const json node = shell.ask(
      {{"cmd", "sdo_read"}, {"bus", "can"}, {"node", 4294967297}, {"index", 0x1000}, {"subindex", 0}});
  EXPECT_EQ(node["code"], "socket.no-such-object") << "node 1 is not meant";
  EXPECT_TRUE(shell.status()["ok"].get<bool>());
}

}  // namespace
}  // namespace servogate::gateway::testing
