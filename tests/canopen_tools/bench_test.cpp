// SPDX-License-Identifier: Apache-2.0
// `servogate bench` against drives in other processes, seen only through the bus.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <numbers>

#include "tests/canopen_tools/lockstep_bench.hpp"
#include "tests/comes.hpp"

namespace servogate::canopen_tools {
namespace {

class Lockstep : public LockstepBench {
 protected:
  int seen_ = 0;  ///< calls so far
};

constexpr const char* kSmall = " --travel -3..3 --speed 5 --torque 1 --i-may-move";

TEST_F(Lockstep, a_move_arrives_and_says_how_exactly) {
  for (const char* mode : {"csp", "pp"}) {
    const Ended ended = bench("move $DRIVE -1.5 --mode " + std::string(mode) + kSmall);
    EXPECT_EQ(ended.code, 0) << mode << ended.err;
    EXPECT_TRUE(ended.out_has("stands at -1.5 rev") || ended.out_has("stands at -1.49") ||
                ended.out_has("stands at -1.50"))
        << ended.out;
    EXPECT_NEAR(meta()["figures"]["position_rev"], -1.5, 0.005) << mode;
    EXPECT_EQ(meta()["off"], true);
    EXPECT_TRUE(ended.err_has("Operation enabled")) << "live values: " << ended.err;
  }
}

TEST_F(Lockstep, a_jog_turns_in_every_mode_and_ends_by_itself_where_the_travel_ends) {
  for (const char* mode : {"csp", "csv", "pv", "vl"}) {
    const Ended ended = bench("jog $DRIVE 1 --mode " + std::string(mode) + kSmall);
    EXPECT_EQ(ended.code, 0) << mode << ended.err;
    EXPECT_EQ(meta()["figures"]["ended_by"], "travel") << mode;
    EXPECT_NEAR(meta()["figures"]["mean_speed_rev_s"], 1.0, 0.05) << mode;
    EXPECT_GT(meta()["figures"]["position_rev"], 2.0) << mode;
    EXPECT_LT(meta()["figures"]["position_rev"], 3.0) << mode;
  }
  for (const char* mode : {"cst", "tq"}) {
    const Ended ended = bench("jog $DRIVE 0.05 --duration 0.3 --mode " + std::string(mode) + kSmall,
                              "friction=0.02,inertia=0.01");
    EXPECT_EQ(ended.code, 0) << mode << ended.err;
    EXPECT_EQ(meta()["figures"]["ended_by"], "duration") << mode;
    EXPECT_NEAR(meta()["figures"]["mean_torque_nm"], 0.05, 0.01) << mode;
  }
}

TEST_F(Lockstep, any_key_of_the_terminal_ends_a_jog_by_its_ramp) {
  // `script` is a terminal; the key comes once the drive turns. The travel lasts for hours of granted time.
  const Ended ended = on_drive(
      "--version >seen; ( until grep -q 'Operation enabled' seen; do sleep 0.02; done; printf x ) | script "
      "-qefc \"$SG bench jog $DRIVE 1 --mode csv --travel -3..90000 --speed 5 --torque 1 --i-may-move "
      "--listen 0.1 "
      "--out keyed\" seen",
      "friction=0.02");
  EXPECT_EQ(ended.code, 0) << desk_.text("seen");
  const json kept = json::parse(desk_.text("keyed/meta.json"), nullptr, false);
  EXPECT_EQ(kept["figures"]["ended_by"], "key") << kept;
  EXPECT_LT(kept["figures"]["position_rev"], 89000.0);
  EXPECT_EQ(kept["off"], true);
}

TEST_F(Lockstep, a_jog_that_would_leave_its_envelope_gets_no_power) {
  const Ended ended = bench("jog $DRIVE 6" + std::string(kSmall));
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("--speed")) << ended.err;
  const std::string samples = desk_.text(out_ + "/samples.csv");
  EXPECT_EQ(samples.find(",0x1637"), std::string::npos) << "Operation enabled";
}

TEST_F(Lockstep, a_torque_is_looked_at_by_the_least_inertia_before_the_drive_has_power) {
  const std::string words = "run $DRIVE --signal step --loop torque --amplitude 0.1 --duration 0.2";
  const Ended unknown = bench(words + kSmall);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(unknown.err_has("--inertia")) << unknown.err;
  const Ended far = bench(words + " --inertia 0.0001" + kSmall);  // 200 rad/s
  EXPECT_EQ(far.code, 1);
  EXPECT_TRUE(far.err_has("--speed")) << far.err;
  EXPECT_EQ(desk_.text(out_ + "/samples.csv").find(",0x1637"), std::string::npos) << "Operation enabled";
  const Ended good = bench(words + " --inertia 0.001" + kSmall, "friction=0.02,inertia=0.001");
  EXPECT_EQ(good.code, 0) << good.err;
}

TEST_F(Lockstep, the_travel_is_kept_behind_the_quick_stop_of_the_drive) {
  // 100 rev/s2 of the simulated drive: from 20 rev/s it needs 2 rev.
  const std::string words = " --speed 25 --torque 5 --acceleration 80 --i-may-move --travel ";
  const Ended ended = bench("jog $DRIVE 20 --mode csv" + words + "-1..8", "friction=0.02,inertia=0.0005");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NEAR(meta()["drive"]["quick_stop_rev_s2"], 100.0, 1e-6);
  const Ended hard =
      bench("run $DRIVE --signal step --loop velocity --amplitude 20 --duration 0.3" + words + "-1..7",
            "friction=0.02,inertia=0.0005");
  EXPECT_EQ(hard.code, 1) << "6 rev and 2 to brake";
  EXPECT_TRUE(hard.err_has("--travel")) << hard.err;
}

TEST_F(Lockstep, what_a_run_that_was_cut_off_has_left_is_put_right_by_the_next_one) {
  std::filesystem::create_directories(path("killed"));
  const auto cut_off = [&](int during) {
    // As a run leaves it: the simulated drive has 3000 in 6072h.
    const json file{
        {"schema", 1},
        {"bus", "lockstep:unix:" + path("lockstep-" + std::to_string(++seen_)) + "/can0"},
        {"node", 5},
        {"product", 65938},
        {"serial", 5},
        {"objects",
         {{{"index", 0x6072}, {"before", {0xC4, 0x09}}, {"during", {during & 255, during >> 8}}}}}};
    desk_.write("killed/changed.json", file.dump());
    return bench("move $DRIVE 0.5 --read 6072" + std::string(kSmall));
  };
  const Ended ended = cut_off(3000);
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.err_has("6072h:00 of node 5 changed; it is 2500 again")) << ended.err;
  EXPECT_EQ(meta()["objects"]["6072h:00"]["before"], 2500);
  EXPECT_EQ(meta()["objects"]["6072h:00"]["after"], 2500) << "read once the limit of the run is taken back";
  EXPECT_FALSE(desk_.has("killed/changed.json"));
  EXPECT_FALSE(desk_.has(out_ + "/changed.json")) << "this run has left nothing";
  const Ended since = cut_off(1000);
  EXPECT_EQ(since.code, 0) << since.err;
  EXPECT_FALSE(since.err_has("again")) << "somebody has written it since: " << since.err;
  EXPECT_EQ(meta()["objects"]["6072h:00"]["before"], 3000);
}

TEST_F(Lockstep, objects_are_recorded_by_pdo_with_the_samples_of_a_run) {
  const Ended ended = bench(
      "jog $DRIVE 1 --duration 0.5 --record velocity_actual,following_error_actual --read dc_link,6078" +
      std::string(kSmall));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::string csv = desk_.text(out_ + "/samples.csv");
  EXPECT_NE(
      csv.find("statusword,\"606Ch:00 Velocity actual value\",\"60F4h:00 Following error actual value\"\n"),
      std::string::npos)
      << csv.substr(0, 300);
  // At the end of the even part the drive's own speed is the one that was asked for.
  const std::size_t stop = csv.find(",stop,");
  ASSERT_NE(stop, std::string::npos);
  const std::string row = csv.substr(csv.rfind('\n', stop) - 60, 60);
  const std::string cells = row.substr(row.find("0x") + 7);
  EXPECT_NEAR(std::stod(cells), 262144.0, 15000.0) << row;
  EXPECT_EQ(meta()["objects"]["6079h:00"]["name"], "DC link circuit voltage");
  EXPECT_EQ(meta()["objects"]["6079h:00"]["before"], meta()["drive"]["dc_link_mv"]);
}

TEST_F(Lockstep, what_the_data_sheet_calls_a_temperature_is_kept_with_every_run) {
  EXPECT_TRUE(drives("9", {"--write-eds", path("servo.eds")}).says("servo.eds: EDS of node 9"));
  std::string sheet = desk_.text("servo.eds");
  const std::size_t list = sheet.find("[ManufacturerObjects]");
  ASSERT_NE(list, std::string::npos);
  const std::size_t end = sheet.find("\n[", list + 1);
  const std::string of_maker = sheet.substr(list, end - list);
  const auto count = std::count(of_maker.begin(), of_maker.end(), '=');
  sheet.replace(list, end - list,
                "[ManufacturerObjects]\nSupportedObjects=" + std::to_string(count) +
                    of_maker.substr(std::min(of_maker.size(), of_maker.find('\n', of_maker.find('=')))) +
                    "\n" + std::to_string(count) + "=0x2f31\n");
  sheet +=
      "\n[2f31]\nParameterName=Heat sink temperature\nObjectType=7\nDataType=0x0003\nAccessType=ro\n"
      "DefaultValue=412\n";
  desk_.write("warm.eds", sheet);
  sheet_ = path("warm.eds");
  const Ended ended = bench("record $DRIVE statusword --rate 500 --duration 0.1 --eds " + sheet_);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json kept = meta()["objects"]["2F31h:00"];
  EXPECT_EQ(kept["name"], "Heat sink temperature") << meta();
  EXPECT_EQ(kept["before"], 412);
  EXPECT_EQ(kept["after"], 412);
}

TEST_F(Lockstep, a_record_gives_no_power_and_has_a_row_a_cycle) {
  const Ended ended = bench("record $DRIVE statusword dc_link 6064 --rate 500 --duration 0.4");
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.out_has("200 rows every 2 ms")) << ended.out;
  const std::string csv = desk_.text(out_ + "/samples.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 201);
  EXPECT_EQ(meta()["figures"]["6064h:00 Position actual value"]["greatest"], 0.0);
  const int status = meta()["figures"]["6041h:00 Statusword"]["greatest"];
  EXPECT_NE(status & 0x6F, 0x27) << "Operation enabled";
  EXPECT_EQ(bench("record $DRIVE statusword 1018:1 --duration 0.1").code, 2) << "no PDO takes the vendor";
  EXPECT_EQ(bench("record $DRIVE 6064 606C 6062 6063 6074 --duration 0.1").code, 2) << "18 bytes";
}

TEST_F(Lockstep, a_response_has_the_margins_of_the_loop_and_a_page_with_its_plots) {
  const Ended ended = bench(
      "response $DRIVE --loop velocity --offset 2 --periods 6 --travel -1..60 --speed 5 --torque 2 "
      "--i-may-move",
      "friction=0.02,velocity-gain=0.3,inertia=0.001");
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.out_has("phase margin")) << ended.out;
  EXPECT_NEAR(meta()["figures"]["crossover_hz"], 0.3 / 0.001 / 6.2832, 6.0);
  EXPECT_GT(meta()["figures"]["phase_margin_deg"], 40.0);
  EXPECT_NE(desk_.text(out_ + "/report.html").find("Open loop"), std::string::npos);
}

TEST_F(Lockstep, a_run_passes_or_fails_by_its_limits) {
  desk_.write("limits.toml",
              "[limits]\n\"figures.error_at_end_rev\" = {min = -0.01, max = 0.01}\n"
              "\"drive.serial\" = {min = 5, max = 5}\ntrip = {is = \"none\"}\n");
  const std::string words = "move $DRIVE 0.5 --limits ";
  const Ended good = bench(words + path("limits.toml") + kSmall);
  EXPECT_EQ(good.code, 0) << good.err;
  EXPECT_TRUE(good.out_has("pass  drive.serial = 5")) << good.out;
  EXPECT_EQ(meta()["limits"]["pass"], true);
  desk_.write("limits.toml", "[limits]\n\"figures.time_s\" = {max = 0.1}\nnothing = {min = 1}\n");
  const Ended bad = bench(words + path("limits.toml") + kSmall);
  EXPECT_EQ(bad.code, 1);
  EXPECT_TRUE(bad.out_has("FAIL  figures.time_s")) << bad.out;
  EXPECT_TRUE(bad.out_has("FAIL  nothing = null")) << "what was not measured has not passed";
  desk_.write("limits.toml", "[limits]\ntrip = 5\n");
  const Ended wrong = bench(words + path("limits.toml") + kSmall);
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(wrong.err_has("limits.toml:2")) << wrong.err;
  desk_.write("limits.toml", "[limits]\n\"figures.time_s\" = {min = 2, max = 1}\n");
  EXPECT_TRUE(tool("bench move nowhere 5 1 --out x --limits limits.toml" + std::string(kSmall))
                  .err_has("limits.toml:2: figures.time_s: min is 2 and max 1"));
  desk_.write("limits.toml", "[limits]\ntrip = {is = \"none\"}\n[limit]\ntrip = {is = \"none\"}\n");
  EXPECT_TRUE(tool("bench move nowhere 5 1 --out x --limits limits.toml" + std::string(kSmall))
                  .err_has("limits.toml:3: limit is no table"));
}

TEST_F(Lockstep, a_soft_drive_is_tuned_and_what_was_promised_is_measured_on_it) {
  const Ended ended =
      bench("tune $DRIVE --apply --gains " + shell::source("examples/bench/simulated.gains.toml") +
                " --periods 6 --travel -1..100 --speed 6 --torque 4 --i-may-move",
            "friction=0.05,velocity-gain=0.12,inertia=0.001");
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const json m = meta();
  EXPECT_EQ(m["kept"], true);
  EXPECT_NEAR(m["gains"]["before"]["velocity_gain"], 0.12, 1e-6);
  EXPECT_GT(m["gains"]["written"]["velocity_gain"], 0.3) << "the drive took it";
  const double promised = m["expected"]["loop"]["crossover_hz"], after = m["after"]["loop"]["crossover_hz"];
  EXPECT_NEAR(after, promised, 0.1 * promised);
  EXPECT_GT(after, 2.0 * m["before"]["loop"]["crossover_hz"].get<double>());
  EXPECT_LT(m["after"]["step"]["itae"].get<double>(), 0.5 * m["before"]["step"]["itae"].get<double>());
  EXPECT_NEAR(m["after"]["step"]["rise_s"].get<double>(), m["expected"]["step"]["rise_s"].get<double>(),
              0.002);
  EXPECT_NE(desk_.text(out_ + "/before.dcf").find("ParameterValue=0x0001D4C0"), std::string::npos)
      << "120000";
  EXPECT_NE(desk_.text(out_ + "/report.html").find("expected"), std::string::npos);
  EXPECT_TRUE(ended.out_has("--restore " + out_ + "/before.dcf")) << ended.out;
}

/// A motor with a load behind a springy coupling: beyond the crossover it resonates.
std::string resonating(const std::string& load) {
  return "inertia=0.0008,friction=0.05,velocity-gain=0.12," + load;
}
constexpr const char* kTuneResonance =
    " --periods 6 --to 400 --travel -1..100 --speed 6 --torque 4 --read 60F9:3 --i-may-move";

TEST_F(Lockstep, a_notch_goes_into_the_drive_with_the_gains_and_makes_the_loop_as_promised) {
  const Ended ended = bench("tune $DRIVE --apply --inner-delay 1.8 --gains " +
                                shell::source("examples/bench/simulated.gains.toml") + kTuneResonance,
                            resonating("load-inertia=0.0008,stiffness=700,damping=0.08"));
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const json m = meta();
  EXPECT_EQ(m["kept"], true);
  EXPECT_EQ(m["notch"]["used"], true);
  const double hz = m["notch"]["hz"];
  EXPECT_NEAR(hz, 213.0, 8.0) << "sqrt(700 (1 / 0.0008 + 1 / 0.0008)) / 2 pi";
  EXPECT_NEAR(m["gains"]["written"]["notch"]["hz"], hz, 0.001) << "as the drive gave it back";
  const auto in_the_drive = [&](const std::string& part) {
    return json::parse(desk_.text(out_ + "/" + part + "/meta.json"))["objects"]["60F9h:03"]["before"];
  };
  EXPECT_EQ(in_the_drive("step"), 0);
  EXPECT_NEAR(in_the_drive("step-after"), 1000.0 * hz, 1.0) << "in mHz, while the step was measured";
  const double promised = m["expected"]["loop"]["crossover_hz"], after = m["after"]["loop"]["crossover_hz"];
  EXPECT_NEAR(after, promised, 0.1 * promised);
  EXPECT_LT(m["after"]["step"]["itae"].get<double>(), m["before"]["step"]["itae"].get<double>());

  // What the run has left in its directory takes the notch out of the same drive, and puts it there.
  drives("5");
  const auto notch = [&] { return facts("sdo $BUS 5 read 60F9:3")["value"].get<int>(); };
  EXPECT_EQ(tool("od $BUS 5 --restore " + out_ + "/tuned.dcf").code, 0);
  EXPECT_NEAR(notch(), 1000.0 * hz, 1.0);
  EXPECT_EQ(tool("od $BUS 5 --restore " + out_ + "/before.dcf").code, 0);
  EXPECT_EQ(notch(), 0);
}

TEST_F(Lockstep, a_notch_that_does_not_keep_its_promise_is_taken_back_with_the_gains) {
  // The drive is faster than --inner-delay says, and the step is another one.
  const Ended ended = bench("tune $DRIVE --apply --inner-delay 1.2 --gains " +
                                shell::source("examples/bench/simulated.gains.toml") + kTuneResonance,
                            resonating("load-inertia=0.0006,stiffness=600,damping=0.02"));
  EXPECT_EQ(ended.code, 1) << ended.out;
  const json m = meta();
  EXPECT_EQ(m["kept"], false);
  EXPECT_GT(m["gains"]["written"]["notch"]["hz"], 100.0) << "the drive had it";
  EXPECT_TRUE(ended.err_has("the step overshoots more than was promised")) << ended.err;
  EXPECT_TRUE(ended.err_has("bench.tune-back")) << ended.err;
  EXPECT_FALSE(desk_.has(out_ + "/tuned.dcf"));
}

TEST_F(Lockstep, two_axes_drive_a_circle_in_the_same_cycles) {
  const std::string words =
      "run $DRIVE --with 6 --phase 90 --signal sine --loop position --amplitude 0.5 --from 1 --duration 2";
  const Ended ended =
      bench(words + " --travel -1.2..1.2 --speed 5 --torque 2 --i-may-move", "friction=0.02", "5,6");
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  EXPECT_EQ(json::parse(desk_.text(out_ + "/node6/meta.json"), nullptr, false)["off"], true);
  const json circle =
      facts("bench circle " + out_ + "/path.csv --radius 0.5 --columns node5,node6")["figures"];
  EXPECT_NEAR(circle["radius"], 0.5, 0.02);
  EXPECT_LT(circle["G"], 0.05) << "both lag alike";
  EXPECT_NEAR(circle["centre_x"], 0.0, 0.02) << "the first begins in its middle";
  EXPECT_NEAR(circle["centre_y"], -0.5, 0.02) << "the second at its end";
}

TEST_F(Lockstep, of_several_drives_none_moves_where_one_does_not_fit_and_all_stop_where_one_does) {
  const std::string words =
      "run $DRIVE --with 6 --phase 90 --signal sine --loop position --amplitude 0.5 --from 1 ";
  const Ended far =
      bench(words + "--travel -0.7..0.7 --speed 5 --torque 2 --i-may-move", "friction=0.02", "5,6");
  EXPECT_EQ(far.code, 1) << "the second goes to -1";
  EXPECT_TRUE(far.err_has("node 6: ")) << far.err;
  EXPECT_EQ(desk_.text(out_ + "/samples.csv").find(",0x1637"), std::string::npos) << "Operation enabled";
  // 0.05 N m are not enough for the acceleration: one leaves its following error first.
  const Ended weak =
      bench(words + "--duration 3 --travel -2..2 --speed 5 --torque 0.05 --following 0.05 --i-may-move",
            "friction=0.02,inertia=0.002", "5,6");
  EXPECT_EQ(weak.code, 1) << weak.out;
  EXPECT_TRUE(weak.err_has("--following")) << weak.err;
  EXPECT_EQ(meta()["off"], true);
  EXPECT_EQ(json::parse(desk_.text(out_ + "/node6/meta.json"), nullptr, false)["off"], true);
  EXPECT_EQ(bench(words + "--with 5 --travel -2..2 --speed 5 --torque 1 --i-may-move").code, 2)
      << "named twice";
}

TEST_F(Lockstep, a_relay_tunes_in_a_second_and_its_promise_is_kept) {
  const Ended ended = bench("tune $DRIVE --relay 0.3 --apply --gains " +
                                shell::source("examples/bench/simulated.gains.toml") +
                                " --travel -1..20 --speed 6 --torque 4 --i-may-move",
                            "friction=0.05,velocity-gain=0.12,inertia=0.001");
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const json m = meta();
  EXPECT_EQ(m["kept"], true);
  EXPECT_NEAR(m["relay"]["inertia_kg_m2"], 0.001, 0.05 * 0.001);
  EXPECT_GT(m["gains"]["written"]["velocity_gain"], 0.2);
  EXPECT_LE(m["expected"]["loop"]["crossover_hz"], m["relay"]["hz"]) << "nothing is promised beyond it";
  EXPECT_LT(m["after"]["step"]["itae"], m["before"]["step"]["itae"]);
}

TEST_F(Lockstep, a_proposal_without_apply_writes_nothing) {
  const Ended ended = bench("tune $DRIVE --gains " + shell::source("examples/bench/simulated.gains.toml") +
                                " --periods 4 --travel -1..100 --speed 6 --torque 4 --i-may-move",
                            "friction=0.05,velocity-gain=0.12,inertia=0.001");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.out_has("nothing was written")) << ended.out;
  EXPECT_FALSE(meta().contains("after"));
  EXPECT_FALSE(desk_.has(out_ + "/tuned.dcf"));
}

TEST_F(Lockstep, a_gains_file_that_is_wrong_is_refused_with_its_line) {
  desk_.write("wrong.toml", "[velocity_gain]\nobject = \"60F9:1\"\nunit = 0\n");
  const Ended ended = bench("tune $DRIVE --gains " + path("wrong.toml") + kSmall);
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("wrong.toml:1: [velocity_gain]: expected object")) << ended.err;
}

TEST_F(Lockstep, kept_runs_are_opened_again_and_laid_over_one_another) {
  ASSERT_EQ(bench("move $DRIVE 0.5" + std::string(kSmall)).code, 0);
  const std::string first = out_;
  ASSERT_EQ(bench("move $DRIVE 1" + std::string(kSmall)).code, 0);
  const json both = facts("bench compare " + first + " " + out_ + " --out both.html");
  EXPECT_NEAR(both["differ"]["figures.position_rev"][first], 0.5, 0.01);
  EXPECT_NEAR(both["differ"]["figures.position_rev"][out_], 1.0, 0.01);
  EXPECT_FALSE(both["differ"].contains("drive.serial")) << "what is the same tells nothing";
  EXPECT_NE(desk_.text("both.html").find(first), std::string::npos);
  EXPECT_EQ(tool("bench compare " + first + " nowhere").code, 2);
}

TEST_F(Lockstep, a_scan_of_a_full_bus_without_heartbeats_takes_no_longer_than_what_it_asks) {
  is_timed_ = true;
  std::string nodes = "1";
  for (int id = 2; id <= 126; ++id) nodes += "," + std::to_string(id);
  const Ended ended = on_drive("scan $BUS_OF_DRIVE --json", "friction=0.02", nodes);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json found = json::parse(ended.out, nullptr, false)["nodes"];
  ASSERT_EQ(found.size(), 126u);
  for (const json& node : found) {
    EXPECT_EQ(node["state"], "pre_operational") << node;
    EXPECT_EQ(node["serial_number"], node["node"]);
  }
  // Waiting for every node in turn took 9.4 s.
  EXPECT_GT(lasted_s_, 0.0) << "the server did not say how long the call was there";
  EXPECT_LT(lasted_s_, 5.0);
}

class Bench : public Workbench {};

TEST_F(Bench, figures_of_positioning_and_circles_come_from_any_csv) {
  desk_.write("approaches.csv",
              "target,direction,actual\n0,1,1\n0,1,3\n0,-1,-1\n0,-1,-3\n100,1,104\n100,1,106\n100,-1,"
              "102\n100,-1,104\n");
  const json p = facts("bench positioning approaches.csv --out page.html")["figures"];
  EXPECT_NEAR(p["B"], 4.0, 1e-9);
  EXPECT_NEAR(p["E"], 7.0, 1e-9);
  EXPECT_TRUE(desk_.has("page.html"));
  std::string path = "time,px,py\n";
  for (int i = 0; i < 360; ++i) {
    const double a = i * std::numbers::pi / 180.0;
    path += std::to_string(i) + "," + std::to_string(5.0 + 50.0 * std::cos(a)) + "," +
            std::to_string(50.02 * std::sin(a)) + "\n";
  }
  desk_.write("path.csv", path);
  const json c = facts("bench circle path.csv path.csv --radius 50 --columns px,py")["figures"];
  EXPECT_NEAR(c["G_1"], 0.02, 1e-3);
  EXPECT_NEAR(c["H"], 0.0, 1e-6) << "both directions are one";
  EXPECT_EQ(tool("bench circle path.csv --radius 50").code, 2) << "there is no column x";
  EXPECT_EQ(tool("bench positioning path.csv").code, 2);
}

TEST_F(Bench, gains_that_a_master_changed_are_restored_from_their_dcf) {
  drives("5");
  ASSERT_EQ(tool("od $BUS 5 --range 60F9-60FB --save before.dcf").code, 0);
  ASSERT_EQ(tool("sdo $BUS 5 write 60F9:1 1000 u32 60FB:1 2000 u32").code, 0);
  const Ended ended = tool("od $BUS 5 --restore before.dcf");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 60F9:1")["value"], 600'000);
  EXPECT_EQ(facts("sdo $BUS 5 read 60FB:1")["value"], 120'000);
}

TEST_F(Bench, what_a_killed_run_has_changed_is_put_right_by_the_next_one) {
  drives("5");
  const auto hear = join();
  const auto out = path("killed"), next = path("next");
  usercan::Process run({"bench", "jog", bus(), "5", "0.2", "--duration", "60", "--travel", "-50..50",
                        "--speed", "2", "--torque", "1", "--listen", "0.1", "--out", out, "--i-may-move"});
  // The drive confirms that it has written 6072h: from here on it is not what it was.
  EXPECT_TRUE(tests::comes([&] {
    image::CanFrame f;
    while (hear->receive(f))
      if (f.id == 0x585 && f.data[0] == 0x60 && f.data[1] == 0x72 && f.data[2] == 0x60) return true;
    return run.ended();
  }));
  run.signal(SIGKILL);
  EXPECT_EQ(run.wait(), -1) << run.said();
  ASSERT_TRUE(desk_.has("killed/changed.json"));
  EXPECT_EQ(facts("sdo $BUS 5 read 6072")["value"], 417) << "what the killed run has left: 1 of 2.4 N m";

  // It asks for too much speed and moves nothing: putting right comes before.
  const Ended ended =
      tool("bench jog $BUS 5 9 --travel -5..5 --speed 2 --torque 1 --listen 0.1 --i-may-move --out next");
  EXPECT_NE(ended.code, 0);
  EXPECT_TRUE(ended.err_has("6072h:00 of node 5 changed; it is 3000 again")) << ended.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 6072")["value"], 3000);
  EXPECT_FALSE(desk_.has("killed/changed.json"));
  EXPECT_NE(facts("sdo $BUS 5 read 6041")["value"].get<int>() & 0x6F, 0x27) << "not Operation enabled";
}

TEST_F(Bench, a_drive_whose_run_is_killed_under_power_stops_by_itself) {
  drives("5");
  const auto hear = join();
  // A computer that stands still ends the run before: again then.
  bool turned = false;
  for (int attempt = 0; attempt < 10 && !turned; ++attempt) {
    usercan::Process run({"bench",
                          "jog",
                          bus(),
                          "5",
                          "0.2",
                          "--duration",
                          "60",
                          "--travel",
                          "-50..50",
                          "--speed",
                          "2",
                          "--torque",
                          "1",
                          "--listen",
                          "0.1",
                          "--cycle",
                          "20000",
                          "--out",
                          path("killed" + std::to_string(attempt)),
                          "--i-may-move"});
    EXPECT_TRUE(tests::comes([&] {
      image::CanFrame f;
      while (hear->receive(f))
        turned = turned || (f.id == 0x185 && f.length == 8 && (f.data[0] & 0x6F) == 0x27 && f.data[3] > 0x40);
      return turned || run.ended();
    }));
    run.signal(SIGKILL);
    turned = run.wait() == -1 && turned;
  }
  ASSERT_TRUE(turned) << "no run came to power";
  // The drive waits for the heartbeat of its master (1016h) and stops (6007h).
  EXPECT_TRUE(
      tests::comes([&] { return (facts("sdo $BUS 5 read 6041")["value"].get<int>() & 0x6F) != 0x27; }));
  EXPECT_TRUE(tests::comes([&] { return facts("sdo $BUS 5 read 606C")["value"] == 0; }));
  const auto stands = facts("sdo $BUS 5 read 6064")["value"];
  EXPECT_EQ(facts("sdo $BUS 5 read 6064")["value"], stands);
}

TEST_F(Bench, a_drive_in_fault_gets_no_power_and_its_reset_is_the_command_that_is_named) {
  drives("5", {"--fault", "over_current at=0.1"});
  const std::string words =
      "bench move $BUS 5 0.2 --listen 0.1 --travel -1..1 --speed 5 --torque 1 --i-may-move --out ";
  const Ended ended = tool(words + "a");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("h (603Fh): ")) << ended.err;
  const std::string reset = "sdo " + bus() + " 5 write controlword 0x80 u16 --i-may-move";
  EXPECT_TRUE(ended.err_has(reset)) << ended.err;
  EXPECT_EQ(tool(reset).code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 6041")["value"].get<int>() & 8, 0) << "no fault any more";
}

TEST_F(Bench, what_does_not_fit_into_the_envelope_does_not_move) {
  drives("5");
  const std::string rest = " --speed 5 --torque 1 --listen 0.1 --i-may-move --out ";
  const Ended far =
      tool("bench run $BUS 5 --signal trapezoid --loop position --amplitude 3 --duration 5 --travel -1..2" +
           rest + "far");
  EXPECT_EQ(far.code, 1);
  EXPECT_NE(far.err.find("--travel"), std::string::npos) << far.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 6064")["value"], 0);
  const Ended unasked =
      tool("bench run $BUS 5 --signal step --loop velocity --travel -1..2 --speed 5 --torque 1 --out no");
  EXPECT_EQ(unasked.code, 2);
  EXPECT_NE(unasked.err.find("--i-may-move"), std::string::npos) << unasked.err;
  EXPECT_FALSE(std::filesystem::exists(path("no")));
}

}  // namespace
}  // namespace servogate::canopen_tools
