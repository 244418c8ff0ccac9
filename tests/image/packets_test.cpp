// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/packets.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/put_bit.hpp"
#include "tests/places/places.hpp"

namespace servogate::image {
namespace {

Place place(const char* text) {
  const auto p = parse_place(text);
  EXPECT_TRUE(p.has_value()) << text;
  return p.value_or(Place{});
}

TEST(Packets, a_byte_covers_eight_bits_and_no_neighbour) {  // T-SA-11
  Packets p;
  ASSERT_TRUE(p.set_number(place("SA3.BY"), 255));
  for (int i = 24; i <= 31; ++i) EXPECT_TRUE(p.bit({Packet::a, Format::bl, static_cast<std::uint32_t>(i)}));
  EXPECT_FALSE(p.bit(place("SA23")));
  EXPECT_FALSE(p.bit(place("SA32")));
}

TEST(Packets, the_default_format_is_bit_for_a_and_byte_for_k_and_syvar) {  // T-SA-12, T-SA-14
  Packets p;
  p.set_number(place("SA128"), 1);
  EXPECT_EQ(p.data(Packet::a)[16], 1);
  p.set_number(place("SK7"), 65);
  EXPECT_EQ(p.data(Packet::k)[7], 65);
  p.set_number(place("SYVAR4"), 9);
  EXPECT_EQ(p.data(Packet::v)[4], 9);
}

TEST(Packets, a_bit_of_k_is_addressed_over_the_whole_packet) {  // T-SA-13
  Packets p;
  p.data(Packet::k)[100] = 1;
  p.set_number(place("SA12"), p.number(place("SK800.BL")));
  EXPECT_EQ(p.data(Packet::a)[1], 0x10);
}

TEST(Packets, characters_fill_their_bytes_and_pad_with_spaces) {  // T-SA-15
  Packets p;
  p.data(Packet::k)[10] = 77;
  ASSERT_TRUE(p.set_characters(place("SK7.3CH"), "RIF"));
  EXPECT_EQ(p.characters(place("SK7.3CH")), "RIF");
  EXPECT_EQ(p.data(Packet::k)[10], 77);
  ASSERT_TRUE(p.set_characters(place("SK7.3CH"), "R"));
  EXPECT_EQ(p.characters(place("SK7.3CH")), "R  ");
  EXPECT_FALSE(p.set_characters(place("SK7.3CH"), "RIFF"));
}

TEST(Packets, words_are_little_endian_and_overlay_their_bytes) {  // T-SYV-11 to T-SYV-13
  Packets p;
  p.set_number(place("SYVAR1.IN"), 268);
  EXPECT_EQ(p.data(Packet::v)[2], 0x0c);
  EXPECT_EQ(p.data(Packet::v)[3], 0x01);
  p.set_number(place("SYVAR1.LI"), 66051);
  EXPECT_EQ(p.data(Packet::v)[4], 3);
  EXPECT_EQ(p.data(Packet::v)[7], 0);
  p.set_number(place("SYVAR2.LR"), 1.5);
  EXPECT_EQ(p.data(Packet::v)[22], 0xf8);
  EXPECT_EQ(p.data(Packet::v)[23], 0x3f);
}

TEST(Packets, places_outside_are_refused_and_nothing_is_stored) {  // T-SA-16, T-SYV-16
  Packets p;
  EXPECT_TRUE(p.set_number(place("SA8191"), 1));
  EXPECT_EQ(p.data(Packet::a)[1023], 0x80);
  EXPECT_FALSE(p.set_number(place("SA8192"), 1));
  EXPECT_FALSE(p.set_number(place("SYVAR200"), 1));
  EXPECT_FALSE(p.set_number(place("SK5"), 256));
  EXPECT_FALSE(p.set_number(place("SK5"), -1));
  EXPECT_FALSE(p.set_number(place("SA5"), 2));
}

TEST(Packets, every_byte_overlays_exactly_its_bits_words_and_reals) {  // T-SA-17
  std::mt19937 random(1);
  for (std::uint32_t i = 0; i < kPacketASize; ++i) {
    Packets p;
    p.set_number({Packet::a, Format::by, i}, 1 + random() % 255);
    for (std::uint32_t j = 0; j < kPacketASize; ++j) {
      const Place byte{Packet::a, Format::by, i}, bit{Packet::a, Format::bl, j * 8},
          word{Packet::a, Format::in, j / 2}, real{Packet::a, Format::lr, j / 8};
      EXPECT_EQ(byte.overlaps(bit), i == j);
      EXPECT_EQ(byte.overlaps(word), i / 2 == j / 2);
      EXPECT_EQ(byte.overlaps(real), i / 8 == j / 8);
      EXPECT_EQ(p.data(Packet::a)[j] != 0, i == j);
    }
  }
}

TEST(Place, text_and_place_are_inverse_for_every_format) {
  for (const char* text :
       {"SA12.BL", "SK7.3CH", "SYVAR2.LR", "SK0.BY", "SA4.IN", "SK9.LI", "SYVAR1.RE", "SK1.CH"})
    EXPECT_EQ(to_string(place(text)), text);
  EXPECT_EQ(to_string(place("SK")), "SK0.BY");
  for (const char* bad :
       {"SB1", "SA1.XX", "SA1.", "SA1.3BY", "SK1.33CH", "SA-1", "SA1.BYX", "", "SK99999999999"})
    EXPECT_FALSE(parse_place(bad)) << bad;
}

TEST(InterfaceMap, no_two_places_of_the_interface_overlap_and_all_lie_in_k) {
  const auto symbols = interface_symbols(
      5, {"X", "Y", "Z", "A", "B", "C", "U", "V", "W", "P", "Q", "D", "E", "F", "G", "H"}, 2, 0xFFFE);
  Packets p;
  p.resize(motion_base(16), kSyvarDefaultSize);
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    EXPECT_TRUE(p.contains(symbols[i].place)) << symbols[i].name;
    EXPECT_GE(symbols[i].place.byte(), kInterfaceBase);
    for (std::size_t j = i + 1; j < symbols.size(); ++j)
      EXPECT_FALSE(symbols[i].place.overlaps(symbols[j].place)) << symbols[i].name << " " << symbols[j].name;
  }
}

TEST(Packets, integers_are_rounded_to_the_nearest_and_must_fit_then) {
  Packets p;
  const Place by = place("SK5"), in = place("SK10.IN");
  for (const auto& [value, stored] : {std::pair{2.5, 2.0}, {3.5, 4.0}, {-0.4, 0.0}, {255.4, 255.0}}) {
    EXPECT_TRUE(p.set_number(by, value));
    EXPECT_EQ(p.number(by), stored);
  }
  EXPECT_TRUE(p.set_number(in, -32768.5));
  EXPECT_EQ(p.number(in), -32768.0);
  for (const double beyond : {255.5, -0.6, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    p.set_number(by, 7);
    EXPECT_FALSE(p.set_number(by, beyond));
    EXPECT_EQ(p.number(by), 7.0);
  }
}

TEST(Packets, put_bit_does_what_set_bit_does) {
  Packets a, b;
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Place bit{random() % 2 ? Packet::a : Packet::k, Format::bl,
                    static_cast<std::uint32_t>(random() % (9 * kPacketASize))};
    const bool on = random() % 2;
    a.set_bit(bit, on);
    put_bit(b, bit, on);
    EXPECT_EQ(a.bit(bit), b.bit(bit));
  }
  EXPECT_EQ(std::memcmp(a.data(Packet::a), b.data(Packet::a), kPacketASize), 0);
  EXPECT_EQ(std::memcmp(a.data(Packet::k), b.data(Packet::k), kPacketKDefaultSize), 0);
}

TEST(InterfaceMap, a_field_of_the_second_process_lies_one_block_further) {
  constexpr Place strobe = field(kProcessFields, "m_strobe", kInterfaceBase);
  constexpr Place second = field(kProcessFields, "m_strobe", process_base(1));
  EXPECT_EQ(at(strobe, kProcessBlock), second);
  for (const Symbol& s : interface_symbols(2, {"X"}, 1))
    if (s.name == "NC2.m_strobe") {
      EXPECT_EQ(s.place, at(strobe, kProcessBlock));
    }
}

TEST(InterfaceMap, its_page_in_the_documents_says_what_the_tables_say) {
  std::ifstream in(tests::source_dir() + "/docs/interface.md", std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_EQ(page, interface_page());
}

}  // namespace
}  // namespace servogate::image
