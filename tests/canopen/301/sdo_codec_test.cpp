// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace servogate::canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

SdoBytes bytes(std::initializer_list<int> values) {
  SdoBytes out{};
  std::ranges::transform(values, out.begin(), [](int v) { return static_cast<std::uint8_t>(v); });
  return out;
}

// Byte sequences written out from CiA 301, 7.2.4.3.3 to 7.2.4.3.8.

TEST(SdoRequest, expedited_downloads_say_how_many_bytes_are_unused) {
  EXPECT_EQ(sdo_request::download_expedited(0x6060, 0, Bytes{8}),
            bytes({0x2F, 0x60, 0x60, 0x00, 8, 0, 0, 0}));
  EXPECT_EQ(sdo_request::download_expedited(0x1017, 0, Bytes{0x64, 0}),
            bytes({0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0}));
  EXPECT_EQ(sdo_request::download_expedited(0x2000, 1, Bytes{1, 2, 3}),
            bytes({0x27, 0, 0x20, 1, 1, 2, 3, 0}));
  EXPECT_EQ(sdo_request::download_expedited(0x1600, 2, Bytes{0x20, 0, 0x7A, 0x60}),
            bytes({0x23, 0x00, 0x16, 0x02, 0x20, 0x00, 0x7A, 0x60}));
}

TEST(SdoRequest, segmented_downloads_announce_their_length) {
  EXPECT_EQ(sdo_request::download_segmented(0x1F50, 1, 0x01020304), bytes({0x21, 0x50, 0x1F, 1, 4, 3, 2, 1}));
  EXPECT_EQ(sdo_request::download_segment(false, Bytes{1, 2, 3, 4, 5, 6, 7}, false),
            bytes({0x00, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(sdo_request::download_segment(true, Bytes{9, 8}, true), bytes({0x1B, 9, 8, 0, 0, 0, 0, 0}));
}

TEST(SdoRequest, uploads_have_no_data) {
  EXPECT_EQ(sdo_request::upload(0x1018, 1), bytes({0x40, 0x18, 0x10, 1, 0, 0, 0, 0}));
  EXPECT_EQ(sdo_request::upload_segment(false), bytes({0x60, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sdo_request::upload_segment(true), bytes({0x70, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(SdoResponse, has_the_specifiers_of_the_server) {
  EXPECT_EQ(sdo_response::download(0x6060, 0), bytes({0x60, 0x60, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sdo_response::download_segment(true), bytes({0x30, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sdo_response::upload_expedited(0x1000, 0, Bytes{0x92, 1, 2, 0}),
            bytes({0x43, 0, 0x10, 0, 0x92, 1, 2, 0}));
  EXPECT_EQ(sdo_response::upload_expedited(0x6061, 0, Bytes{8}), bytes({0x4F, 0x61, 0x60, 0, 8, 0, 0, 0}));
  EXPECT_EQ(sdo_response::upload_segmented(0x1008, 0, 18), bytes({0x41, 0x08, 0x10, 0, 18, 0, 0, 0}));
  EXPECT_EQ(sdo_response::upload_segment(true, Bytes{'a', 'b', 'c'}, true),
            bytes({0x19, 'a', 'b', 'c', 0, 0, 0, 0}));
}

TEST(SdoAbort, carries_object_and_code) {
  EXPECT_EQ(sdo_abort(0x1601, 3, AbortCode::cannot_be_mapped), bytes({0x80, 0x01, 0x16, 3, 0x41, 0, 4, 6}));
}

TEST(SdoParse, takes_an_expedited_upload_apart) {
  const SdoFrame f = parse_sdo_response(bytes({0x4B, 0x41, 0x60, 0, 0x37, 0x06, 0xAA, 0xBB}));
  EXPECT_EQ(f.command, SdoCommand::upload_initiate);
  EXPECT_EQ(f.index, 0x6041);
  EXPECT_EQ(f.subindex, 0);
  EXPECT_TRUE(f.expedited);
  ASSERT_EQ(f.size, 2);
  EXPECT_EQ(f.data[0], 0x37);
  EXPECT_EQ(f.data[1], 0x06);
  EXPECT_EQ(f.data[2], 0) << "bytes beyond the size are not data";
}

TEST(SdoParse, an_expedited_answer_without_a_size_has_four_bytes) {
  const SdoFrame f = parse_sdo_response(bytes({0x42, 0x41, 0x60, 0, 1, 2, 3, 4}));
  EXPECT_FALSE(f.size_indicated);
  EXPECT_EQ(f.size, 4);
}

TEST(SdoParse, a_segmented_initiate_without_a_size_announces_nothing) {
  const SdoFrame f = parse_sdo_response(bytes({0x40, 0x08, 0x10, 0, 1, 2, 3, 4}));
  EXPECT_FALSE(f.expedited);
  EXPECT_EQ(f.total, 0u);
}

TEST(SdoParse, the_same_specifier_means_different_things_per_direction) {
  EXPECT_EQ(parse_sdo_request(bytes({0x60})).command, SdoCommand::upload_segment);
  EXPECT_EQ(parse_sdo_response(bytes({0x60})).command, SdoCommand::download_initiate);
  EXPECT_EQ(parse_sdo_request(bytes({0x20})).command, SdoCommand::download_initiate);
  EXPECT_EQ(parse_sdo_response(bytes({0x20})).command, SdoCommand::download_segment);
  EXPECT_EQ(parse_sdo_request(bytes({0xC6})).command, SdoCommand::block_download);
  EXPECT_EQ(parse_sdo_request(bytes({0xA4})).command, SdoCommand::block_upload);
  EXPECT_EQ(parse_sdo_response(bytes({0xA4})).command, SdoCommand::block_download);
  EXPECT_EQ(parse_sdo_response(bytes({0xC6})).command, SdoCommand::block_upload);
}

TEST(SdoParse, anything_but_eight_bytes_and_specifier_seven_is_invalid) {
  const SdoBytes good = sdo_request::upload(0x1000, 0);
  for (std::size_t n = 0; n < 8; ++n)
    EXPECT_EQ(parse_sdo_request(std::span(good).first(n)).command, SdoCommand::invalid) << n;
  EXPECT_EQ(parse_sdo_request(bytes({0xE0})).command, SdoCommand::invalid);
  EXPECT_EQ(parse_sdo_response(bytes({0xFF})).command, SdoCommand::invalid);
}

TEST(SdoParse, reads_back_every_random_frame_that_was_built) {
  constexpr unsigned kSeed = 20261121;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 20'000; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    const auto index = static_cast<std::uint16_t>(random());
    const auto subindex = static_cast<std::uint8_t>(random());
    Bytes data(1 + random() % 7);
    for (auto& b : data) b = static_cast<std::uint8_t>(random());
    const bool toggle = random() % 2, last = random() % 2, upload = random() % 2;

    const SdoBytes raw = upload ? sdo_response::upload_segment(toggle, data, last)
                                : sdo_request::download_segment(toggle, data, last);
    const SdoFrame segment = upload ? parse_sdo_response(raw) : parse_sdo_request(raw);
    ASSERT_EQ(segment.command, upload ? SdoCommand::upload_segment : SdoCommand::download_segment);
    ASSERT_EQ(segment.toggle, toggle);
    ASSERT_EQ(segment.last, last);
    ASSERT_EQ(Bytes(segment.data.begin(), segment.data.begin() + segment.size), data);

    data.resize(1 + random() % 4);
    const SdoBytes short_raw = upload ? sdo_response::upload_expedited(index, subindex, data)
                                      : sdo_request::download_expedited(index, subindex, data);
    const SdoFrame expedited = upload ? parse_sdo_response(short_raw) : parse_sdo_request(short_raw);
    ASSERT_TRUE(expedited.expedited && expedited.size_indicated);
    ASSERT_EQ(expedited.index, index);
    ASSERT_EQ(expedited.subindex, subindex);
    ASSERT_EQ(Bytes(expedited.data.begin(), expedited.data.begin() + expedited.size), data);
  }
}

TEST(AbortText, every_code_of_the_standard_has_its_own_words) {
  constexpr AbortCode kCodes[] = {AbortCode::toggle_not_alternated,
                                  AbortCode::timed_out,
                                  AbortCode::command_specifier_invalid,
                                  AbortCode::block_size_invalid,
                                  AbortCode::sequence_number_invalid,
                                  AbortCode::crc_error,
                                  AbortCode::out_of_memory,
                                  AbortCode::unsupported_access,
                                  AbortCode::write_only,
                                  AbortCode::read_only,
                                  AbortCode::object_does_not_exist,
                                  AbortCode::cannot_be_mapped,
                                  AbortCode::mapping_too_long,
                                  AbortCode::parameter_incompatible,
                                  AbortCode::internal_incompatible,
                                  AbortCode::hardware_error,
                                  AbortCode::length_mismatch,
                                  AbortCode::length_too_high,
                                  AbortCode::length_too_low,
                                  AbortCode::subindex_does_not_exist,
                                  AbortCode::value_invalid,
                                  AbortCode::value_too_high,
                                  AbortCode::value_too_low,
                                  AbortCode::maximum_below_minimum,
                                  AbortCode::resource_not_available,
                                  AbortCode::general_error,
                                  AbortCode::cannot_transfer,
                                  AbortCode::local_control,
                                  AbortCode::device_state,
                                  AbortCode::no_object_dictionary,
                                  AbortCode::no_data_available};
  std::set<std::string_view> seen;
  for (const AbortCode code : kCodes) {
    const text::Entry& entry = abort_text(code);
    EXPECT_TRUE(seen.insert(entry.english).second) << entry.english;
    EXPECT_FALSE(entry.russian.empty());
    EXPECT_NE(entry.id, "sdo-abort-unknown");
  }
  EXPECT_EQ(abort_text(static_cast<AbortCode>(0x06040099)).id, "sdo-abort-unknown");
}

}  // namespace
}  // namespace servogate::canopen
