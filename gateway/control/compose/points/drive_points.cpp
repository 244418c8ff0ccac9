// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/points/drive_points.hpp"

#include <optional>

#include "gateway/control/compose/points/point_rules.hpp"

namespace servogate::gateway {

namespace {

constexpr int kBits = 32;

std::optional<DriveSeat> seat_of(const machine::MachineConfig& m, const std::string& node) {
  // The drive of a spindle that becomes an axis is the spindle's.
  for (std::size_t s = 0; s < m.spindles.size(); ++s)
    if (m.spindles[s].drive == node) return DriveSeat{true, s};
  for (std::size_t a = 0; a < m.axes.size(); ++a)
    if (m.axes[a].drive == node) return DriveSeat{false, a};
  return std::nullopt;
}

}  // namespace

DrivePoints::DrivePoints(const machine::StationConfig& station, DriveSeat seat, int source)
    : seat_(seat), stage_(point_rules(station), source) {
  for (const machine::PointConfig& p : station.points)
    masks_.push_back(p.number >= 0 && p.number < kBits ? std::uint32_t{1} << p.number : 0);
}

void DrivePoints::receive(image::ProcessImage& image) noexcept {
  const image::DriveFeedback& drive =
      seat_.spindle ? image.spindles[seat_.index].drive : image.axes[seat_.index].drive;
  if (drive.online)
    stage_.fresh(0, image.now.t_ns);
  else
    stage_.lost(0);
  for (std::size_t n = 0; drive.online && n < stage_.size(); ++n)
    if (stage_.rule(n).input && masks_[n] != 0)
      stage_.take(n, (drive.digital_inputs & masks_[n]) != 0 ? 1.0 : 0.0);
  stage_.settle(image);
}

void DrivePoints::send(image::ProcessImage& image) noexcept {
  std::uint32_t levels = 0;
  for (std::size_t n = 0; n < stage_.size(); ++n)
    if (!stage_.rule(n).input && stage_.level(n, image.packets)) levels |= masks_[n];
  image::DriveCommand& command =
      seat_.spindle ? image.spindles[seat_.index].drive_command : image.axes[seat_.index].drive_command;
  command.digital_outputs = levels;
}

std::vector<DrivePoints> drive_points(const machine::MachineConfig& m, const std::string& bus) {
  std::vector<DrivePoints> out;
  for (std::size_t s = 0; s < m.stations.size(); ++s) {
    const machine::StationConfig& station = m.stations[s];
    if (station.kind != machine::StationKind::drive || !station.node.starts_with(bus + ".")) continue;
    if (const auto seat = seat_of(m, station.node)) out.emplace_back(station, *seat, static_cast<int>(s));
  }
  return out;
}

}  // namespace servogate::gateway
