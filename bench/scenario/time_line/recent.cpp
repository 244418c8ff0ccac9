// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/time_line/recent.hpp"

#include <algorithm>

namespace servogate::scenario {

namespace {

constexpr std::size_t kMostSignals = 14;
constexpr std::size_t kRing = 1024;
constexpr image::Nanoseconds kSpan = 50 * image::kMillisecond;
constexpr const char* kBars[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

}  // namespace

Recent::Recent(std::vector<Signal> signals) : signals_(std::move(signals)) {
  if (signals_.size() > kMostSignals) signals_.resize(kMostSignals);
  rows_.assign(kRing, std::vector<double>(signals_.size()));
  times_.assign(kRing, 0);
}

void Recent::add(const View& view) {
  for (std::size_t s = 0; s < signals_.size(); ++s) rows_[next_][s] = signals_[s].read(view);
  times_[next_] = view.image.now.t_ns;
  next_ = (next_ + 1) % kRing;
  count_ = std::min(count_ + 1, kRing);
}

std::string Recent::diagram(image::Nanoseconds began) const {
  if (count_ < 2 || signals_.empty()) return {};
  const auto at = [&](std::size_t back) { return (next_ + kRing - 1 - back) % kRing; };
  std::size_t span = 1;
  while (span + 1 < count_ && times_[at(0)] - times_[at(span)] < kSpan) ++span;
  const std::size_t columns = std::min(kColumns, span + 1);
  const auto row_of = [&](std::size_t column) {
    return at(span - column * span / std::max<std::size_t>(1, columns - 1));
  };
  std::size_t width = 0;
  for (const Signal& s : signals_)
    width = std::max(width, s.name.size() + s.unit.size() + (s.unit.empty() ? 0 : 3));
  const auto seconds = [&](std::size_t row) {
    return text::number(static_cast<double>(times_[row] - began) * 1e-9, 3) + " s";
  };
  const std::string from = seconds(at(span)), to = seconds(at(0));
  std::string out = padded("", width + 2) + padded(from, columns - std::min(columns, to.size())) + to + "\n";
  for (std::size_t s = 0; s < signals_.size(); ++s) {
    const Signal& signal = signals_[s];
    double low = rows_[row_of(0)][s], high = low;
    for (std::size_t c = 0; c < columns; ++c) {
      low = std::min(low, rows_[row_of(c)][s]);
      high = std::max(high, rows_[row_of(c)][s]);
    }
    out += padded(signal.name + (signal.unit.empty() ? "" : " [" + std::string(signal.unit) + "]"), width) +
           "  ";
    for (std::size_t c = 0; c < columns; ++c) {
      const double value = rows_[row_of(c)][s];
      if (signal.digital)
        out += value != 0.0 ? "▔" : "▁";
      else
        out += kBars[high > low ? static_cast<std::size_t>((value - low) / (high - low) * 7.0 + 0.5) : 0];
    }
    const std::string last = words_of(rows_[at(0)][s], signal);
    out += signal.digital || high == low
               ? "  " + last
               : "  " + words_of(low, signal) + " … " + words_of(high, signal) + ", " + last;
    out += "\n";
  }
  return out;
}

}  // namespace servogate::scenario
