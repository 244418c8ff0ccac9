// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <string_view>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/watch/watcher.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::scenario {

namespace {

constexpr std::int64_t kMostOfReference = std::int64_t{256} << 20;

std::vector<std::string_view> cells(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> out;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t comma = std::min(line.find(',', at), line.size());
    out.push_back(line.substr(at, comma - at));
    at = comma + 1;
  }
  return out;
}

bool number(std::string_view cell, double& value) {
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc{} && end == cell.data() + cell.size();
}

}  // namespace

std::optional<Watcher::Reference> Watcher::read_reference(const Condition& c, const Signals& signals,
                                                          const std::string& path,
                                                          machine::Reading& reading) {
  const auto wrong = [&](const std::string& why) {
    reading.error(c.at, finding::kReference, {c.file, why});
    return std::nullopt;
  };
  std::string why;
  const auto text = files::read_file(path, kMostOfReference, why);
  if (!text) return wrong(why);
  std::string_view rest = *text;
  const auto line = [&] {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view l = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return l;
  };
  const std::vector<std::string_view> header = cells(line());
  if (header.empty() || header[0] != "t")
    return wrong(text::both("its first column is not `t`", "первый столбец не `t`"));
  Reference r;
  std::vector<std::size_t> columns;
  for (std::size_t n = 1; n < header.size(); ++n) {
    const bool wanted = c.names.empty() || std::any_of(c.names.begin(), c.names.end(),
                                                       [&](const auto& name) { return name == header[n]; });
    if (!wanted) continue;
    if (auto s = signals.find(header[n])) {
      r.signals.push_back(std::move(*s));
      columns.push_back(n);
    }
  }
  for (const std::string& name : c.names)
    if (std::find(header.begin(), header.end(), name) == header.end())
      return wrong(text::both("no column is called " + name, "нет столбца " + name));
  if (columns.empty())
    return wrong(
        text::both("no column is a signal of this machine", "ни один столбец не сигнал этого станка"));
  r.values.resize(columns.size());
  for (int row = 2; !rest.empty(); ++row) {
    const std::vector<std::string_view> cell = cells(line());
    double t = 0.0;
    bool good = cell.size() == header.size() && number(cell[0], t) && (r.t.empty() || t > r.t.back());
    for (std::size_t n = 0; good && n < columns.size(); ++n) {
      double value = 0.0;
      good = number(cell[columns[n]], value);
      r.values[n].push_back(value);
    }
    if (!good)
      return wrong(text::both("line ", "строка ") + std::to_string(row) +
                   text::both(" is no row of numbers with rising t", " не строка чисел с растущим t"));
    r.t.push_back(t);
  }
  return r;
}

}  // namespace servogate::scenario
