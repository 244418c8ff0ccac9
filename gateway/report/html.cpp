// SPDX-License-Identifier: Apache-2.0
#include "gateway/report/html.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/report/page/page_files.hpp"
#include "gateway/report/report_json.hpp"

namespace servogate::report {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t kMaxListing = 20'000;
constexpr std::size_t kSeriesBudget = 3'000'000;  ///< bytes of base64 for all series

std::string base64(const unsigned char* data, std::size_t size) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t rest = std::min<std::size_t>(size - i, 3);
    std::uint32_t v = static_cast<std::uint32_t>(data[i]) << 16;
    if (rest > 1) v |= static_cast<std::uint32_t>(data[i + 1]) << 8;
    if (rest > 2) v |= data[i + 2];
    out += kDigits[v >> 18];
    out += kDigits[v >> 12 & 63];
    out += rest > 1 ? kDigits[v >> 6 & 63] : '=';
    out += rest > 2 ? kDigits[v & 63] : '=';
  }
  return out;
}

/// Little-endian 32-bit values as base64, whatever this computer's own order is.
template <typename T>
std::string packed(const std::vector<T>& values) {
  static_assert(sizeof(T) == 4);
  std::vector<unsigned char> bytes;
  bytes.reserve(4 * values.size());
  for (const T v : values) {
    const auto bits = std::bit_cast<std::uint32_t>(v);
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<unsigned char>(bits >> shift));
  }
  return base64(bytes.data(), bytes.size());
}

/// Merges `factor` neighbouring buckets into one.
template <typename T, typename Pick>
std::vector<T> merged(const std::vector<T>& in, std::size_t factor, Pick pick) {
  if (factor == 1) return in;
  std::vector<T> out;
  for (std::size_t n = 0; n < in.size(); n += factor) {
    T v = in[n];
    for (std::size_t k = n + 1; k < std::min(n + factor, in.size()); ++k) v = pick(v, in[k]);
    out.push_back(v);
  }
  return out;
}

std::size_t merge_factor(const RecordedRun& run) {
  std::size_t bytes = run.line.size() * 16 / 3;
  for (const Series& s : run.series) bytes += (s.low == s.high ? 1 : 2) * s.low.size() * 16 / 3;
  std::size_t factor = 1;
  // Merged buckets have two edges, so a run of single values first doubles before it shrinks.
  while (bytes / factor * (factor > 1 ? 2 : 1) > kSeriesBudget) ++factor;
  return factor;
}

Json series_json(const RecordedRun& run, std::size_t factor) {
  Json out = Json::array();
  for (const Series& s : run.series) {
    const auto low = merged(s.low, factor, [](float a, float b) { return std::min(a, b); });
    const auto high = merged(s.high, factor, [](float a, float b) { return std::max(a, b); });
    Json one{{"name", s.name}, {"unit", s.unit}, {"low", packed(low)}};
    if (high != low) one["high"] = packed(high);
    out.push_back(std::move(one));
  }
  return out;
}

Json path_json(const PathLine& path) {
  return {{"x", packed(path.x)},
          {"y", packed(path.y)},
          {"z", packed(path.z)},
          {"t", packed(path.t)},
          {"speed", packed(path.speed)},
          {"line", packed(path.line)},
          {"rapid", base64(path.rapid.data(), path.rapid.size())}};
}

Json run_json(const RecordedRun& run) {
  const std::size_t factor = merge_factor(run);
  Json out;
  out["period"] = run.period_s;
  out["start"] = run.start_s;
  out["duration"] = run.duration_s;
  out["bucket"] = run.bucket_s * static_cast<double>(factor);
  out["tolerance"] = run.path_tolerance;
  out["axes"] = run.axes;
  out["view"] = Json::array();
  for (const int axis : run.view_axes)
    out["view"].push_back(axis < 0 || axis >= static_cast<int>(run.axes.size())
                              ? std::string()
                              : run.axes[static_cast<std::size_t>(axis)]);
  out["series"] = series_json(run, factor);
  out["line"] = packed(merged(run.line, factor, [](std::int32_t, std::int32_t later) { return later; }));
  out["path"] = path_json(run.path);
  out["signals"] = Json::array();
  for (const SignalTrack& s : run.signals)
    out["signals"].push_back({{"name", s.name},
                              {"initial", s.initial},
                              {"toggles", packed(s.toggles)},
                              {"truncated", s.truncated_s}});
  out["lines"] = Json::array();
  for (const auto& [line, time] : run.line_times) out["lines"].push_back({line, time.first_s, time.total_s});
  return out;
}

Json listing(std::string_view text) {
  Json out = Json::array();
  while (!text.empty() && out.size() < kMaxListing) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    out.push_back(std::string(line));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!text.empty()) out.push_back("…");
  return out;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// JSON that cannot end the script element around it: `<` occurs in strings only.
std::string embedded(const Json& data) {
  std::string out;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace))
    c == '<' ? out += "\\u003c" : out += c;
  return out;
}

std::string valid_utf8(const std::string& text) {
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

constexpr std::string_view kBody = R"html(
<header><div class="in"><h1 id="title"></h1><span id="state" class="badge"></span><span class="grow"></span>
<span class="noprint"><button data-lang="en">EN</button> <button data-lang="ru">RU</button> <button id="theme" data-t="theme"></button></span><span class="sub" id="sub"></span></div></header>
<main>
<noscript><section>This page draws its data with JavaScript. Для показа данных нужен JavaScript.</section></noscript>
<p class="verdict" id="verdict"></p>
<div class="table" id="findings"></div>
<div class="cards" id="cards"></div>
<p class="warn" id="forced"></p>
<p class="warn" id="dropped"></p>
<section><div class="head"><h2 data-t="limits"></h2></div><div class="axes" id="axes"></div></section>
<section id="path-section"><div class="head"><h2 data-t="path"></h2><span class="grow"></span><label class="noprint"><input type="checkbox" id="rapids" checked><span data-t="rapids"></span></label>
<label class="noprint"><input type="checkbox" id="whole-path"><span data-t="wholePath"></span></label>
<span class="speed-key" id="speed-key"></span></div>
<div class="views"><div class="pane"><div class="head"><h3 data-t="plan"></h3><span class="grow"></span><button class="noprint" id="fit-plan" data-t="fit"></button></div>
<div class="view" id="plan" tabindex="0"></div><p class="hint" data-t="hintPlan"></p></div>
<div class="pane"><div class="head"><h3 data-t="view3"></h3><span class="grow"></span><button class="noprint" id="top-space" data-t="top"></button><button class="noprint" id="fit-space" data-t="iso"></button></div>
<div class="view" id="space" tabindex="0"></div><p class="hint" data-t="hint3"></p></div></div>
<p class="extents" id="extents"></p><div class="split" id="split"></div><div class="keys" id="split-key"></div></section>
<section id="motion-section"><div class="head"><h2 data-t="motion"></h2><span id="axis-switches"></span><span class="grow"></span><button class="noprint" id="whole" data-t="all"></button></div>
<div id="charts"></div><p class="hint" data-t="hintTime"></p></section>
<section id="signal-section"><div class="head"><h2 data-t="signals"></h2><span class="grow"></span><label class="noprint"><input type="checkbox" id="constant"><span data-t="constant"></span></label></div>
<p class="quiet" id="no-signals" data-t="noSignals"></p><div id="signals"></div><div id="lanes" tabindex="0"></div><p class="steady" id="steady"></p></section>
<section id="alarm-section"><div class="head"><h2 data-t="alarms"></h2></div><div class="table" id="alarms"></div></section>
<section><div class="head"><h2 data-t="timing"></h2></div><div class="timing" id="timing"></div></section>
<section id="program"><div class="head"><h2 data-t="program"></h2><span class="note" id="program-name"></span><span class="grow"></span><label class="noprint"><input type="checkbox" id="follow" checked><span data-t="follow"></span></label></div>
<div class="listing" id="listing"></div></section>
<section><div class="head"><h2 data-t="provenance"></h2></div><div class="table" id="provenance"></div></section>
</main>
<footer class="transport" id="transport"><button id="play">▶</button><select id="pace"><option value="0.1">0.1×</option><option value="1" selected>1×</option><option value="5">5×</option><option value="20">20×</option></select>
<input type="range" id="slider"><span id="now"></span><span id="readout"></span></footer>
)html";

}  // namespace

std::string to_html(const Report& report, const RecordedRun& run, const HtmlOptions& options) {
  Json data;
  data["title"] = options.title;
  data["language"] = options.language == text::Language::russian ? "ru" : "en";
  data["program"] = {{"name", options.program_name}, {"lines", listing(options.program_text)}};
  data["report"] = json_of(report);
  data["run"] = run_json(run);
  const std::string title = escaped(valid_utf8(options.title.empty() ? "servogate" : options.title));
  const std::string language = options.language == text::Language::russian ? "ru" : "en";
  std::string out = "<!DOCTYPE html>\n<html lang=\"" + language + "\"><head><meta charset=\"utf-8\">" +
                    "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">" +
                    "<meta name=\"generator\" content=\"servogate\">\n<title>" + title +
                    "</title>\n<style>\n";
  out += kPageStyle;
  out += "</style></head>\n<body>";
  std::string body(kBody);
  const auto put = [&](std::string_view before, const std::string& text) {
    const std::size_t at = body.find(before);
    body.insert(at + before.size(), text);
  };
  put("id=\"title\">", title);
  put("id=\"program-name\">", escaped(valid_utf8(options.program_name)));
  out += body;
  out += "<script type=\"application/json\" id=\"data\">" + embedded(data) +
         "</script>\n<script>\n\"use strict\";(() => {\n";
  out += kPageScript;
  out += "})();\n</script>\n</body></html>\n";
  return out;
}

namespace {

/// Where links lead, to a file that may be still to come. A pipe behind /dev/stdout has no path of its own.
std::string behind_links(const std::string& path) {
  static constexpr int kMostLinks = 40;  // as Linux follows in one path
  std::error_code error;
  std::filesystem::path at = path;
  if (std::filesystem::exists(at, error)) {
    const std::filesystem::path whole = std::filesystem::canonical(at, error);
    return error ? path : whole.string();
  }
  for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(at, error); ++i)
    at = at.parent_path() / std::filesystem::read_symlink(at, error);
  return at.string();
}

}  // namespace

std::string write_file(const std::string& path, const std::string& content) {
  std::error_code error;
  // A link leads to the file that is meant; a device or a pipe is written to and never replaced.
  const std::string target = behind_links(path);
  const bool special =
      std::filesystem::exists(target, error) && !std::filesystem::is_regular_file(target, error);
  const std::string neighbour = special ? target : target + ".part";
  const auto failed = [&](const std::string& what) {
    const std::string text = path + ": " + what + ": " + text::words_of(errno);
    if (!special) std::remove(neighbour.c_str());
    return text;
  };
  std::FILE* file = std::fopen(neighbour.c_str(), "wb");
  if (file == nullptr) return failed(text::both("cannot create", "не создаётся"));
  const bool written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  if (std::fclose(file) != 0 || !written) return failed(text::both("cannot write", "не записывается"));
  if (!special && std::rename(neighbour.c_str(), target.c_str()) != 0)
    return failed(text::both("cannot rename", "не переименовывается"));
  return {};
}

}  // namespace servogate::report
