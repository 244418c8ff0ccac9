// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/smoothing.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr std::size_t kMostLines = 32;    // spanned by one quintic
constexpr std::size_t kAhead = 64;        // lines that must be known behind a node before it is decided
constexpr std::size_t kBehind = 64;       // lines that are kept before a node for the averages
constexpr double kNodeShare = 0.35;       // of the tolerance: distance of a node to the programmed path
constexpr int kSamples = 20;              // along a quintic
constexpr double kSamplingMargin = 1.02;  // between them and the corners
constexpr double kSharpest = 0.5176;      // |difference of unit tangents| at 30 degrees

double apart(const Vector& a, const Vector& b, int axes) {
  double sum = 0.0;
  for (int i = 0; i < axes; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

PathPoint middle(const Piece& line, int axes) { return evaluate(line, 0.5 * line.length, axes); }

}  // namespace

Piece quintic(const PathPoint& a, const PathPoint& b, double length, int axes) {
  Piece p;
  p.shape = Piece::Shape::blend;
  p.length = p.full = length;
  for (int i = 0; i < axes; ++i) {
    const double d = b.x[i] - a.x[i], v0 = a.d1[i] * length, v1 = b.d1[i] * length;
    const double w0 = a.d2[i] * length * length, w1 = b.d2[i] * length * length;
    p.c0[i] = a.x[i];
    p.c1[i] = v0;
    p.c2[i] = 0.5 * w0;
    p.c3[i] = 10 * d - 6 * v0 - 4 * v1 - 1.5 * w0 + 0.5 * w1;
    p.c4[i] = -15 * d + 8 * v0 + 7 * v1 + 1.5 * w0 - w1;
    p.c5[i] = 6 * d - 3 * v0 - 3 * v1 - 0.5 * w0 + 0.5 * w1;
  }
  return p;
}

bool Smoothing::suits(const Piece& before, const Piece& after, double tolerance, int axes) {
  if (before.shape != Piece::Shape::line || after.shape != Piece::Shape::line) return false;
  const double nb = norm(before.c1, axes), na = norm(after.c1, axes);
  double turned = 0.0;
  for (int i = 0; i < axes; ++i) turned += std::pow(before.c1[i] / nb - after.c1[i] / na, 2);
  if (turned > kSharpest * kSharpest) return false;
  const double half = 0.5 * std::max(before.length, after.length);
  if (0.1875 * half * apart(before.c1, after.c1, axes) > tolerance) return false;
  Smoothing pair(axes);
  pair.begin(before, tolerance);
  pair.append(after);
  const Piece p =
      quintic(middle(before, axes), middle(after, axes), 0.5 * (before.length + after.length), axes);
  return pair.fits(p, 0, 1);
}

void Smoothing::begin(const Piece& line, double tolerance) {
  lines_.clear();
  forgotten_ = 0;
  stride_ = 4;
  tolerance_ = tolerance;
  lines_.push_back({line, 0.0});
  node_ = {0, middle(line, axes_)};
}

void Smoothing::append(const Piece& line) {
  lines_.push_back({line, lines_.back().start + lines_.back().piece.length});
}

Vector Smoothing::programmed(std::size_t k, double s) const {
  const Line& line = lines_[k];
  Vector x{};
  for (int i = 0; i < axes_; ++i) x[i] = line.piece.c0[i] + line.piece.c1[i] * (s - line.start);
  return x;
}

/// The average of the programmed path around the middle of a line, with its derivatives: the path's second
/// derivative is a sum of impulses at the corners, so each corner adds the kernel and its integrals.
PathPoint Smoothing::average(std::size_t k, double width) const {
  const double s = lines_[k].middle();
  if (!(width > 0.0)) return middle(lines_[k].piece, axes_);
  std::size_t a = k;
  while (a > 0 && lines_[a].start > s - width) --a;
  PathPoint out;
  out.x = programmed(a, s);
  out.d1 = lines_[a].piece.c1;
  for (std::size_t c = a + 1; c < lines_.size() && lines_[c].start < s + width; ++c) {
    const double t = std::clamp((s - lines_[c].start) / width, -1.0, 1.0), t2 = t * t;
    const double kernel = 0.9375 * (1 - t2) * (1 - t2);
    const double once = 0.5 + 0.9375 * t * (1 - t2 * (2.0 / 3.0 - 0.2 * t2));
    const double twice = 0.15625 + 0.5 * t + 0.9375 * t2 * (0.5 - t2 * (1.0 / 6.0 - t2 / 30.0));
    for (int i = 0; i < axes_; ++i) {
      const double bend = lines_[c].piece.c1[i] - lines_[c - 1].piece.c1[i];
      out.x[i] += bend * width * twice;
      out.d1[i] += bend * once;
      out.d2[i] += bend * kernel / width;
    }
  }
  return out;
}

bool Smoothing::near(const Piece& piece, std::size_t line, double begin, double s) const {
  return apart(position(piece, s, axes_), programmed(line, begin + s), axes_) * kSamplingMargin <= tolerance_;
}

/// Both are run through at equal parameters: an upper bound of the Fréchet distance. Looks at every corner,
/// and at even steps along the quintic.
bool Smoothing::fits(const Piece& piece, std::size_t from, std::size_t to) const {
  const double begin = lines_[from].middle();
  for (std::size_t k = from + 1; k <= to; ++k)
    if (!near(piece, k, begin, lines_[k].start - begin)) return false;
  std::size_t k = from;
  for (int n = 1; n < kSamples; ++n) {
    const double s = piece.length * n / kSamples;
    while (k < to && lines_[k + 1].start <= begin + s) ++k;
    if (!near(piece, k, begin, s)) return false;
  }
  return true;
}

bool Smoothing::reach(std::size_t to, bool end, Node& found, Piece& piece) const {
  const std::size_t from = node_.line, last = lines_.size() - 1;
  const double begin = lines_[from].middle(), at = lines_[to].middle(), length = at - begin;
  const double room = std::min(lines_[last].middle() - at, at - lines_[0].middle());
  const Vector there = programmed(to, at);
  for (const double share : {1.0, 0.5, 0.25, 0.0}) {
    const double width = std::min(share * length, room);
    found = {to, average(to, width)};
    if (apart(found.point.x, there, axes_) > kNodeShare * tolerance_) continue;
    piece = quintic(node_.point, found.point, length, axes_);
    if (!fits(piece, from, to)) continue;
    if (to == last) return end;
    // From here the next line alone must be within reach, so that there is always a way on.
    const double next = lines_[to + 1].middle() - at;
    if (fits(quintic(found.point, middle(lines_[to + 1].piece, axes_), next, axes_), to, to + 1)) return true;
  }
  return false;
}

void Smoothing::slice(const Piece& whole, std::size_t from, std::size_t to, std::vector<Slice>& out) const {
  const double begin = lines_[from].middle();
  for (std::size_t k = from; k <= to; ++k) {
    const Line& line = lines_[k];
    const double a = std::max(0.0, line.start - begin);
    const double b = k == to ? whole.length : line.start + line.piece.length - begin;
    Piece p = part(whole, a, b - a);
    p.rest = line.start + line.piece.length - begin - b;
    p.tag = line.piece.tag;
    p.target = line.piece.target;
    out.push_back({p, forgotten_ + k});
  }
}

void Smoothing::take(bool end, std::vector<Slice>& out) {
  while (node_.line + 1 < lines_.size() && (end || lines_.size() - node_.line > kAhead + kMostLines)) {
    const std::size_t most = std::min(kMostLines, lines_.size() - 1 - node_.line);
    Node found;
    Piece piece;
    std::size_t stride = std::min(2 * stride_, most);
    while (stride > 1 && !reach(node_.line + stride, end, found, piece))
      stride = std::max<std::size_t>(1, stride * 2 / 3);
    if (stride == 1 && !reach(node_.line + 1, end, found, piece)) {
      // Never further than was made sure of when this node was taken.
      found = {node_.line + 1, middle(lines_[node_.line + 1].piece, axes_)};
      piece =
          quintic(node_.point, found.point, lines_[found.line].middle() - lines_[node_.line].middle(), axes_);
    }
    slice(piece, node_.line, found.line, out);
    node_ = found;
    stride_ = stride;
  }
  if (end) {
    lines_.clear();
  } else {
    forget();
  }
}

void Smoothing::forget() {
  if (node_.line < 4 * kBehind) return;
  const std::size_t gone = node_.line - kBehind;
  lines_.erase(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(gone));
  node_.line -= gone;
  forgotten_ += gone;
}

}  // namespace servogate::path
