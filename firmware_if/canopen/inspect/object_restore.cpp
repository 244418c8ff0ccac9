// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/object_restore.hpp"

#include <algorithm>
#include <set>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kMapOffset = 0x200;  ///< from 1400h to 1600h, from 1800h to 1A00h
constexpr std::uint32_t kNotValid = 0x8000'0000;

/// 1400h ... of the PDO that an index belongs to; 0: it belongs to none.
constexpr std::uint16_t pdo_of(std::uint16_t index) {
  for (const std::uint16_t first : {object::kRpdoParameter, object::kTpdoParameter}) {
    if (index >= first && index < first + kMapOffset) return index;
    if (index >= first + kMapOffset && index < first + 2 * kMapOffset)
      return static_cast<std::uint16_t>(index - kMapOffset);
  }
  return 0;
}

class Restorer {
 public:
  Restorer(SdoAccess& access, NodeId node, std::vector<Parameter> all, std::vector<FailedWrite>& failed,
           const std::function<bool()>& over)
      : access_(access), node_(node), all_(std::move(all)), failed_(failed), over_(over) {}

  void write(std::uint16_t index, std::uint8_t subindex) {
    if (const Parameter* p = find(index, subindex); p != nullptr && p->writable)
      put(index, subindex, p->wanted);
  }

  void write_pdo(std::uint16_t parameter) {
    const auto map = static_cast<std::uint16_t>(parameter + kMapOffset);
    const Parameter* cob = find(parameter, 1);
    if (cob != nullptr && cob->wanted.size() == 4) {
      std::vector<std::uint8_t> off(4);
      store_le(load_le(cob->wanted) | kNotValid, off);
      put(parameter, 1, off, false);
    }
    if (const Parameter* count = find(map, 0); count != nullptr && count->wanted.size() == 1) {
      put(map, 0, std::vector<std::uint8_t>{0}, false);
      for (std::uint8_t sub = 1; sub <= count->wanted[0] && sub != 0; ++sub) write(map, sub);
      write(map, 0);
    }
    for (const Parameter& p : all_)
      if (p.index == parameter && p.subindex > 1) write(p.index, p.subindex);
    write(parameter, 1);
  }

  int written() const noexcept { return written_; }
  bool over() const { return silent_ || over_(); }

 private:
  const Parameter* find(std::uint16_t index, std::uint8_t subindex) const {
    const auto found = std::find_if(all_.begin(), all_.end(), [&](const Parameter& p) {
      return p.index == index && p.subindex == subindex;
    });
    return found == all_.end() ? nullptr : &*found;
  }

  void put(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> bytes,
           bool counts = true) {
    if (over()) return;
    SdoOutcome outcome = access_.write(node_, index, subindex, bytes);
    silent_ = !outcome.answered();
    if (outcome.ok())
      written_ += counts ? 1 : 0;
    else
      failed_.push_back({index, subindex, std::move(outcome)});
  }

  SdoAccess& access_;
  NodeId node_;
  std::vector<Parameter> all_;
  std::vector<FailedWrite>& failed_;
  const std::function<bool()>& over_;
  int written_ = 0;
  bool silent_ = false;
};

}  // namespace

int restore(SdoAccess& access, NodeId node, const Eds& file, const std::vector<Difference>& differing,
            std::vector<FailedWrite>& failed, const std::function<bool()>& over) {
  Restorer restorer(access, node, parameters_of(file, node), failed, over);
  std::set<std::uint16_t> pdos;
  for (const Difference& d : differing) {
    if (restorer.over()) break;
    const std::uint16_t pdo = pdo_of(d.index);
    if (pdo == 0)
      restorer.write(d.index, d.subindex);
    else if (pdos.insert(pdo).second)
      restorer.write_pdo(pdo);
  }
  return restorer.written();
}

}  // namespace servogate::canopen
