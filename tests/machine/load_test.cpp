// SPDX-License-Identifier: Apache-2.0
#include "machine/load.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

using test::example;
using test::source;

LoadResult mill() { return parse(example("mill"), source("examples/mill/machine.toml")); }
LoadResult lathe() { return parse(example("lathe"), source("examples/lathe/machine.toml")); }

TEST(MachineFile, mill_reads_without_a_finding) {
  EXPECT_EQ(test::lines_of(mill().findings, text::Language::english), "");
}

TEST(MachineFile, says_of_the_simulation_of_real_inputs_nothing_as_it_has_no_effect_on_them) {
  std::string text = example("mill");
  for (const auto& [mock, real] : {std::pair<std::string, std::string>{"mock:gpio", "chip:gpiochip0"},
                                   {"mock:panel", "rtu:/dev/ttyUSB0"}}) {
    const std::size_t at = text.find(mock);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, mock.size(), real);
    const LoadResult loaded = parse(text, source("examples/mill/machine.toml"));
    EXPECT_FALSE(loaded.machine.nothing_real()) << real;
    for (const text::Finding& f : loaded.findings)
      EXPECT_EQ(f.severity, text::Severity::warning) << f.str(text::Language::english);
  }
}

TEST(MachineFile, a_line_has_even_parity_unless_it_says_another) {
  EXPECT_EQ(mill().machine.lines.at(0).parity, LineParity::even);
  std::string text = example("mill");
  const std::string url = "url = \"mock:panel\"";
  text.replace(text.find(url), url.size(), "url = \"rtu:/dev/ttyUSB0\"\nparity = \"none\"\nstop_bits = 1");
  const LoadResult loaded = parse(text, source("examples/mill/machine.toml"));
  EXPECT_EQ(loaded.machine.lines.at(0).parity, LineParity::none);
  EXPECT_EQ(loaded.machine.lines.at(0).stop_bits, 1);
}

TEST(MachineFile, lathe_reads_without_a_finding) {
  EXPECT_EQ(test::lines_of(lathe().findings, text::Language::english), "");
}

TEST(MachineFile, mill_has_the_declared_control) {
  const MachineConfig m = mill().machine;
  EXPECT_EQ(m.cycle_ns(), 1'000'000);
  EXPECT_EQ(m.control.cycle_time, 0.001);
  EXPECT_EQ(m.control.contour_tolerance, 0.01);
  EXPECT_EQ(m.control.power_on, (std::vector<std::string>{"G94", "G97", "G90", "G71", "G27"}));
  EXPECT_EQ(m.control.variables, (std::map<std::string, double>{{"ERF", 0.01}, {"MCD", 2}}));
  EXPECT_TRUE(m.nothing_real());
}

TEST(MachineFile, mill_axes_have_the_declared_limits) {
  const MachineConfig m = mill().machine;
  ASSERT_EQ(m.letters(), (std::vector<std::string>{"X", "Y", "Z"}));
  for (const AxisConfig& a : m.axes) {
    EXPECT_EQ(a.travel_min, -300.0);
    EXPECT_EQ(a.travel_max, 300.0);
    EXPECT_EQ(a.home.position, 0.0);
    EXPECT_EQ(a.home.method, HomingMethod::switch_and_index);
    EXPECT_EQ(a.max_velocity, 500.0);
    EXPECT_EQ(a.max_acceleration, 1000.0);
    EXPECT_EQ(a.max_jerk, 10000.0);
    EXPECT_DOUBLE_EQ(a.counts_per_unit(), 26214.4);
    EXPECT_DOUBLE_EQ(a.motor_rpm(500.0), 3000.0);
  }
  EXPECT_TRUE(m.axes[2].vertical);
  EXPECT_TRUE(m.axes[2].brake.present());
  EXPECT_FALSE(m.axes[0].brake.present());
}

TEST(MachineFile, mill_points_lie_where_programs_expect_them) {
  const MachineConfig m = mill().machine;
  const std::pair<const char*, const char*> expected[] = {
      {"x_limit_plus", "SA0"},    {"x_limit_minus", "SA1"},
      {"z_limit_minus", "SA5"},   {"x_home", "SA6"},
      {"z_home", "SA8"},          {"door_closed", "SA16"},
      {"estop_chain_ok", "SA17"}, {"air_ok", "SA18"},
      {"tool_clamped", "SA19"},   {"spindle_contactor", "SA64"},
      {"coolant", "SA65"},        {"mist", "SA66"},
      {"lamp_green", "SA67"},     {"lamp_red", "SA68"},
      {"tool_release", "SA69"},   {"control_alive_relay", "SA70"},
      {"air_blast", "SA72"},      {"spindle_load", "SA16.IN"}};
  for (const auto& [name, place] : expected) {
    const PointConfig* p = m.point(name);
    ASSERT_NE(p, nullptr) << name;
    EXPECT_EQ(to_string(p->place), to_string(*image::parse_place(place))) << name;
  }
  EXPECT_EQ(m.point("air_blast")->writer, image::Writer::program);
  EXPECT_EQ(m.point("coolant")->writer, image::Writer::plc);
  EXPECT_EQ(m.point("air_ok")->writer, image::Writer::input);
}

TEST(MachineFile, mill_station_has_the_declared_channels) {
  const LoadResult loaded = mill();
  int station = -1;
  ASSERT_NE(loaded.machine.point("coolant", &station), nullptr);
  const DeviceConfig* device =
      loaded.device(loaded.machine.stations[static_cast<std::size_t>(station)].device);
  ASSERT_NE(device, nullptr);
  EXPECT_EQ(device->modbus.di_count, 16);
  EXPECT_EQ(device->modbus.dq_count, 16);
  EXPECT_EQ(device->modbus.ai_count, 4);
  EXPECT_EQ(device->modbus.aq_count, 2);
}

TEST(MachineFile, nine_switches_of_the_mill_follow_its_axes) {
  const MachineConfig m = mill().machine;
  ASSERT_EQ(m.simulation.switches.size(), 9u);
  for (const SimulatedSwitch& s : m.simulation.switches) {
    EXPECT_GE(m.axis_index(s.axis), 0);
    int station = -1;
    ASSERT_NE(m.point(s.point, &station), nullptr);
    EXPECT_EQ(m.stations[static_cast<std::size_t>(station)].kind, StationKind::gpio);
  }
  EXPECT_EQ(m.simulation.operator_closes, std::vector<std::string>{"estop_chain_ok"});
}

/// Leaving the switch, the next zero mark has to be the one at the home position, and not close to the edge.
TEST(MachineFile, home_switches_of_the_examples_stand_a_good_way_before_their_mark) {
  for (const LoadResult& loaded : {mill(), lathe()})
    for (const AxisConfig& a : loaded.machine.axes) {
      const double turn = a.lead * static_cast<double>(a.gear[1]) / static_cast<double>(a.gear[0]);
      for (const SimulatedSwitch& s : loaded.machine.simulation.switches) {
        if (s.point != a.home.switch_point) continue;
        const double edge = a.home.index_direction == Direction::plus ? s.to : s.from;
        const double way = std::abs(edge - a.home.position);
        EXPECT_GT(way, 0.15 * turn) << a.letter;
        EXPECT_LT(way, 0.85 * turn) << a.letter;
        EXPECT_NEAR(std::remainder(a.home.position, turn), 0.0, 1e-9) << a.letter;
      }
    }
}

TEST(MachineFile, lathe_is_in_diameter_with_spindle_encoder_and_turret) {
  const MachineConfig m = lathe().machine;
  ASSERT_EQ(m.letters(), (std::vector<std::string>{"X", "Z"}));
  EXPECT_TRUE(m.axes[0].diameter);
  EXPECT_TRUE(m.spindles.at(0).has_encoder());
  EXPECT_DOUBLE_EQ(m.axes[0].counts_per_unit(), 131072.0 * 3 / 2 / 5);
  for (const char* name : {"turret_motor", "turret_pos_1", "turret_pos_2", "turret_pos_3", "turret_locked"})
    EXPECT_NE(m.point(name), nullptr) << name;
  ASSERT_EQ(m.simulation.indexers.size(), 1u);
  EXPECT_EQ(m.simulation.indexers[0].inputs.size(), 3u);
}

TEST(MachineFile, every_key_remembers_its_place) {
  const LoadResult loaded = parse("schema = 1\nname = 'a'\n[[axis]]\nletter = 'X'\n  lead = 5\n", "m.toml");
  EXPECT_EQ(loaded.machine.where("axis.0.lead").line, 5);
  EXPECT_EQ(loaded.machine.where("axis.0.lead").column, 10);
  // What is not there is where its table is; what has no table is the file.
  EXPECT_EQ(loaded.machine.where("axis.0.home.fast").line, 3);
  EXPECT_EQ(loaded.machine.where("control.cycle_time").line, 1);
}

TEST(MachineFile, numbers_with_and_without_units_are_the_same) {
  const auto speed = [](const std::string& value) {
    const LoadResult r = parse("[[axis]]\nletter = 'X'\nmax_velocity = " + value + "\n", "m.toml");
    return r.machine.axes.at(0).max_velocity;
  };
  EXPECT_EQ(speed("500"), 500.0);
  EXPECT_EQ(speed("500.0"), 500.0);
  EXPECT_EQ(speed("'500 mm/s'"), 500.0);
  EXPECT_EQ(speed("'0.5 m/s'"), 500.0);
  EXPECT_EQ(speed("'30 m/min'"), 500.0);
  EXPECT_EQ(speed("'30000mm/min'"), 500.0);
  EXPECT_EQ(speed("' +5e2 mm/s '"), 500.0);
}

TEST(MachineFile, decimal_fractions_of_a_unit_are_the_nearest_double) {
  for (int us : {250, 500, 750, 1000, 1250, 2000, 4000}) {
    const LoadResult r = parse("[control]\ncycle_time = '" + std::to_string(us) + " us'\n", "m.toml");
    EXPECT_EQ(r.machine.cycle_ns(), us * 1000);
    EXPECT_EQ(r.machine.control.cycle_time, us / 1e6);
  }
}

TEST(MachineFile, a_rotary_axis_is_in_degrees) {
  const LoadResult r = parse(
      "[[axis]]\nletter = 'C'\nlead = '360 deg/rev'\nmax_velocity = '20 rpm'\ntype = 'rotary'\n"
      "travel_min = 0\ntravel_max = 0\n",
      "m.toml");
  EXPECT_EQ(r.machine.axes.at(0).max_velocity, 120.0);
  EXPECT_TRUE(r.machine.axes.at(0).endless());
}

TEST(MachineFile, lists_keep_the_order_of_the_file) {
  const LoadResult r =
      parse("[[axis]]\nletter = 'Z'\n[[axis]]\nletter = 'A'\n[[axis]]\nletter = 'M'\n", "m.toml");
  EXPECT_EQ(r.machine.letters(), (std::vector<std::string>{"Z", "A", "M"}));
}

TEST(MachineFile, symbol_table_holds_points_symbols_and_the_interface) {
  std::string text =
      example("mill") + "\n[[symbol]]\nname = \"parts_wanted\"\nplace = \"SK0.LI\"\nwriter = \"program\"\n";
  const LoadResult r = parse(text, source("examples/mill/machine.toml"));
  EXPECT_TRUE(r.ok());
  const std::vector<image::Symbol> symbols = r.machine.symbol_table();
  const auto has = [&](std::string_view name) {
    return std::any_of(symbols.begin(), symbols.end(),
                       [&](const image::Symbol& s) { return s.name == name; });
  };
  for (const char* name : {"parts_wanted", "coolant", "NC.m_strobe", "X.homed", "S.at_speed", "MC.estop_ok"})
    EXPECT_TRUE(has(name)) << name;
}

TEST(MachineFile, a_file_that_does_not_exist_is_a_finding) {
  const LoadResult r = load("/nowhere/machine.toml");
  ASSERT_EQ(r.findings.size(), 1u);
  EXPECT_FALSE(r.ok());
  EXPECT_EQ(r.findings[0].str(text::Language::english),
            "/nowhere/machine.toml:1:1: error: the file cannot be read: No such file or directory "
            "[machine.file_missing]");
}

TEST(MachineFile, syntax_errors_are_said_in_russian_too_and_the_words_that_nobody_translated_are_quoted) {
  const struct {
    const char *text, *said;
  } rows[] = {
      {"name \"a\"\n",
       "m.toml:1:6: error: синтаксис TOML: при чтении пары «ключ = значение»: "
       "ожидается «=», а стоит «\"» [machine.syntax]"},
      {"name\n", "ожидается «=», а стоит «конец строки»"},
      {"name =\n", "нет значения, стоит «конец строки»"},
      {"name = abc\n", "abc — текст и пишется в кавычках"},
      {"name = \"a\n", "строка файла кончилась раньше закрывающей кавычки"},
      {"name = \"a\" b\n", "значение уже кончилось, а дальше стоит «b»"},
      {"a = 1,5\n", "значение уже кончилось, а дальше стоит «,»"},
      {"a = 5mm\n",
       "при чтении целого числа: ожидается цифра, а стоит «m» (значение с единицей пишется в "
       "кавычках)"},
      {"a = \"\\q\"\n", "неизвестное сочетание «\\q»"},
      {"a = 1\na = 2\n",
       "m.toml:2:5: error: синтаксис TOML: при чтении пары «ключ = значение»: ключ «a» уже "
       "есть выше"},
      {"[a]\n[a]\n", "при чтении заголовка таблицы: таблица «a» уже есть выше"},
      {"a = 1\n[a]\n", "«a» уже есть выше и значит другое"},
      {"[a\n", "ожидается «]», а стоит «конец строки»"},
      {"a = [1, 2\n", "при чтении списка: файл кончился раньше времени"},
      {"a = [1 2]\n", "ожидается запятая или «]», а стоит «2»"},
      {"a = 05\n", "число не может начинаться с нуля"},
      {"a = True\n", "ожидается «true», а стоит «T»"},
      {"; a\n", "ожидается ключ, [таблица] или # комментарий, а стоит «;»"},
      {"a = \"\xFF\"\n", "файл записан не в UTF-8"},
      {"a = 2020-01-01T99:00:00\n", "это место не читается; слова читающей его библиотеки: «Error while"},
  };
  for (const auto& row : rows) {
    const std::string lines = test::lines_of(parse(row.text, "m.toml").findings, text::Language::russian);
    EXPECT_NE(lines.find(row.said), std::string::npos) << row.text << lines;
  }
}

TEST(MachineFile, words_put_into_russian_sentences_are_russian) {
  const auto said = [](const std::string& from, const std::string& to) {
    std::string text = example("mill");
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return test::lines_of(parse(text, source("examples/mill/machine.toml")).findings,
                          text::Language::russian);
  };
  const struct {
    const char *from, *to, *words;
  } rows[] = {
      {"letter = \"Y\"", "letter = \"X\"", "«X»: повторяет описание из строки "},
      {"channel = \"di1\"", "channel = \"di0\"", "«di0»: повторяет описание из строки "},
      {"SA25.IN", "SA250", "здесь ожидается слово (SA16.IN, .LI, .RE)"},
      {"min_speed = ", "min_speed = 9000 # ", "min_speed 9000 об/мин не меньше max_speed 6000 об/мин"},
  };
  for (const auto& row : rows) {
    const std::string lines = said(row.from, row.to);
    EXPECT_NE(lines.find(row.words), std::string::npos) << row.to << "\n" << lines;
  }
}

TEST(MachineFile, a_folder_is_no_machine_file) {
  const LoadResult r = load(source("examples"));
  ASSERT_EQ(r.findings.size(), 1u);
  EXPECT_EQ(r.findings[0].entry->id, "machine.file_missing");
}

TEST(MachineFile, device_files_of_the_machine_come_before_those_of_the_product) {
  const std::string folder = test::scratch("own_device");
  std::string device = test::read_text(source("devices/servo-cia402.toml"));
  device.replace(device.find("4500 rpm"), 8, "1000 rpm");
  test::write_text(folder + "/servo-cia402.toml", device);
  const LoadResult r = parse(example("mill"), folder + "/machine.toml");
  ASSERT_NE(r.device("servo-cia402"), nullptr);
  EXPECT_EQ(r.device("servo-cia402")->motor.max_speed, 1000.0);
  EXPECT_EQ(r.device("spindle-cia402-slow")->motor.max_speed, 8000.0);
}

TEST(MachineFile, errors_of_a_device_file_are_said_with_their_own_place) {
  const std::string folder = test::scratch("broken_device");
  test::write_text(folder + "/servo-cia402.toml", "schema = 1\nname = 'x'\nkind = 'robot'\n");
  const LoadResult r = parse(example("mill"), folder + "/machine.toml");
  EXPECT_FALSE(r.ok());
  const std::string said = test::lines_of(r.findings, text::Language::english);
  EXPECT_NE(said.find("machine.toml:34:10: error: device file "), std::string::npos) << said;
  EXPECT_NE(said.find("servo-cia402.toml:3:8: error: `kind`: \"robot\" is not one of"), std::string::npos)
      << said;
}

}  // namespace
}  // namespace servogate::machine
