// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/planner.hpp"

#include "kernel/path/law/planning.hpp"
#include "kernel/path/shape/contour.hpp"
#include "kernel/path/track/publisher.hpp"

namespace servogate::path {

/// Shape, bound, law and track, one behind the other.
struct Planner::Impl final : ContourSink {
  Impl(const Config& c, Track& track)
      : config(c), publisher(track), law(c, track.pieces.capacity(), publisher), contour(c, *this) {}

  void put(const Piece& piece, const Pace& pace) override { law.append(piece, bound(config, piece, pace)); }
  void rest(bool confirm) override { law.rest(confirm); }

  void mark(Entry::Kind kind, std::uint32_t event, const Tag& tag) {
    Entry entry;
    entry.kind = kind;
    entry.event = event;
    entry.tag = tag;
    entry.tag.marks = marks;
    entry.at = contour.position();
    entry.span.number = law.last_number();
    entry.span.first_piece = publisher.next().piece;
    publisher.put(entry);
  }

  Config config;
  Publisher publisher;
  Planning law;
  Contour contour;
  std::uint32_t marks = 0;
};

Planner::Planner(const Config& config, Track& track) : impl_(std::make_unique<Impl>(config, track)) {}
Planner::~Planner() = default;

Track::Begin Planner::restart(const Vector& at) {
  Impl& p = *impl_;
  const Track::Begin begin = p.publisher.next();
  p.contour.restart(at);
  p.law.restart();
  p.mark(Entry::Kind::restart, 0, {});
  return begin;
}

bool Planner::add(const Element& element) {
  Element marked = element;
  marked.tag.marks = impl_->marks;
  return impl_->contour.add(marked);
}

Flaw Planner::last_flaw() const { return impl_->contour.last_flaw(); }

void Planner::add_mark() { ++impl_->marks; }

void Planner::add_event(std::uint32_t id, const Tag& tag) {
  impl_->contour.finish();
  impl_->mark(Entry::Kind::event, id, tag);
}

void Planner::finish() {
  impl_->contour.finish();
  impl_->mark(Entry::Kind::finish, 0, {});
}

bool Planner::wants_more() const { return impl_->publisher.wants_more(); }
void Planner::work() { impl_->publisher.work(); }
const Vector& Planner::position() const { return impl_->contour.position(); }

}  // namespace servogate::path
