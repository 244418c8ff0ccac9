// SPDX-License-Identifier: Apache-2.0
#include "machine/loading/node_files.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "machine/check/findings.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::machine {

namespace {

/// Programs of drives are some megabytes at most.
constexpr std::int64_t kMostOfNodeProgram = std::int64_t{64} << 20;

class NodeFileReader {
 public:
  NodeFileReader(LoadResult& result, Reading& reading, std::vector<text::Finding>& of_files)
      : result_(result), reading_(reading), of_files_(of_files) {}

  void read(const BusConfig& bus, const NodeConfig& node, const std::string& path) {
    LoadResult::NodeFiles files;
    program(node, path, files);
    configuration(node, path, files);
    result_.node_files.emplace(bus.name + "." + node.name, std::move(files));
  }

 private:
  Where at(const std::string& path) const { return result_.machine.where(path); }

  std::optional<std::string> content(const std::string& name, std::int64_t most, const std::string& path) {
    std::string reason;
    auto text = files::read_file(result_.machine.resolve(name), most, reason);
    if (!text) reading_.error(at(path), finding::kNodeFile, {name, reason});
    if (text && text->empty())
      reading_.error(at(path), finding::kNodeFile, {name, text::both("is empty", "пуст")});
    return text;
  }

  void program(const NodeConfig& node, const std::string& path, LoadResult::NodeFiles& files) {
    if (node.program.empty()) return;
    if (node.program_version < 0)
      reading_.error(at(path + ".program"), finding::kProgramVersion, {node.name});
    if (const auto bytes = content(node.program, kMostOfNodeProgram, path + ".program"))
      files.program.assign(bytes->begin(), bytes->end());
  }

  void configuration(const NodeConfig& node, const std::string& path, LoadResult::NodeFiles& files) {
    if (!node.configuration_date.empty()) {
      files.configuration_date = parse_configuration_date(node.configuration_date);
      if (!files.configuration_date)
        reading_.error(at(path + ".configuration_date"), finding::kConfigurationDate,
                       {node.configuration_date});
    }
    if (node.configuration.empty()) {
      for (const char* key : {".configuration_date", ".configuration_store"})
        if (result_.machine.places.contains(path + key))
          reading_.error(at(path + key), finding::kNoConfiguration, {std::string(key).substr(1)});
      return;
    }
    const auto bytes = content(node.configuration, files::kMostOfSettings, path + ".configuration");
    if (!bytes) return;
    const canopen::EdsResult dcf = canopen::read_eds(*bytes, node.configuration);
    const bool broken = !dcf.eds.objects.empty() && !dcf.ok();
    const auto entries = canopen::configuration_of(dcf.eds, static_cast<canopen::NodeId>(node.id));
    if (entries.empty() && !broken)
      return reading_.error(at(path + ".configuration"), finding::kEmptyConfiguration, {node.configuration});
    for (text::Finding f : dcf.findings) {
      f.column = std::max(f.column, 1);
      of_files_.push_back(std::move(f));
    }
    files.concise_dcf = canopen::write_concise_dcf(entries);
  }

  LoadResult& result_;
  Reading& reading_;
  std::vector<text::Finding>& of_files_;
};

}  // namespace

void load_node_files(LoadResult& result, Reading& reading, std::vector<text::Finding>& of_files) {
  NodeFileReader reader(result, reading, of_files);
  for (std::size_t b = 0; b < result.machine.buses.size(); ++b)
    for (std::size_t n = 0; n < result.machine.buses[b].nodes.size(); ++n)
      reader.read(result.machine.buses[b], result.machine.buses[b].nodes[n],
                  "bus." + std::to_string(b) + ".node." + std::to_string(n));
}

std::optional<canopen::ConfigurationDate> parse_configuration_date(std::string_view text) {
  namespace chr = std::chrono;
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, end = 0;
  const std::string copy(text);
  const int count = std::sscanf(copy.c_str(), "%4d-%2d-%2d%n %2d:%2d%n:%2d%n", &year, &month, &day, &end,
                                &hour, &minute, &end, &second, &end);
  if ((count != 3 && count != 5 && count != 6) || end != static_cast<int>(copy.size())) return std::nullopt;
  const chr::year_month_day date{chr::year(year), chr::month(static_cast<unsigned>(month)),
                                 chr::day(static_cast<unsigned>(day))};
  constexpr chr::year_month_day kEpoch{chr::year(1984), chr::January, chr::day(1)};
  if (month < 1 || day < 1 || !date.ok() || date < kEpoch) return std::nullopt;
  if (hour < 0 || hour > 23 || minute < 0 || minute > 59 || second < 0 || second > 59) return std::nullopt;
  const auto days = (chr::sys_days(date) - chr::sys_days(kEpoch)).count();
  return canopen::ConfigurationDate{static_cast<std::uint32_t>(days),
                                    static_cast<std::uint32_t>(((hour * 60 + minute) * 60 + second) * 1000)};
}

}  // namespace servogate::machine
