// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/sole_master.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <random>

#include "drivers/clock.hpp"
#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "firmware_if/canopen/master/master_claim.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/control/server/socket/socket_path.hpp"
#include "machine/bus_place.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kStart{"master.start", "starting '{0}'", "запуск «{0}»"};
const text::Entry kClaimed{"master.claimed",
                           "'{0}' is not started: process {2} has just taken bus {1}. Two masters would "
                           "reset each other's drives in motion; end that process first",
                           "«{0}» не запущен: шину {1} только что занял процесс {2}. Два ведущих сбрасывали "
                           "бы приводы друг друга на ходу; сначала завершите тот процесс"};
const text::Entry kLed{"master.led",
                       "'{0}' is not started: another master controls bus {1}; within {2} s it sent {3}. A "
                       "second master would reset drives that are in motion. Nothing was sent from here. End "
                       "the other control, or disconnect it from this bus",
                       "«{0}» не запущен: шиной {1} управляет другой ведущий; за {2} с от него пришли {3}. "
                       "Второй ведущий сбросил бы приводы на ходу. Отсюда ничего не отправлено. Завершите "
                       "другое управление или отключите его от этой шины"};

const text::Entry kLate{
    "master.late",
    "'{0}' is not started: another control starts on bus {1} at the same time, and was "
    "first. Nothing was sent to any device from here. Let one of the two lead the bus",
    "«{0}» не запущен: на шине {1} в то же время запускается другое управление, и оно было "
    "первым. Отсюда ни одному устройству ничего не отправлено. Пусть шиной управляет "
    "одно из двух"};

constexpr double kLeast_s = 1.2;  ///< hears a heartbeat once a second
constexpr double kMost_s = 10.0;
constexpr double kHeartbeats = 1.5;

std::string say(const text::Entry& entry, std::vector<std::string> arguments) {
  return text::render(entry, arguments, text::user_language());
}

/// What was heard of one kind: how often, and its first frame.
struct Heard {
  image::CanFrame first;
  int count = 0;
};
using HeardByIdentifier = std::map<std::uint32_t, Heard>;

/// A bus while it is listened to.
struct Listening {
  CanSupplier* supplier = nullptr;
  const CanTransport* transport = nullptr;
  std::string url;
  canopen::MasterClaim claim;
  HeardByIdentifier heard;

  canopen::MasterClaim::State hear(image::Nanoseconds now) {
    image::CanFrame frame;
    while (transport->bus->receive(frame)) {
      claim.on_frame(frame);
      if (!canopen::leads_nodes(frame, supplier->segment().config().own_node)) continue;
      Heard& h = heard[frame.id];
      if (h.count++ == 0) h.first = frame;
    }
    return claim.poll(now, *transport->bus);
  }
};

std::uint64_t random_number() {
  std::random_device chance;
  return std::uint64_t{chance()} << 32 | chance();
}

/// "SYNC (080h) 300 times, RPDO 1 of node 1 (201h) 300 times"; the rest is counted.
std::string in_words(const HeardByIdentifier& heard) {
  constexpr std::size_t kNamed = 4;
  std::string words;
  std::size_t n = 0;
  for (const auto& [id, h] : heard) {
    if (n++ == kNamed) break;
    const std::string times = std::to_string(h.count);
    words += (words.empty() ? "" : ", ") + canopen::frame_words(h.first) +
             text::both(" " + times + (h.count == 1 ? " time" : " times"), " " + times + " раз");
  }
  if (heard.size() > kNamed) {
    const std::string more = std::to_string(heard.size() - kNamed);
    words += text::both(" and " + more + " more kinds", " и ещё других: " + more);
  }
  return words;
}

/// kAlarm when the bus is somebody else's, which is said.
int tell(const Listening& bus, const std::string& machine, double listened_s) {
  using State = canopen::MasterClaim::State;
  if (bus.claim.state() != State::led && bus.claim.state() != State::late) return kDone;
  if (bus.heard.empty())
    complain(kLate, {machine, bus.url});
  else
    complain(kLed, {machine, bus.url, text::number(listened_s, 1), in_words(bus.heard)});
  return kAlarm;
}

/// Letters, digits and dots of a place; what is cut off is told by its length.
std::string claim_file(const std::string& place) {
  std::string name;
  for (const char c : place) name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' ? c : '-';
  constexpr std::size_t kLongest = 120;
  if (name.size() > kLongest)
    name = name.substr(name.size() - kLongest) + "-" + std::to_string(std::hash<std::string>{}(place));
  return socket_folder() + "/" + name + ".bus";
}

/// -1: the folder of the control sockets is not this user's, or cannot be made.
int open_claim(const std::string& path) {
  const std::filesystem::path folder = socket_folder();
  std::error_code error;
  if (std::filesystem::create_directories(folder, error)) ::chmod(folder.c_str(), 0700);
  struct stat seen {};
  if (::lstat(folder.c_str(), &seen) != 0 || seen.st_uid != ::getuid() || !S_ISDIR(seen.st_mode)) return -1;
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
}

std::string holder_in(int file) {
  char number[32] = {};
  const ssize_t length = ::pread(file, number, sizeof number - 1, 0);
  return length > 0 ? std::string(number, static_cast<std::size_t>(length)) : "?";
}

}  // namespace

SoleMaster::~SoleMaster() {
  for (const int file : claims_) ::close(file);
}

int SoleMaster::claim(const machine::LoadResult& loaded) {
  const machine::MachineConfig& m = loaded.machine;
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    const machine::BusConfig& bus = m.buses[b];
    if (bus.mock()) continue;
    if (const auto holder = holder_of({bus.url, 0, loaded, b}))
      return refuse_held(*holder, bus.url, say(kStart, {m.name}));
    const int file = open_claim(claim_file(machine::bus_place(bus.url)));
    if (file < 0) continue;  // nobody finds this control either: listening is left
    claims_.push_back(file);
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
      complain(kClaimed, {m.name, bus.url, holder_in(file)});
      return kAlarm;
    }
    const std::string number = std::to_string(::getpid());
    if (::ftruncate(file, 0) != 0 || ::pwrite(file, number.data(), number.size(), 0) < 0) continue;
  }
  return kDone;
}

image::Nanoseconds SoleMaster::patience(const machine::MachineConfig& machine) {
  double longest = kLeast_s;
  for (const machine::BusConfig& bus : machine.buses)
    for (const machine::NodeConfig& node : bus.nodes)
      longest = std::max(longest, kHeartbeats * node.heartbeat);
  return std::llround(std::min(longest, kMost_s) * 1e9);
}

int SoleMaster::listen(Control& control) {
  using State = canopen::MasterClaim::State;
  const machine::MachineConfig& m = control.machine();
  const image::Nanoseconds patience = SoleMaster::patience(m);
  const std::uint64_t chance = random_number();  // one number on all buses: nobody is first on one of two
  std::vector<Listening> buses;
  std::vector<pollfd> ears;
  for (std::size_t b = 0; b < m.buses.size(); ++b) {
    const CanTransport* t = control.shared_bus(b);
    if (t == nullptr) continue;
    CanSupplier* supplier = control.suppliers()[b].get();
    buses.push_back(
        {supplier, t, m.buses[b].url, {supplier->segment().config().own_node, patience, chance}, {}});
    ears.push_back({t->descriptor, POLLIN, 0});
  }
  const image::Nanoseconds begin = drivers::clock_ns(CLOCK_MONOTONIC);
  for (Listening& bus : buses) bus.claim.begin(begin);
  image::Nanoseconds now = begin;
  // Whoever leads the bus is heard out, so that it can be said what comes and how often.
  for (bool more = !buses.empty(); more;) {
    const timespec nap{0, 5 * image::kMillisecond};
    ppoll(ears.data(), ears.size(), &nap, nullptr);
    now = drivers::clock_ns(CLOCK_MONOTONIC);
    bool lost = false, open = false;
    for (Listening& bus : buses) {
      const State state = bus.hear(now);
      lost = lost || state == State::led || state == State::late;
      open = open || state < State::leads;
    }
    more = now - begin < patience || (open && !lost);
  }
  int code = kDone;
  const double listened_s = static_cast<double>(now - begin) * 1e-9;
  for (const Listening& bus : buses) code = std::max(code, tell(bus, m.name, listened_s));
  for (Listening& bus : buses) bus.supplier->listened(now);
  return code;
}

}  // namespace servogate::gateway::command
