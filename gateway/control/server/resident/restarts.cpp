// SPDX-License-Identifier: Apache-2.0
// The way back into a program: what Resident does for a start in its middle.
#include "firmware_if/image/interface_map.hpp"
#include "gateway/control/server/resident/resident.hpp"

namespace servogate::gateway {

Resident::RestartSearch Resident::begin_restart(int process, const program::RestartAt& at) {
  RestartSearch search{process, at, seat(process).file, tables(), start_of(process), nullptr};
  const std::uint32_t base = image::process_base(process);
  constexpr image::Place kSkipLevels = image::field(image::kProcessFields, "skip_levels");
  constexpr image::Place kDryRun = image::field(image::kProcessFields, "dry_run");
  search.at.switches.skip_levels =
      static_cast<std::uint16_t>(image_.packets.number(image::at(kSkipLevels, base)));
  search.packets = std::make_shared<const image::Packets>(image_.packets);
  search.at.switches.dry_run = image_.packets.bit(image::at(kDryRun, base));
  return search;
}

void Resident::find(RestartSearch& search) {
  const ProgramFile& f = *search.file;
  const program::Interpreter fresh(f.dialect, f.model, search.tables, f.path, f.text, f.loader,
                                   search.start.at, search.process);
  search.found = program::restart(fresh, search.at, *search.packets);
}

bool Resident::begin_in_middle(const RestartSearch& search, double feed_mm_min, bool confirm) {
  if (!control_.change({ProgramChange::Kind::restart,
                        search.process,
                        search.file,
                        search.tables,
                        {},
                        ProgramRestart{search.at, feed_mm_min, confirm}}))
    return false;
  if (journal_ != nullptr)
    journal_->begins_with(search.process, std::get<program::RestartPoint>(*search.found).executed + 1);
  return true;
}

}  // namespace servogate::gateway
