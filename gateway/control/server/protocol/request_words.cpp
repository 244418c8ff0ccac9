// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/request_words.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>

#include "firmware_if/text/decimal_comma.hpp"
#include "firmware_if/text/units.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kArguments{"client.arguments", "`{0}` takes: {1}", "`{0}` принимает: {1}"};

/// The words of one command.
class Words {
 public:
  Words(nlohmann::json& request, const std::vector<std::string>& arguments, FormProblem& problem)
      : r_(request), a_(arguments), problem_(problem), command_(request.value("cmd", "")) {}

  bool read() {
    if (command_ == "home") r_["axes"] = a_;
    if (command_ == "jog") return two("AXIS DISTANCE") && jog();
    if (command_ == "zero") return (a_.size() == 1 || two("AXIS [VALUE]")) && zero();
    if (command_ == "mdi") return mdi();
    if (command_ == "load") return one("PROGRAM") && set("program", std::filesystem::absolute(a_[0]).string());
    if (command_ == "assign") return one("AXIS") && set("axis", a_[0]);
    if (command_ == "override") return one("PCT (0 to 150)") && override_feed();
    if (command_ == "power") return one("on | off") && power();
    if (command_ == "input") return two("POINT on | off | auto | NUMBER") && input();
    return true;
  }

 private:
  bool set(const char* key, nlohmann::json value) {
    r_[key] = std::move(value);
    return true;
  }
  /// False where a decimal comma has been found and said.
  bool comma_free(const std::string& what) {
    const std::string point = text::with_decimal_point(what);
    if (!point.empty()) problem_ = {&kComma, {what, point}};
    return point.empty();
  }
  bool wrong(const char* takes) {
    if (a_.empty() || comma_free(a_.back())) problem_ = {&kArguments, {command_, takes}};
    return false;
  }
  bool not_a(const std::string& what, std::string_view english, std::string_view russian) {
    if (comma_free(what)) problem_ = {&kBadNumber, {what, text::both(english, russian)}};
    return false;
  }
  bool one(const char* takes) { return a_.size() == 1 || wrong(takes); }
  bool two(const char* takes) { return a_.size() == 2 || wrong(takes); }

  bool jog() {
    r_["axis"] = a_[0];
    if (a_[1] == "+" || a_[1] == "-") {
      r_["cmd"] = "jog_continuous";
      return set("value", a_[1] == "+" ? 1 : -1);
    }
    if (!parse_number(a_[1], value_, rest_))
      return not_a(a_[1], "a distance such as +1mm or -0.5deg", "перемещение вида +1mm или -0.5deg");
    if (!rest_.empty()) r_["unit"] = text::unit_symbol(rest_);
    return set("value", value_);
  }
  bool zero() {
    if (a_.size() == 2 && !parse_number(a_[1], value_, rest_)) return not_a(a_[1], "a number", "число");
    r_["axis"] = a_[0];
    if (!rest_.empty()) r_["unit"] = text::unit_symbol(rest_);
    return set("value", value_);
  }
  bool mdi() {
    if (a_.empty()) return wrong("BLOCK");
    std::string block = a_[0];
    for (std::size_t i = 1; i < a_.size(); ++i) block += " " + a_[i];
    return set("block", block);
  }
  bool override_feed() {
    if (!parse_number(a_[0], value_, rest_) || (!rest_.empty() && rest_ != "%")) return wrong("PCT (0 to 150)");
    return set("value", value_);
  }
  bool power() {
    if (a_[0] != "on" && a_[0] != "off") return wrong("on | off");
    return set("value", a_[0] == "on" ? 1 : 0);
  }
  bool input() {
    r_["point"] = a_[0];
    if (a_[1] == "on" || a_[1] == "off") return set("value", a_[1] == "on");
    if (a_[1] == "auto") return set("value", "auto");
    if (parse_number(a_[1], value_, rest_) && rest_.empty()) return set("value", value_);
    return wrong("POINT on | off | auto | NUMBER");
  }

  nlohmann::json& r_;
  const std::vector<std::string>& a_;
  FormProblem& problem_;
  std::string command_;
  double value_ = 0.0;
  std::string_view rest_;
};

}  // namespace

bool parse_number(std::string_view text, double& value, std::string_view& rest) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return error == std::errc{} && std::isfinite(value) && !rest.starts_with(',');
}

bool add_words(nlohmann::json& request, const std::vector<std::string>& arguments, FormProblem& problem) {
  return Words(request, arguments, problem).read();
}

}  // namespace servogate::gateway
