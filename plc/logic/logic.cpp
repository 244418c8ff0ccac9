// SPDX-License-Identifier: Apache-2.0
#include "plc/logic/logic.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

#include "firmware_if/image/alarm_numbers.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc {

namespace {

/// Places that the old program writes and the new one does not.
std::vector<image::Place> dropped_places(const Image& before, const Image& now) {
  std::vector<image::Place> out;
  for (const Image::Shared& old : before.places) {
    const bool goes_on = std::any_of(now.places.begin(), now.places.end(),
                                     [&](const auto& s) { return s.written && s.place == old.place; });
    if (old.written && !goes_on) out.push_back(old.place);
  }
  return out;
}

void clear(const image::Place& place, image::Packets& packets) noexcept {
  if (place.format == image::Format::ch)
    packets.set_characters(place, {});
  else
    packets.set_number(place, 0.0);
}

void clear_written(const Image& program, image::Packets& packets) noexcept {
  for (const Image::Shared& s : program.places)
    if (s.written) clear(s.place, packets);
}

/// What the program writes, from one copy of the packets into another.
void copy_written(const Image& program, const image::Packets& from, image::Packets& to) noexcept {
  for (const Image::Shared& s : program.places) {
    if (!s.written) continue;
    if (s.place.format == image::Format::bl)
      to.set_bit(s.place, from.bit(s.place));
    else
      std::memcpy(to.data(s.place.packet) + s.place.byte(), from.data(s.place.packet) + s.place.byte(),
                  s.place.bytes());
  }
}

using RetainedKey = std::pair<std::string, std::string>;  ///< name, without case, and type

std::set<RetainedKey> retained_of(const Image& image) {
  std::set<RetainedKey> out;
  for (const Image::RetainedCell& c : image.retained) out.insert({key_of(c.name), c.type->name});
  return out;
}

/// What `before` held at its last scan, or kept aside itself, and `now` has no variable for.
std::vector<Retained> left_over(const LogicProgram& before, const Image& now) {
  constexpr std::size_t kMost = 10'000;
  std::vector<std::uint8_t> bytes;
  const bool scanned = before.retained.read(bytes) != 0;
  std::vector<Retained> out = before.aside;
  for (Retained& v : scanned ? before.engine.retained(bytes) : before.engine.retained())
    out.push_back(std::move(v));
  const std::set<RetainedKey> known = retained_of(now);
  std::erase_if(out, [&](const Retained& v) { return known.contains({key_of(v.name), v.type}); });
  if (out.size() > kMost) out.erase(out.begin(), out.end() - kMost);
  return out;
}

}  // namespace

/// A change on its way into the cycle and back.
struct Logic::Prepared {
  LogicChange::Kind kind = LogicChange::Kind::load;
  std::uint32_t number = 0;
  std::shared_ptr<LogicProgram> program;
  Transfer transfer;
  Forcing forcing;
  std::string name, value;
  std::vector<std::pair<std::string, std::string>> forced;  ///< of the new program
  bool accepted = false;
};

Logic::Logic(std::shared_ptr<const Image> image, std::vector<SourceFile> sources,
             const image::Clock& stopwatch)
    : stopwatch_(stopwatch), shown_(std::make_shared<LogicProgram>(std::move(image), std::move(sources))) {
  running_ = shown_.get();
  running_->engine.measure(&stopwatch_);
  running_->engine.watch(&watch_);
}

Logic::~Logic() {
  for (Slots* slots : {&ready_, &done_})
    for (auto& slot : *slots) delete slot.load();
}

void Logic::scan(image::ProcessImage& image, image::Notices& notices) noexcept {
  if (begins_) kept_ = image.packets;
  begins_ = ended_ = false;
  if (held_ && steps_ == 0) return stand_still(image);
  LogicProgram& program = *running_;
  const Image& compiled = program.engine.image();
  if (!given_back_) copy_written(compiled, kept_, image.packets);
  given_back_ = true;
  if (drops_)
    for (const image::Place& p : program.dropped) clear(p, image.packets);
  drops_ = false;
  last_ = run_program(image);
  if (held_) {
    --steps_;
    copy_written(compiled, image.packets, kept_);
    clear_written(compiled, image.packets);
    given_back_ = false;
  }
  const bool faulted = last_.fault != Fault::none;
  if (faulted && !faulted_) {
    raise_fault(last_, notices);
    ended_ = last_.fault == Fault::overrun;
  }
  faulted_ = faulted;
  if (faulted) return;  // what an abandoned scan has left half done is not kept
  program.engine.snapshot_retained(program.retained.scratch());
  program.retained.publish();
}

/// One scan, which fills the sample that somebody waits for; of several that were asked for, the last one.
ScanResult Logic::run_program(image::ProcessImage& image) noexcept {
  Engine& engine = running_->engine;
  const bool shown = wanted_.load(std::memory_order_relaxed) != nullptr && steps_ <= 1;
  LogicSample* const sample = shown ? wanted_.exchange(nullptr) : nullptr;
  const bool own = sample != nullptr && sample->program == running_;
  if (own && sample->profile) engine.profile(sample->blocks.data());
  const ScanResult result = engine.scan(image.packets, image.now.t_ns - held_ns_);
  if (sample == nullptr) return result;
  engine.profile(nullptr);
  if (own) fill(*sample, image.now, result);
  filled_.store(sample, std::memory_order_release);
  return result;
}

/// A cycle without a scan: the program's time stands, and what it writes is off.
void Logic::stand_still(image::ProcessImage& image) noexcept {
  held_ns_ += image.now.period_ns;
  clear_written(running_->engine.image(), image.packets);
  given_back_ = false;
  LogicSample* const sample =
      wanted_.load(std::memory_order_relaxed) != nullptr ? wanted_.exchange(nullptr) : nullptr;
  if (sample == nullptr) return;
  if (sample->program == running_) fill(*sample, image.now, last_);
  filled_.store(sample, std::memory_order_release);
}

void Logic::raise_fault(const ScanResult& result, image::Notices& notices) const noexcept {
  image::AlarmRecord r;
  const bool endless = result.fault == Fault::budget || result.fault == Fault::overrun;
  r.number = endless ? image::alarm::kPlcBudget : image::alarm::kPlcFault;
  r.line = result.line;
  r.file = result.file;
  r.run = running_->number;
  r.value = static_cast<double>(result.fault);
  r.detail1 = static_cast<double>(result.task);
  notices.add(r);
}

/// The gate has decided whether it may.
bool Logic::hold(const image::Request& request) noexcept {
  const bool holds = request.value != 0.0;
  begins_ = begins_ || (holds && !held_);
  held_ = holds;
  steps_ = request.value == 2.0 ? request.index : 0;
  return true;
}

void Logic::fill(LogicSample& sample, const image::CycleTime& now, const ScanResult& result) noexcept {
  std::uint8_t* to = sample.bytes.data();
  for (const LogicSample::Range& r : sample.ranges) {
    Handle handle;
    handle.address = r.address;
    std::memcpy(to, running_->engine.data(handle), r.size);
    to += r.size;
  }
  const auto tasks = running_->engine.task_times();
  for (std::size_t i = 0; i < tasks.size() && i < sample.tasks.size(); ++i) sample.tasks[i] = tasks[i];
  sample.at = now;
  sample.result = result;
}

bool Logic::order(const image::Request& request) noexcept {
  if (request.kind == image::RequestKind::logic_scan) return hold(request);
  auto& slot = ready_[request.index % kSlots];
  Prepared* const change = slot.exchange(nullptr, std::memory_order_acq_rel);
  if (change == nullptr) return false;
  change->accepted = change->number == request.index && carry_out(*change);
  const bool accepted = change->accepted;
  done_[request.index % kSlots].store(change, std::memory_order_release);
  return accepted;
}

bool Logic::carry_out(Prepared& change) noexcept {
  switch (change.kind) {
    case LogicChange::Kind::load:
      change.program->engine.take_over(running_->engine, change.transfer);
      running_ = change.program.get();
      faulted_ = false;
      drops_ = true;
      return true;
    case LogicChange::Kind::force:
      return running_->engine.apply(change.forcing);
    case LogicChange::Kind::release:
      running_->engine.release_now(change.forcing.handle);
      return true;
    case LogicChange::Kind::release_all:
      running_->engine.release_all_now();
      return true;
  }
  return false;
}

std::string Logic::fault_words(const image::AlarmRecord& record, text::Language language) const {
  const std::shared_ptr<const LogicProgram> of = program();
  if (of->number != record.run) return {};
  ScanResult result;
  result.fault = static_cast<Fault>(static_cast<int>(record.value));
  result.task = static_cast<std::int16_t>(record.detail1);
  result.file = static_cast<std::int16_t>(record.file);
  result.line = record.line;
  return of->engine.describe(result).str(language);
}

std::shared_ptr<const LogicProgram> Logic::program() const {
  const std::scoped_lock lock(mutex_);
  return shown_;
}

Logic::Plan Logic::prepare(const LogicChange& change, CompileResult compiled) {
  settle();
  Plan plan;
  auto prepared = std::make_unique<Prepared>();
  prepared->kind = change.kind;
  prepared->number = change.number;
  prepared->name = change.name;
  prepared->value = change.value;
  const Engine& engine = shown_->engine;
  if (change.kind == LogicChange::Kind::load) {
    plan = prepare_load(change, *prepared, std::move(compiled));
  } else if (change.kind == LogicChange::Kind::release_all) {
    plan.possible = true;
  } else if (const auto handle = engine.find(change.name)) {
    prepared->forcing.handle = *handle;
    plan.possible = true;
    if (change.kind == LogicChange::Kind::force) {
      const auto forcing = engine.prepare_force(*handle, change.value);
      plan.possible = forcing.has_value();
      if (forcing) prepared->forcing = *forcing;
    }
  }
  if (!plan.possible) return plan;
  delete done_[change.number % kSlots].exchange(nullptr);
  delete ready_[change.number % kSlots].exchange(prepared.release());
  return plan;
}

Logic::Plan Logic::prepare_load(const LogicChange& change, Prepared& out, CompileResult compiled) {
  Plan plan;
  plan.findings = std::move(compiled.findings);
  if (compiled.image == nullptr) return plan;
  plan.possible = true;
  const Image& before = shown_->engine.image();
  out.transfer = plan_transfer(before, *compiled.image, change.online);
  out.program = std::make_shared<LogicProgram>(compiled.image, change.files, change.number);
  out.program->dropped = dropped_places(before, *compiled.image);
  Engine& engine = out.program->engine;
  plan.fresh = out.transfer.fresh;
  plan.given_up = out.transfer.given_up;
  sort_retained(plan, engine);
  engine.measure(&stopwatch_);
  engine.watch(&watch_);
  engine.prepare_transfer(out.transfer);
  for (const auto& [name, value] : forced_) {
    const auto handle = engine.find(name);
    const auto forcing = handle ? engine.prepare_force(*handle, value) : std::nullopt;
    if (forcing && engine.apply(*forcing))
      out.forced.emplace_back(name, value);
    else
      plan.forces_lost.push_back(name);
  }
  plan.kept = out.transfer.kept + plan.taken_back.size();
  return plan;
}

// What was kept aside goes into variables that begin anew; what the running program has too much is kept
// aside.
void Logic::sort_retained(Plan& plan, Engine& engine) const {
  const auto keys = [](const std::vector<std::string>& names) {
    std::set<std::string> out;
    for (const std::string& name : names) out.insert(key_of(name));
    return out;
  };
  const std::set<std::string> fresh = keys(plan.fresh), given_up = keys(plan.given_up);
  for (const Retained& v : shown_->aside)
    if (fresh.contains(key_of(v.name)) && engine.restore({&v, 1}) != 0) plan.taken_back.push_back(v.name);
  const std::set<std::string> back = keys(plan.taken_back);
  std::erase_if(plan.fresh, [&](const std::string& name) { return back.contains(key_of(name)); });
  const std::set<RetainedKey> retained = retained_of(engine.image());
  for (const Image::RetainedCell& c : shown_->engine.image().retained) {
    if (!given_up.contains(key_of(c.name))) continue;
    const bool same = retained.contains({key_of(c.name), c.type->name});
    (same ? plan.lost : plan.set_aside).push_back(c.name);
  }
}

void Logic::withdraw(std::uint32_t number) { delete ready_[number % kSlots].exchange(nullptr); }

double Logic::number(const LogicProgram& program, const Handle& handle) const noexcept {
  return running_ == &program ? program.engine.number(handle) : std::numeric_limits<double>::quiet_NaN();
}

void Logic::settle() {
  std::vector<std::unique_ptr<Prepared>> done;
  for (auto& slot : done_)
    if (Prepared* change = slot.exchange(nullptr, std::memory_order_acq_rel); change != nullptr)
      done.emplace_back(change);
  std::sort(done.begin(), done.end(), [](const auto& a, const auto& b) { return a->number < b->number; });
  const auto forget = [this](const std::string& name) {
    std::erase_if(forced_, [&](const auto& f) { return same_name(f.first, name); });
  };
  for (const auto& change : done) {
    if (!change->accepted) continue;
    switch (change->kind) {
      case LogicChange::Kind::load: {
        change->program->aside = left_over(*shown_, change->program->engine.image());
        const std::scoped_lock lock(mutex_);
        shown_ = change->program;
        forced_ = change->forced;
        break;
      }
      case LogicChange::Kind::force:
        forget(change->name);
        forced_.emplace_back(change->name, change->value);
        break;
      case LogicChange::Kind::release:
        forget(change->name);
        break;
      case LogicChange::Kind::release_all:
        forced_.clear();
        break;
    }
  }
}

void Logic::ask(LogicSample& sample) {
  settle();
  std::size_t bytes = 0;
  for (const LogicSample::Range& r : sample.ranges) bytes += r.size;
  sample.bytes.assign(bytes, 0);
  sample.program = shown_.get();
  const Image& image = shown_->engine.image();
  sample.blocks.assign(sample.profile ? image.units.size() : 0, {});
  sample.tasks.assign(image.tasks.size(), {});
  filled_.store(nullptr);
  wanted_.store(&sample, std::memory_order_release);
}

}  // namespace servogate::plc
