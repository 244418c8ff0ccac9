// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/block_journal.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "machine/state/state_lock.hpp"
#include "machine/state/state_text.hpp"

namespace servogate::gateway {

namespace {

constexpr std::chrono::milliseconds kPause{100};
constexpr std::uint64_t kMagic = 0x73672d626c6f636bULL;  // "sg-block"
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kLongestPath = 1024, kLongestName = 32;

/// What a cycle knows of a process' program; plain data.
struct Place {
  std::int64_t executed = 0;
  std::int64_t from = 0;       ///< the run began with this block
  std::int64_t next_from = 0;  ///< the next run will
  std::uint32_t run = 0;
  std::int32_t line = 0, file = 0;
  std::int32_t open = 0;  ///< it has begun and not come to its end
  program::Position stands{};
};

}  // namespace

/// The same bytes in memory and on the disk.
struct BlockJournal::Memory {
  std::uint64_t magic = kMagic;
  std::uint32_t version = kVersion, size = sizeof(Memory);
  struct Seat {
    /// Odd while the cycle writes `place`.
    std::atomic<std::uint32_t> sequence{0};
    Place place;
    std::array<char, kLongestPath> program{};
    std::array<char, kLongestName> dialect{};
  };
  std::array<Seat, image::kMaxProcesses> seats;

  bool valid() const { return magic == kMagic && version == kVersion && size == sizeof(Memory); }
};

namespace {

/// One of two copies on the disk; the newer whole one counts.
struct Slot {
  std::uint64_t generation = 0;
  std::uint32_t crc = 0, length = 0;
  std::uint64_t exact = 0;  ///< 1: written behind the last cycle
};
constexpr std::size_t kSlotBytes = 16384;
static_assert(sizeof(Slot) % 8 == 0);

/// Reads a seat's place whole, however often the cycle writes meanwhile.
template <typename Seat>
Place read_place(const Seat& seat) {
  Place place;
  for (int tries = 0; tries < 1000; ++tries) {
    const std::uint32_t before = seat.sequence.load(std::memory_order_acquire);
    std::memcpy(&place, &seat.place, sizeof place);
    std::atomic_thread_fence(std::memory_order_acquire);
    if (before % 2 == 0 && seat.sequence.load(std::memory_order_relaxed) == before) break;
  }
  return place;
}

template <std::size_t N>
void put(std::array<char, N>& into, const std::string& text) {
  into.fill(0);
  std::copy_n(text.begin(), std::min(text.size(), N - 1), into.begin());
}

std::string shared_name(const std::string& folder) {
  std::error_code ignored;
  const std::string whole = std::filesystem::weakly_canonical(folder, ignored).string();
  char name[64];
  std::snprintf(name, sizeof name, "/servogate.%u.%08x", static_cast<unsigned>(::getuid()),
                machine::crc32(whole));
  return name;
}

}  // namespace

BlockJournal::BlockJournal(const std::string& folder, int processes) : processes_(processes) {
  own_ = std::make_unique<Memory>();
  memory_ = own_.get();
  if (folder.empty() || !machine::make_state_directory(folder).empty()) return;
  bool fresh = true;
  shared_ = shared_name(folder);
  const int shared = ::shm_open(shared_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  struct stat seen {};
  if (shared >= 0 && ::fstat(shared, &seen) == 0 && seen.st_uid == ::getuid() &&
      ::ftruncate(shared, sizeof(Memory)) == 0) {
    void* at = ::mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, shared, 0);
    if (at != MAP_FAILED) {
      auto* memory = static_cast<Memory*>(at);
      fresh = !memory->valid();
      if (fresh) memory = new (at) Memory;
      memory_ = memory;
      (void)::mlock(at, sizeof(Memory));  // without it a first touch in the cycle may be late
    }
  }
  if (shared >= 0) ::close(shared);
  file_ =
      ::open((std::filesystem::path(folder) / "block.journal").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  for (int s = 0; s < 2 && file_ >= 0; ++s) {
    Slot slot;
    Memory copy;
    const off_t at = static_cast<off_t>(s) * static_cast<off_t>(kSlotBytes);
    if (::pread(file_, &slot, sizeof slot, at) != static_cast<ssize_t>(sizeof slot) ||
        slot.length != sizeof(Memory) || slot.generation <= generation_ ||
        ::pread(file_, static_cast<void*>(&copy), sizeof copy, at + static_cast<off_t>(sizeof slot)) !=
            static_cast<ssize_t>(sizeof copy) ||
        machine::crc32({reinterpret_cast<const char*>(&copy), sizeof copy}) != slot.crc || !copy.valid())
      continue;
    generation_ = slot.generation;
    if (!fresh) continue;
    std::memcpy(static_cast<void*>(memory_), static_cast<const void*>(&copy), sizeof copy);
    from_disk_ = slot.exact == 0;
  }
  for (Memory::Seat& seat : memory_->seats) {
    if (seat.sequence.load() % 2 != 0) seat.sequence.fetch_add(1);  // the end came while it was written
    seat.place.run = 0;                                             // this process counts its runs anew
    seat.place.next_from = 0;
  }
  if (file_ >= 0) thread_ = std::thread([this] { keep(); });
}

BlockJournal::~BlockJournal() {
  if (thread_.joinable()) {
    {
      const std::scoped_lock lock(mutex_);
      end_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  if (file_ >= 0) ::close(file_);
  if (memory_ == own_.get()) return;
  ::munmap(memory_, sizeof(Memory));
  if (file_ >= 0) ::shm_unlink(shared_.c_str());  // the file has it all
}

void BlockJournal::loaded(int process, const std::string& program, const std::string& dialect) {
  Memory::Seat& seat = memory_->seats[static_cast<std::size_t>(process)];
  if (program.substr(0, kLongestPath - 1) == seat.program.data()) return;
  seat.sequence.fetch_add(1, std::memory_order_acq_rel);
  put(seat.program, program);
  put(seat.dialect, dialect);
  const std::uint32_t run = seat.place.run;
  seat.place = {};
  seat.place.run = run;
  seat.sequence.fetch_add(1, std::memory_order_release);
  from_disk_ = false;
}

void BlockJournal::begins_with(int process, std::int64_t executed) {
  Memory::Seat& seat = memory_->seats[static_cast<std::size_t>(process)];
  seat.sequence.fetch_add(1, std::memory_order_acq_rel);
  seat.place.next_from = executed;
  seat.sequence.fetch_add(1, std::memory_order_release);
}

void BlockJournal::note(const image::ProcessImage& image) noexcept {
  for (int p = 0; p < processes_ && p < image.process_count; ++p) {
    const image::ProcessStatus& status = image.processes[static_cast<std::size_t>(p)];
    Memory::Seat& seat = memory_->seats[static_cast<std::size_t>(p)];
    const bool busy = status.state == image::ProcessState::running ||
                      status.state == image::ProcessState::held ||
                      status.state == image::ProcessState::waiting;
    const bool ended = status.state == image::ProcessState::ended && seat.place.open != 0;
    if (status.typed || seat.program[0] == '\0' || !(busy || ended)) continue;
    seat.sequence.fetch_add(1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    Place& place = seat.place;
    if (place.run != status.run) {
      place.from = place.next_from;
      place.next_from = 0;
      place.run = status.run;
    }
    place.open = ended ? 0 : 1;
    place.executed = std::max(status.blocks_done, place.from);
    place.line = status.line;
    place.file = status.file;
    for (std::size_t a = 0; a < place.stands.size(); ++a) place.stands[a] = image.axes[a].command - image.axes[a].beside;
    seat.sequence.fetch_add(1, std::memory_order_release);
  }
}

std::optional<BlockJournal::Block> BlockJournal::interrupted(int process) const {
  const Memory::Seat& seat = memory_->seats[static_cast<std::size_t>(process)];
  const Place place = read_place(seat);
  if (place.open == 0) return std::nullopt;
  return Block{seat.program.data(), seat.dialect.data(), place.executed, place.line,
               place.file,          place.stands,        from_disk_};
}

/// Two copies take turns, so that one is whole whenever the power goes.
void BlockJournal::keep() {
  Memory copy, written;
  bool first = true;
  std::unique_lock lock(mutex_);
  for (bool last = false; !last;) {
    last = wake_.wait_for(lock, kPause, [this] { return end_; });
    for (std::size_t p = 0; p < copy.seats.size(); ++p) {
      copy.seats[p].place = read_place(memory_->seats[p]);
      copy.seats[p].program = memory_->seats[p].program;
      copy.seats[p].dialect = memory_->seats[p].dialect;
    }
    if (!first && !last &&
        std::memcmp(static_cast<const void*>(&copy), static_cast<const void*>(&written), sizeof copy) == 0)
      continue;
    first = false;
    std::memcpy(static_cast<void*>(&written), static_cast<const void*>(&copy), sizeof copy);
    const Slot slot{++generation_, machine::crc32({reinterpret_cast<const char*>(&copy), sizeof copy}),
                    sizeof(Memory), last ? 1u : 0u};
    const off_t at = static_cast<off_t>(generation_ % 2) * static_cast<off_t>(kSlotBytes);
    // What cannot be written is missing after a loss of power only.
    if (::pwrite(file_, static_cast<const void*>(&copy), sizeof copy, at + static_cast<off_t>(sizeof slot)) ==
            static_cast<ssize_t>(sizeof copy) &&
        ::pwrite(file_, &slot, sizeof slot, at) == static_cast<ssize_t>(sizeof slot))
      (void)::fdatasync(file_);
  }
}

}  // namespace servogate::gateway
