// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/pendant/pendant_client.hpp"

#include <pthread.h>

#include "drivers/hid/hid_port.hpp"
#include "gateway/control/server/pendant/texts.hpp"
#include "machine/loading/pendant_layout.hpp"

namespace servogate::gateway {

namespace {

constexpr std::chrono::milliseconds kSnapshots{5};

std::unique_ptr<drivers::PendantPort> open_hid(const machine::LoadResult& loaded,
                                               const machine::PendantConfig& pendant, drivers::Notice& why) {
  const machine::PendantMap& device = loaded.device(pendant.device)->pendant;
  const machine::HidPlace place = machine::hid_place(pendant.url).value_or(machine::HidPlace{});
  return hid::HidPort::open({static_cast<std::uint16_t>(device.usb_vendor),
                             static_cast<std::uint16_t>(device.usb_product), place.serial, place.path},
                            why);
}

}  // namespace

PendantClient::PendantClient(Control& control, const machine::PendantConfig& pendant, Desk& desk,
                             const Announce& announce, drivers::PendantPort& port)
    : port_(port),
      seen_(std::make_unique<image::ProcessImage>()),
      image_(std::make_unique<image::ProcessImage>()),
      client_(desk, image::Asker::pendant, pendant.name, text::user_language()),
      session_(control.loaded(), pendant, port,
               {[this](ask::Command command) { return client_.ask(std::move(command)); },
                [this](std::uint64_t question) { return client_.take(question); }, client_.hand()},
               announce) {
  client_.subscribe(kSnapshots, [this](const image::ProcessImage& image, const cycle::AlarmSnapshot&) {
    const std::scoped_lock lock(seen_lock_);
    *seen_ = image;
    any_ = true;
  });
}

std::unique_ptr<PendantClient> PendantClient::open(Control& control, const machine::PendantConfig& pendant,
                                                   Desk& desk, const Announce& announce,
                                                   drivers::Notice& why) {
  drivers::PendantPort* port = control.world().pendant(pendant.name);
  std::unique_ptr<drivers::PendantPort> own;
  if (port == nullptr) {
    own = open_hid(control.loaded(), pendant, why);
    if (own == nullptr) return nullptr;
    port = own.get();
    if (announce) announce(pendant_says::kWaits, {pendant.name, pendant.url});
  }
  std::unique_ptr<PendantClient> client(new PendantClient(control, pendant, desk, announce, *port));
  client->own_ = std::move(own);
  client->thread_ = std::thread([c = client.get()] { c->run(); });
  return client;
}

PendantClient::~PendantClient() {
  end_ = true;
  if (thread_.joinable()) thread_.join();
}

void PendantClient::run() {
  pthread_setname_np(pthread_self(), "pendant");
  bool any = false;
  while (!end_) {
    any ? port_.wait(kSnapshots) : std::this_thread::sleep_for(kSnapshots);
    {
      const std::scoped_lock lock(seen_lock_);
      any = any_;
      if (any) *image_ = *seen_;
    }
    if (!any) continue;
    session_.step(*image_, std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
  }
}

}  // namespace servogate::gateway
