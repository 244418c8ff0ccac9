// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/report.hpp"

#include <algorithm>
#include <tuple>

#include "plc/terms/texts.hpp"

namespace servogate::plc::syntax {

void Report::add(text::Severity s, const Location& at, const text::Entry& entry,
                 std::vector<std::string> arguments) {
  if (!places_.emplace(s, at.file, at.line, at.column).second) return;
  const std::size_t kind = s == text::Severity::error ? 0 : 1;
  if (kept_[kind] >= kMost) {
    ++left_out_[kind];
    return;
  }
  ++kept_[kind];
  Item item;
  item.at = at;
  item.finding.severity = s;
  if (at.file >= 0 && static_cast<std::size_t>(at.file) < files_.size())
    item.finding.file = files_[static_cast<std::size_t>(at.file)];
  item.finding.line = at.line;
  item.finding.column = at.column;
  item.finding.entry = &entry;
  item.finding.arguments = std::move(arguments);
  items_.push_back(std::move(item));
}

void Report::error(const Location& at, const text::Entry& entry, std::vector<std::string> arguments) {
  ++errors_;
  add(text::Severity::error, at, entry, std::move(arguments));
}

void Report::warning(const Location& at, const text::Entry& entry, std::vector<std::string> arguments) {
  if (warnings_ && at.file != hidden_) add(text::Severity::warning, at, entry, std::move(arguments));
}

std::vector<text::Finding> Report::take() {
  std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
    return std::tie(a.at.file, a.at.line, a.at.column) < std::tie(b.at.file, b.at.line, b.at.column);
  });
  std::vector<text::Finding> out;
  for (Item& i : items_) out.push_back(std::move(i.finding));
  items_.clear();
  const text::Entry* const more[] = {&texts::kMoreErrors, &texts::kMoreWarnings};
  for (const std::size_t kind : {0, 1}) {
    if (left_out_[kind] == 0) continue;
    text::Finding f;
    f.severity = kind == 0 ? text::Severity::error : text::Severity::warning;
    if (!files_.empty()) f.file = files_.front();
    f.entry = more[kind];
    f.arguments = {std::to_string(left_out_[kind]), std::to_string(kMost)};
    out.push_back(std::move(f));
  }
  return out;
}

namespace {
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}
}  // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string key = key_of(name);
  if (key.size() > 64) return {};
  std::size_t best = std::min<std::size_t>(key.size(), key.size() < 4 ? 2 : key.size() < 8 ? 3 : 4);
  const std::string* found = nullptr;
  for (const std::string& c : candidates) {
    if (c.size() > 64 || c.size() + best <= key.size() || key.size() + best <= c.size()) continue;
    const std::size_t d = distance(key, key_of(c));
    if (d < best) best = d, found = &c;
  }
  return found == nullptr ? std::string() : "; '" + *found + "'?";
}

std::string cropped(std::string_view source) {
  constexpr std::size_t kShown = 60;
  if (source.size() <= kShown) return std::string(source);
  std::size_t end = kShown;
  while (end > 0 && (static_cast<unsigned char>(source[end]) & 0xC0) == 0x80) --end;
  return std::string(source.substr(0, end)) + "...";
}

}  // namespace servogate::plc::syntax
