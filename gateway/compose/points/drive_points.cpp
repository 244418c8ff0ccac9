// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/points/drive_points.hpp"

#include <optional>

namespace servogate::gateway {

namespace {

std::optional<DriveSeat> seat_of(const machine::MachineConfig& m, const std::string& node) {
  for (std::size_t a = 0; a < m.axes.size(); ++a)
    if (m.axes[a].drive == node) return DriveSeat{false, a};
  for (std::size_t s = 0; s < m.spindles.size(); ++s)
    if (m.spindles[s].drive == node) return DriveSeat{true, s};
  return std::nullopt;
}

template <typename Image>
auto& drive_of(Image& image, const DriveSeat& seat) noexcept {
  return seat.spindle ? image.spindles[seat.index].drive : image.axes[seat.index].drive;
}

}  // namespace

std::vector<DriveStation> drive_stations(const machine::MachineConfig& m) {
  std::vector<DriveStation> stations;
  for (std::size_t s = 0; s < m.stations.size(); ++s) {
    const machine::StationConfig& config = m.stations[s];
    const auto seat = seat_of(m, config.node);
    if (config.kind != machine::StationKind::drive || !seat) continue;
    DriveStation station{*seat, s, {}, {}};
    for (const machine::PointConfig& p : config.points) {
      if (p.number < 0 || p.number >= 32) continue;
      auto& points = p.is_input() ? station.inputs : station.outputs;
      points.push_back({std::uint32_t{1} << p.number, p.place, p.inverted, p.hold, p.loss != 0.0});
    }
    stations.push_back(std::move(station));
  }
  return stations;
}

void DriveInputs::receive(image::ProcessImage& image) noexcept {
  for (const DriveStation& station : stations_) {
    const image::DriveFeedback& drive = drive_of(image, station.seat);
    for (const DrivePoint& p : station.inputs) {
      if (drive.online)
        image.packets.set_bit(p.place, ((drive.digital_inputs & p.mask) != 0) != p.inverted);
      else if (!p.hold)
        image.packets.set_bit(p.place, p.on_loss);
    }
    image::IoSource& source = image.sources[station.source];
    if (drive.online) {
      source.quality = image::Quality::good;
      source.updated_ns = image.now.t_ns;
    } else if (source.quality != image::Quality::never) {
      source.quality = image::Quality::bad;
    }
  }
}

void DriveOutputs::send(image::ProcessImage& image) noexcept {
  for (const DriveStation& station : stations_) {
    std::uint32_t levels = 0;
    for (const DrivePoint& p : station.outputs)
      if (image.packets.bit(p.place) != p.inverted) levels |= p.mask;
    image::DriveCommand& command = station.seat.spindle ? image.spindles[station.seat.index].drive_command
                                                        : image.axes[station.seat.index].drive_command;
    command.digital_outputs = levels;
  }
}

}  // namespace servogate::gateway
