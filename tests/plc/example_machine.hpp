// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"
#include "tests/places/places.hpp"

namespace servogate::plc {

/// An example's PLC program on a packet image, driven cycle by cycle as NC and machine would.
class ExampleMachine {
 public:
  ExampleMachine(const std::string& source, const std::vector<std::string>& axes,
                 const std::vector<std::pair<std::string, int>>& inputs,
                 const std::vector<std::pair<std::string, int>>& outputs) {
    std::ifstream file(tests::source_dir() + "/" + source);
    std::stringstream text;
    text << file.rdbuf();
    symbols_ = image::interface_symbols(1, axes, 1);
    for (const auto& [name, bit] : inputs) {
      add(name, bit, image::Writer::input);
      if (name == "estop_chain_ok") add("MC.estop_chain", bit, image::Writer::input);  // [safety] estop
    }
    for (const auto& [name, bit] : outputs) add(name, bit, image::Writer::plc);
    CompileResult result = compile({{source, text.str()}}, symbols_);
    for (const text::Finding& f : result.findings) ADD_FAILURE() << f.str(text::Language::english);
    if (result.image) engine_ = std::make_unique<Engine>(result.image);
  }

  double get(const std::string& name) const { return packets.number(place(name)); }
  bool on(const std::string& name) const { return get(name) != 0.0; }
  void set(const std::string& name, double value) {
    ASSERT_TRUE(packets.set_number(place(name), value)) << name;
  }

  /// One cycle of 1 ms.
  void cycle() {
    const ScanResult r = engine_->scan(packets, ms * image::kMillisecond);
    ASSERT_EQ(r.fault, Fault::none) << engine_->describe(r).str(text::Language::english);
    ++ms;
  }
  void cycles(int n) {
    for (int i = 0; i < n; ++i) cycle();
  }
  /// Cycles until a place has a value; returns how many, -1 after `most`.
  int until(const std::string& name, double value, int most = 20'000) {
    for (int n = 1; n <= most; ++n) {
      cycle();
      if (get(name) == value) return n;
    }
    return -1;
  }
  /// Power on with the chain closed, as an operator does.
  void power_up() {
    set("estop_chain_ok", 1);
    set("door_closed", 1);
    set("MC.power_request", 1);
    set("S.zero_speed", 1);
    cycle();
  }
  void strobe_m(int code) {
    set("NC.m_code", code);
    set("NC.m_strobe", 1);
  }
  /// The NC's side of the end of a handshake: the strobe falls, the acknowledge must follow.
  void finish_m() {
    set("NC.m_strobe", 0);
    EXPECT_EQ(until("NC.m_ack", 0, 2), 1);
    EXPECT_FALSE(on("NC.m_unknown"));
  }

  image::Packets packets;
  std::int64_t ms = 0;

 private:
  void add(const std::string& name, int bit, image::Writer writer) {
    symbols_.push_back(
        {name, {image::Packet::a, image::Format::bl, static_cast<std::uint32_t>(bit), 1}, writer, ""});
  }
  image::Place place(const std::string& name) const {
    for (const image::Symbol& s : symbols_)
      if (s.name == name) return s.place;
    ADD_FAILURE() << "no symbol " << name;
    return {};
  }
  std::vector<image::Symbol> symbols_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace servogate::plc
