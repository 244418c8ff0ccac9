// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/scenario/shrink.hpp"

#include <algorithm>

#include "firmware_if/text/finding.hpp"
#include "machine/keys/document.hpp"

namespace servogate::gateway::command {

namespace {

using scenario::Scenario;
using scenario::Step;

constexpr int kMostRuns = 400;

/// Without the drawn steps `from` to `to` (counted among the drawn); the next one begins so much later.
Scenario without(const Scenario& s, std::size_t from, std::size_t to) {
  Scenario out = s;
  out.steps.clear();
  std::size_t n = 0;
  image::Nanoseconds skipped = 0;
  for (const Step& step : s.steps) {
    if (!step.drawn) {
      out.steps.push_back(step);
    } else if (n >= from && n < to) {
      skipped += step.time;
      ++n;
    } else {
      out.steps.push_back(step);
      out.steps.back().time += std::exchange(skipped, 0);
      ++n;
    }
  }
  return out;
}

std::size_t drawn(const Scenario& s) {
  return static_cast<std::size_t>(
      std::count_if(s.steps.begin(), s.steps.end(), [](const Step& step) { return step.drawn; }));
}

std::string deed_of(const Step& step) {
  if (const auto* what = std::get_if<scenario::Do>(&step.what))
    return "do = " + machine::quoted(what->command ? std::string("...") : what->words);
  if (const auto* inject = std::get_if<scenario::Inject>(&step.what))
    return "fault = {device = " + machine::quoted(inject->device) +
           ", kind = " + machine::quoted(fault::name_of(inject->fault.kind)) +
           (inject->fault.duration_ns > 0
                ? ", for = \"" + text::number(static_cast<double>(inject->fault.duration_ns) * 1e-6, 3) +
                      " ms\""
                : "") +
           "}";
  if (const auto* clear = std::get_if<scenario::Clear>(&step.what))
    return "clear = {device = " + machine::quoted(clear->device) + "}";
  return {};
}

}  // namespace

Scenario shrink(const Scenario& failing, const std::function<bool(const Scenario&)>& fails) {
  Scenario smallest = failing;
  int runs = 0;
  for (std::size_t size = std::max<std::size_t>(1, drawn(smallest) / 2);;
       size = std::max<std::size_t>(1, size / 2)) {
    bool less = false;
    for (std::size_t from = 0; from < drawn(smallest) && runs < kMostRuns;) {
      Scenario tried = without(smallest, from, from + size);
      ++runs;
      if (fails(tried)) {
        smallest = std::move(tried);
        less = true;
      } else {
        from += size;
      }
    }
    if (runs >= kMostRuns || (size == 1 && !less)) return smallest;
  }
}

std::string drawn_steps(const Scenario& s) {
  std::string out;
  for (const Step& step : s.steps) {
    if (!step.drawn) continue;
    out += "[[step]]\nafter = \"" + text::number(static_cast<double>(step.time) * 1e-6, 3) + " ms\"\n" +
           deed_of(step) + "\n";
  }
  return out;
}

}  // namespace servogate::gateway::command
