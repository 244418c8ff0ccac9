// SPDX-License-Identifier: Apache-2.0
// `servogate modbus`: a line by hand, where no control uses it.
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "drivers/modbus/link.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/compose/devices/modbus_device.hpp"

namespace servogate::gateway::command {

namespace {

using modbus::Exception;
using modbus::Function;
using modbus::Heard;
using nlohmann::json;

const text::Entry kNoLine{"modbus.no-line",
                          "'{0}' is no line: tcp:HOST:PORT, rtu:/dev/... or MACHINE.toml#line",
                          "«{0}» — не линия: tcp:ХОСТ:ПОРТ, rtu:/dev/... или СТАНОК.toml#линия"};
const text::Entry kNotThere{"modbus.line-not-there", "{0} has no line '{1}'", "в {0} нет линии «{1}»"};
const text::Entry kMayMove{
    "modbus.may-move", "{0} can make a machine move; if that is intended, add --i-may-move",
    "{0} может привести станок в движение; если это и требуется, добавьте --i-may-move"};
const text::Entry kBadValue{"modbus.bad-value", "'{0}' is no value of {1}: expected {2}",
                            "«{0}» — не значение для {1}: нужно {2}"};
const text::Entry kTooMany{"modbus.too-many", "one request carries at most {0} {1}, up to address 65535",
                           "один запрос передаёт не более {0} ({1}), до адреса 65535"};
const text::Entry kSilence{"modbus.silence",
                           "unit {0} does not answer within {1} ms: is it on, is its address right, and on a "
                           "serial line its rate and parity?",
                           "станция {0} не отвечает за {1} мс: включена ли она, верны ли адрес, а на "
                           "последовательной линии скорость и чётность?"};
const text::Entry kWrongAnswer{"modbus.wrong-answer", "unit {0} answers, but not to what was asked ({1})",
                               "станция {0} отвечает, но не на запрос ({1})"};
const text::Entry kBroken{"modbus.broken", "the connection has ended", "соединение прервано"};
const text::Entry kException{"modbus.exception", "unit {0} refuses: exception {1} ({2})",
                             "станция {0} отказывает: исключение {1} ({2})"};
const text::Entry kWritten{"modbus.written", "written", "записано"};
const text::Entry kThere{"modbus.there", "unit {0} answers", "станция {0} отвечает"};
const text::Entry kNobody{"modbus.nobody", "nobody answers: are rate, parity and wiring right?",
                          "никто не отвечает: верны ли скорость, чётность и проводка?"};

std::string words_of(Exception e) {
  switch (e) {
    case Exception::illegal_function:
      return text::both("it does not know this function", "функция не поддерживается");
    case Exception::illegal_data_address:
      return text::both("it has no such address", "такого адреса нет");
    case Exception::illegal_data_value:
      return text::both("the value is not allowed", "значение недопустимо");
    case Exception::server_device_failure:
      return text::both("it has failed", "отказ устройства");
    case Exception::server_device_busy:
      return text::both("it is busy", "устройство занято");
    case Exception::gateway_path_unavailable:
    case Exception::gateway_target_failed:
      return text::both("the gateway does not reach it", "шлюз не может с ней связаться");
    default:
      return text::both("no words for it", "без пояснения");
  }
}

std::string words_of(Heard h) {
  switch (h) {
    case Heard::half:
      return text::both("half an answer", "половина ответа");
    case Heard::wrong_transaction:
      return text::both("of another request", "на другой запрос");
    case Heard::wrong_unit:
      return text::both("of another unit", "от другой станции");
    default:
      return text::both("checksum, function or length are wrong",
                        "неверны контрольная сумма, функция или длина");
  }
}

/// A line as the command line names it. False: it is none, which has been said.
bool named(const ModbusOptions& options, machine::LineConfig& line, NamedBus& place) {
  const std::size_t hash = options.line.rfind('#');
  line.timeout = options.timeout_ms / 1000.0;
  if (hash == std::string::npos) {
    line.url = options.line;
    line.baud = static_cast<std::int64_t>(options.baud);
    line.parity = options.parity == "none"  ? machine::LineParity::none
                  : options.parity == "odd" ? machine::LineParity::odd
                                            : machine::LineParity::even;
    line.stop_bits = options.stop_bits;
  } else {
    const std::string file = options.line.substr(0, hash), name = options.line.substr(hash + 1);
    place.machine = machine::load(file);
    if (print_findings(place.machine->findings) > 0) return false;
    const machine::LineConfig* found = place.machine->machine.line(name);
    if (found == nullptr) {
      complain(kNotThere, {file, name});
      return false;
    }
    const double timeout = line.timeout;
    line = *found;
    line.timeout = timeout;
  }
  place.url = line.url;
  return true;
}

/// A line for one command.
class Line {
 public:
  /// nullptr with `code`: it is none, somebody has it, or it cannot be opened, which has been said.
  static std::unique_ptr<Line> open(const ModbusOptions& options, const std::string& what, int& code) {
    machine::LineConfig config;
    NamedBus place;
    code = kWrongUse;
    if (!named(options, config, place)) return nullptr;
    const auto settings = link_settings(config);
    if (!settings) {
      complain(kNoLine, {options.line});
      return nullptr;
    }
    if (const auto holder = holder_of(place)) {
      code = refuse_held(*holder, config.url, what);
      return nullptr;
    }
    std::unique_ptr<Line> line(new Line(*settings, options.timeout_ms));
    code = kInfrastructure;
    return line->connect() ? std::move(line) : nullptr;
  }

  /// What came of a request; a link that has failed is opened again first. broken: it cannot be, which has
  /// been said.
  Heard ask(int unit, const modbus::Request& request, modbus::Response& response) {
    if (!link_.is_open() && !connect()) return Heard::broken;
    const Heard heard = link_.exchange(static_cast<std::uint8_t>(unit), request, response, nullptr);
    if (heard != Heard::answer) link_.close();
    return heard;
  }
  /// The exit code of a request, with what there is to say.
  int judge(int unit, Heard heard, const modbus::Response& response) const {
    const std::string number = std::to_string(unit);
    if (heard == Heard::broken) {
      complain(kBroken, {});
      return kInfrastructure;
    }
    if (heard == Heard::silence)
      complain(kSilence, {number, text::number(timeout_ms_)});
    else if (heard != Heard::answer)
      complain(kWrongAnswer, {number, words_of(heard)});
    else if (response.exception != Exception::none)
      complain(kException,
               {number, std::to_string(static_cast<int>(response.exception)), words_of(response.exception)});
    else
      return kDone;
    return kAlarm;
  }

 private:
  Line(modbus::LinkSettings settings, double timeout_ms)
      : link_(std::move(settings)), timeout_ms_(timeout_ms) {}
  bool connect() {
    drivers::Notice why;
    if (link_.open(why)) return true;
    complain(*why.entry, why.arguments);
    return false;
  }

  modbus::Link link_;
  double timeout_ms_;
};

Function reading(const std::string& kind) {
  return kind == "coils"       ? Function::read_coils
         : kind == "inputs"    ? Function::read_discrete_inputs
         : kind == "registers" ? Function::read_holding_registers
                               : Function::read_input_registers;
}

Function writing(const std::string& kind, std::size_t count) {
  if (kind == "coils") return count == 1 ? Function::write_single_coil : Function::write_multiple_coils;
  return count == 1 ? Function::write_single_register : Function::write_multiple_registers;
}

/// False: more than one request carries, which has been said.
bool fits(const modbus::Request& request, int count, const std::string& kind) {
  const int most = writes(request.function)
                       ? (kind == "coils" ? modbus::kMaxWriteBits : modbus::kMaxWriteWords)
                       : modbus::max_count(request.function);
  modbus::Pdu pdu;
  if (count <= most && encode(request, pdu)) return true;
  complain(kTooMany, {std::to_string(most), kind});
  return false;
}

std::optional<std::uint16_t> value_of(const std::string& word, bool bit) {
  const bool hexadecimal = word.starts_with("0x") || word.starts_with("0X");
  const char* begin = word.data() + (hexadecimal ? 2 : 0);
  const char* end = word.data() + word.size();
  std::uint16_t value = 0;
  const auto [at, error] = std::from_chars(begin, end, value, hexadecimal ? 16 : 10);
  if (error != std::errc{} || at != end || (bit && value > 1)) return std::nullopt;
  return value;
}

void show(const ModbusOptions& o, const modbus::Response& response) {
  const bool bits = carries_bits(response.function);
  json values = json::array();
  for (int n = 0; n < o.count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const int value = bits ? (response.data.bit(i) ? 1 : 0) : response.data.words[i];
    values.push_back(value);
    if (!o.json) print_line(std::to_string(o.address + n) + ": " + std::to_string(value));
  }
  if (o.json)
    print_exact(
        json{{"schema", 1}, {"unit", o.unit}, {"kind", o.kind}, {"address", o.address}, {"values", values}}
            .dump(1));
}

}  // namespace

int modbus_read(const ModbusOptions& o) {
  modbus::Request request;
  request.function = reading(o.kind);
  request.address = static_cast<std::uint16_t>(o.address);
  request.count = static_cast<std::uint16_t>(o.count);
  if (!fits(request, o.count, o.kind)) return kWrongUse;
  int code = kDone;
  const auto line = Line::open(o, "`modbus read`", code);
  if (line == nullptr) return code;
  modbus::Response response;
  const Heard heard = line->ask(o.unit, request, response);
  code = line->judge(o.unit, heard, response);
  if (code == kDone) show(o, response);
  return code;
}

int modbus_write(const ModbusOptions& o) {
  const bool bits = o.kind == "coils";
  modbus::Request request;
  request.function = writing(o.kind, o.values.size());
  request.address = static_cast<std::uint16_t>(o.address);
  request.count = static_cast<std::uint16_t>(o.values.size());
  if (!fits(request, static_cast<int>(o.values.size()), o.kind)) return kWrongUse;
  for (std::size_t n = 0; n < o.values.size(); ++n) {
    const auto value = value_of(o.values[n], bits);
    if (!value) {
      complain(kBadValue, {o.values[n], o.kind, bits ? "0, 1" : "0-65535, 0x0-0xFFFF"});
      return kWrongUse;
    }
    if (bits)
      request.data.set_bit(n, *value != 0);
    else
      request.data.words[n] = *value;
  }
  if (!o.may_move) {
    complain(kMayMove, {"`modbus write`"});
    return kWrongUse;
  }
  int code = kDone;
  const auto line = Line::open(o, "`modbus write`", code);
  if (line == nullptr) return code;
  modbus::Response response;
  const Heard heard = line->ask(o.unit, request, response);
  code = line->judge(o.unit, heard, response);
  if (code != kDone) return code;
  if (o.json)
    print_exact(json{{"schema", 1},
                     {"unit", o.unit},
                     {"kind", o.kind},
                     {"address", o.address},
                     {"written", o.values.size()}}
                    .dump(1));
  else
    print_line(text::render(kWritten, {}, text::user_language()));
  return kDone;
}

int modbus_scan(const ModbusOptions& o) {
  int code = kDone;
  const auto line = Line::open(o, "`modbus scan`", code);
  if (line == nullptr) return code;
  const EndBySignal end;
  modbus::Request request;
  request.function = Function::read_holding_registers;
  json units = json::array();
  for (int unit = o.first; unit <= o.last && !end.ended(); ++unit) {
    modbus::Response response;
    Heard heard = line->ask(unit, request, response);
    // A late answer of the one before.
    if (heard == Heard::wrong_unit) heard = line->ask(unit, request, response);
    if (heard == Heard::broken) return line->judge(unit, heard, response);
    // An exception is an answer; a gateway's tells of nobody behind it.
    if (heard != Heard::answer || response.exception == Exception::gateway_path_unavailable ||
        response.exception == Exception::gateway_target_failed)
      continue;
    units.push_back(unit);
    if (!o.json) {
      print_line(text::render(kThere, std::vector{std::to_string(unit)}, text::user_language()));
      keep_order();
    }
  }
  if (o.json) print_exact(json{{"schema", 1}, {"units", units}}.dump(1));
  if (end.ended()) return kStopped;
  if (!units.empty()) return kDone;
  complain(kNobody, {});
  return kAlarm;
}

}  // namespace servogate::gateway::command
