// SPDX-License-Identifier: Apache-2.0
#include "report/html.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/markup.hpp"
#include "firmware_if/text/system_words.hpp"
#include "report/page/page_files.hpp"
#include "report/record/column.hpp"
#include "report/report_json.hpp"

namespace servogate::report {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kPageSchema = 2;  ///< of the data in a page, which another page may be laid over
constexpr std::size_t kMaxListing = 200'000;
constexpr double kPathQuantum = 1e-5;  ///< mm
/// A browser refuses whatever would come from elsewhere.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";

std::string base64(std::string_view data) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(data[i])}; };
  std::string out;
  out.reserve((data.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < data.size(); i += 3) {
    const std::size_t rest = std::min<std::size_t>(data.size() - i, 3);
    const std::uint32_t v = byte(i) << 16 | (rest > 1 ? byte(i + 1) << 8 : 0) | (rest > 2 ? byte(i + 2) : 0);
    out += kDigits[v >> 18];
    out += kDigits[v >> 12 & 63];
    out += rest > 1 ? kDigits[v >> 6 & 63] : '=';
    out += rest > 2 ? kDigits[v & 63] : '=';
  }
  return out;
}

Json to_json(const Column& c) {
  return {{"n", c.count}, {"q", c.quantum}, {"o", c.order}, {"d", base64(c.bytes)}};
}

template <typename Values>
Json column(const Values& values, double quantum, int order = 1) {
  return to_json(pack(std::vector<double>(values.begin(), values.end()), quantum, order));
}

/// Finer than a screen shows, in about three bytes a value.
double quantum_of(const Series& s) {
  float most = 0;
  for (const auto* edge : {&s.low, &s.high})
    for (const float v : *edge) most = std::max(most, std::fabs(v));
  return most > 0 ? std::ldexp(double{most}, -20) : 1.0;
}

Json series_json(const RecordedRun& run) {
  Json out = Json::array();
  for (const Series& s : run.series) {
    const double quantum = quantum_of(s);
    Json one{{"name", s.name}, {"unit", s.unit}, {"low", column(s.low, quantum)}};
    if (s.high != s.low) one["high"] = column(s.high, quantum);
    out.push_back(std::move(one));
  }
  return out;
}

Json path_json(const PathLine& path, double moment_s) {
  return {{"x", column(path.x, kPathQuantum)}, {"y", column(path.y, kPathQuantum)},
          {"z", column(path.z, kPathQuantum)}, {"t", column(path.t, moment_s)},
          {"speed", column(path.speed, 1e-3)}, {"deviation", column(path.deviation, 1e-6)},
          {"line", column(path.line, 1)},      {"tool", column(path.tool, 1)},
          {"rapid", column(path.rapid, 1)}};
}

Json every_json(const RecordedRun& run) {
  Json out{{"channels", Json::array()}, {"stretches", Json::array()}};
  for (const Channel& c : run.channels) out["channels"].push_back(c.name);
  for (const CycleStretch& s : run.stretches) {
    Json columns = Json::array();
    for (const Column& c : s.columns) columns.push_back(to_json(c));
    out["stretches"].push_back(
        {{"first", s.first - run.first_cycle}, {"lead", s.lead}, {"columns", std::move(columns)}});
  }
  return out;
}

Json lines_json(const RecordedRun& run) {
  std::vector<double> number, first, total;
  for (const auto& [line, time] : run.line_times) {
    number.push_back(line);
    first.push_back(time.first_s);
    total.push_back(time.total_s);
  }
  return {{"number", column(number, 1)}, {"first", column(first, 1e-5)}, {"total", column(total, 1e-5)}};
}

/// Of each axis [offset, share of each axis ...], or null.
Json frames_json(const RecordedRun& run) {
  Json out = Json::array();
  for (const FrameChange& f : run.frames) {
    Json axes = Json::array();
    for (const std::optional<WorkAxis>& a : f.axes) {
      Json map;
      if (a) map.push_back(a->offset);
      for (std::size_t n = 0; a && n < run.axes.size(); ++n) map.push_back(a->share[n]);
      axes.push_back(std::move(map));
    }
    out.push_back({{"t", f.t_s}, {"axes", std::move(axes)}});
  }
  return out;
}

Json run_json(const RecordedRun& run) {
  const double moment_s = run.period_s / 8;  // times are those of cycles
  Json out;
  out["period"] = run.period_s;
  out["start"] = run.start_s;
  out["duration"] = run.duration_s;
  out["bucket"] = run.bucket_s;
  out["tolerance"] = run.path_tolerance;
  out["axes"] = run.axes;
  out["view"] = Json::array();
  for (const int axis : run.view_axes)
    out["view"].push_back(axis < 0 || axis >= static_cast<int>(run.axes.size())
                              ? std::string()
                              : run.axes[static_cast<std::size_t>(axis)]);
  out["series"] = series_json(run);
  out["every"] = every_json(run);
  out["line"] = column(run.line, 1);
  out["path"] = path_json(run.path, moment_s);
  out["signals"] = Json::array();
  for (const SignalTrack& s : run.signals)
    out["signals"].push_back({{"name", s.name},
                              {"initial", s.initial},
                              {"toggles", column(s.toggles, moment_s)},
                              {"truncated", s.truncated_s}});
  out["lines"] = lines_json(run);
  out["frames"] = frames_json(run);
  return out;
}

std::string valid_utf8(const std::string& text) {
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

/// The first kMaxListing lines.
std::string listing(std::string_view text) {
  std::size_t end = 0;
  for (std::size_t n = 0; n < kMaxListing && end < text.size(); ++n)
    end = std::min(text.find('\n', end), text.size() - 1) + 1;
  return valid_utf8(std::string(text.substr(0, end))) + (end < text.size() ? "…" : "");
}

/// JSON that cannot end the script element around it: `<` occurs in strings only.
std::string embedded(const Json& data) {
  std::string out;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace))
    c == '<' ? out += "\\u003c" : out += c;
  return out;
}

}  // namespace

std::string to_html(const Report& report, const RecordedRun& run, const HtmlOptions& options) {
  const std::string language = options.language == text::Language::russian ? "ru" : "en";
  Json data;
  data["schema"] = kPageSchema;
  data["title"] = options.title;
  data["language"] = language;
  data["program"] = {{"name", options.program_name},
                     {"text", base64(deflated(listing(options.program_text)))}};
  data["report"] = {{"en", json_of(report, text::Language::english)},
                    {"ru", json_of(report, text::Language::russian)}};
  data["run"] = run_json(run);
  const std::string title = text::escaped(valid_utf8(options.title.empty() ? "servogate" : options.title));
  std::string out = "<!DOCTYPE html>\n<html lang=\"" + language + "\"><head><meta charset=\"utf-8\">" +
                    "<meta http-equiv=\"Content-Security-Policy\" content=\"" + kPolicy + "\">" +
                    "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">" +
                    "<meta name=\"generator\" content=\"servogate\">\n<title>" + title +
                    "</title>\n<style>\n";
  out += kPageStyle;
  out += "</style></head>\n<body>\n";
  std::string body(kPageBody);
  const auto put = [&](std::string_view before, const std::string& text) {
    const std::size_t at = body.find(before);
    body.insert(at + before.size(), text);
  };
  put("id=\"title\">", title);
  put("id=\"program-name\">", text::escaped(valid_utf8(options.program_name)));
  put("id=\"notices\">", text::escaped(kPageNotices));
  out += body;
  out += "<script type=\"application/json\" id=\"data\">" + embedded(data) +
         "</script>\n<script id=\"libraries\">\n";
  out += kPageLibraries;
  out += "</script>\n<script id=\"page\">\n\"use strict\";(async () => {\n";
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
