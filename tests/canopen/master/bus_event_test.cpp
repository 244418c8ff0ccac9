// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/events/bus_event.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "firmware_if/canopen/402/drive_profile.hpp"

namespace servogate::canopen {
namespace {

using text::Language;

BusEvent event(BusEventKind kind) {
  BusEvent e;
  e.kind = kind;
  e.node = 5;
  return e;
}

TEST(BusEventRing, gives_back_in_order_and_counts_what_it_could_not_keep) {
  BusEventRing ring;
  for (std::uint32_t i = 0; i < BusEventRing::kCapacity + 10; ++i) {
    BusEvent e = event(BusEventKind::emcy);
    e.cycle = i;
    EXPECT_EQ(ring.push(e), i < BusEventRing::kCapacity);
  }
  EXPECT_EQ(ring.lost(), 10u);
  BusEvent e;
  for (std::uint32_t i = 0; i < BusEventRing::kCapacity; ++i) {
    ASSERT_TRUE(ring.pop(e));
    EXPECT_EQ(e.cycle, i);
  }
  EXPECT_FALSE(ring.pop(e));
}

TEST(BusEventRing, one_writer_and_one_reader_lose_nothing_they_do_not_count) {
  BusEventRing ring;
  constexpr std::int64_t kEvents = 200'000;
  std::thread writer([&ring] {
    for (std::int64_t i = 1; i <= kEvents; ++i) {
      BusEvent e = event(BusEventKind::emcy);
      e.cycle = i;
      e.got = -i;
      ring.push(e);
    }
  });
  std::int64_t read = 0, last = 0;
  BusEvent e;
  const auto take = [&] {
    while (ring.pop(e)) {
      ASSERT_GT(e.cycle, last);
      ASSERT_EQ(e.got, -e.cycle);
      last = e.cycle;
      ++read;
    }
  };
  while (read + ring.lost() < kEvents) take();
  writer.join();
  take();
  EXPECT_EQ(read + ring.lost(), kEvents);
}

TEST(BusEventText, every_kind_has_a_sentence_without_empty_places) {
  for (int kind = 0; kind <= static_cast<int>(BusEventKind::bus_state); ++kind)
    for (const Language language : {Language::english, Language::russian}) {
      BusEvent e = event(static_cast<BusEventKind>(kind));
      e.boot.index = 0x1018;
      e.boot.problem = BootProblem::no_answer;
      const std::string sentence = describe(e, "Y", nullptr, language);
      EXPECT_EQ(sentence.find('{'), std::string::npos) << sentence;
      EXPECT_EQ(sentence.rfind("Y: ", 0), 0u) << sentence;
    }
}

TEST(BusEventText, names_step_object_and_reason_of_a_failed_boot) {
  BusEvent e = event(BusEventKind::boot_failed);
  e.boot = {BootStep::tpdo, BootProblem::aborted,        0x1A01,     2,
            true,           AbortCode::cannot_be_mapped, 0x60BA0020, 0};
  EXPECT_EQ(describe(e, "Y", nullptr, Language::english),
            "Y: boot stopped at step \"process data of the device (TPDO)\": writing 1A01h:02 TPDO mapping "
            "parameter: refused by the device, the object cannot be mapped into a PDO (06040041h) (of a "
            "device without "
            "it: tpdo, fixed_pdo_map = true)");
  EXPECT_EQ(describe(e, "Y", nullptr, Language::russian),
            "Y: загрузка остановилась на шаге «данные процесса от устройства (TPDO)»: запись 1A01h:02 "
            "TPDO mapping "
            "parameter: отказ устройства, объект нельзя включить в PDO (06040041h) (для устройства без "
            "этого: tpdo, "
            "fixed_pdo_map = true)");
  e.boot.abort = static_cast<AbortCode>(0x12345678);
  EXPECT_NE(describe(e, "Y", nullptr, Language::english).find("SDO abort code 12345678h, not in CiA 301"),
            std::string::npos);
  e.boot.problem = BootProblem::wrong_length;
  e.boot.writing = false;
  e.boot.expected = 4;
  e.boot.got = 2;
  EXPECT_NE(describe(e, "Y", nullptr, Language::english).find("expected 4 bytes, got 2"), std::string::npos);
}

TEST(BusEventText, of_a_failed_boot_names_the_key_that_waives_the_step_where_there_is_one) {
  BusEvent e = event(BusEventKind::boot_failed);
  const auto said = [&](BootStep step, std::uint16_t index, BootProblem problem = BootProblem::aborted) {
    e.boot = {step, problem, index, 0, true, AbortCode::object_does_not_exist, 0, 0};
    return describe(e, "Y", nullptr, Language::english);
  };
  EXPECT_TRUE(said(BootStep::abort_connection, 0x6007).ends_with("without it: connection_loss = \"none\")"));
  EXPECT_TRUE(said(BootStep::error_states, 0x6206).ends_with("without it: connection_loss = \"none\")"));
  EXPECT_TRUE(said(BootStep::supported_modes, 0x6502).ends_with("without it: check_modes = false)"));
  EXPECT_TRUE(said(BootStep::sync, 0x1019).ends_with("without it: sync_counter = false)"));
  for (int step = static_cast<int>(BootStep::software_version); step < static_cast<int>(BootStep::start);
       ++step)
    if (step != static_cast<int>(BootStep::sync)) {
      EXPECT_NE(said(static_cast<BootStep>(step), 0x2000).find("(of a device without it: "),
                std::string::npos)
          << step;
    }
  EXPECT_EQ(said(BootStep::abort_connection, 0x6007, BootProblem::no_answer).find("without it"),
            std::string::npos)
      << "whoever is silent has nothing to be excused";
}

TEST(BusEventText, prefers_the_drives_own_words_for_its_error_codes) {
  DriveProfile profile;
  profile.error_texts = {{0xFF01, "encoder battery low", "разряжена батарея датчика"},
                         {0xFF02, "door open", ""}};
  EXPECT_EQ(describe_error_code(0xFF01, &profile, Language::english), "encoder battery low");
  EXPECT_EQ(describe_error_code(0xFF01, &profile, Language::russian), "разряжена батарея датчика");
  EXPECT_EQ(describe_error_code(0xFF02, &profile, Language::russian), "door open");
  EXPECT_EQ(describe_error_code(0x8611, &profile, Language::english), "following error");
  EXPECT_EQ(describe_error_code(0x8611, nullptr, Language::russian), "ошибка рассогласования");
}

}  // namespace
}  // namespace servogate::canopen
