// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/for_cycle.hpp"

#include <algorithm>

namespace servogate::channel {
namespace {

class Translation {
 public:
  using Result = std::optional<ForCycle>;
  Translation(PathElements& elements, ProgramTexts& texts, image::Packets& view)
      : elements_(elements), texts_(texts), view_(view) {}

  template <class Motion>
  Result operator()(const Motion&) const {
    return std::nullopt;
  }
  Result operator()(const program::Dwell& d) const {
    elements_.rested(d.seconds);
    ForCycle order{EventKind::dwell, {}};
    order.event.value = d.seconds;
    return order;
  }
  Result operator()(const program::Spindle& s) const {
    elements_.take(s);
    ForCycle order{EventKind::spindle, {}};
    order.event.value = s.speed;
    order.event.limit = s.limit_rpm;
    order.event.center = s.center;
    order.event.number = s.number;
    order.event.mode = s.mode;
    order.event.flag = s.surface_speed;
    if (s.mode == program::SpindleMode::turn) order.event.angle = s.turn_deg;
    return order;
  }
  Result operator()(const program::FeedOverride& o) const {
    ForCycle order{EventKind::feed_override, {}};
    order.event.flag = o.effective;
    return order;
  }
  Result operator()(const program::SpindleCoupling& s) const {
    ForCycle order = coded(EventKind::spindle_coupling, s.leader);
    order.event.code2 = s.follower;
    order.event.angle = s.phase_deg;
    order.event.flag = s.on;
    order.event.number = 1;
    return order;
  }
  Result operator()(const program::SpindleAxis& s) const {
    ForCycle order{EventKind::spindle_axis, {}};
    order.event.flag = s.on;
    return order;
  }
  Result operator()(const program::SpindleMark&) const { return ForCycle{EventKind::spindle_mark, {}}; }
  Result operator()(const program::Tool& t) const {
    if (t.activate) return std::nullopt;
    ForCycle order = coded(EventKind::tool, t.number);
    order.event.code2 = t.corrector;
    return order;
  }
  Result operator()(const program::MFunction& m) const { return coded(EventKind::m_function, m.code); }
  Result operator()(const program::HFunction& h) const { return coded(EventKind::h_function, h.code); }
  Result operator()(const program::Message& m) const {
    return coded(EventKind::message, texts_.add_message(m.text));
  }
  Result operator()(const program::WritePlace& w) const {
    ForCycle order{EventKind::write, {}, !w.synchronous};
    Event& e = order.event;
    e.place = w.place;
    e.value = w.value;
    e.length = static_cast<std::uint8_t>(std::min(w.characters.size(), e.characters.size()));
    std::copy_n(w.characters.begin(), e.length, e.characters.begin());
    if (e.length != 0)
      view_.set_characters(w.place, w.characters);
    else
      view_.set_number(w.place, w.value);
    return order;
  }
  Result operator()(const program::Wait& w) const {
    ForCycle order{EventKind::wait, {}};
    order.event.place = w.place;
    order.event.value = w.value;
    order.event.compare = w.compare;
    return order;
  }
  Result operator()(const program::Stop& s) const {
    return ForCycle{s.optional ? EventKind::optional_stop : EventKind::stop, {}};
  }
  Result operator()(const program::End& end_of_program) const {
    ForCycle order{EventKind::end, {}};
    order.event.flag = end_of_program.rewind;
    return order;
  }

 private:
  static ForCycle coded(EventKind kind, std::int32_t code) {
    ForCycle order{kind, {}};
    order.event.code = code;
    return order;
  }
  PathElements& elements_;
  ProgramTexts& texts_;
  image::Packets& view_;
};

}  // namespace

std::optional<ForCycle> for_cycle(const program::Command& command, PathElements& elements,
                                  ProgramTexts& texts, image::Packets& view) {
  return std::visit(Translation{elements, texts, view}, command.what);
}

}  // namespace servogate::channel
