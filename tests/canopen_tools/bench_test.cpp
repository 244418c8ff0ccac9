// SPDX-License-Identifier: Apache-2.0
// `servogate bench` against drives in other processes, seen only through the bus.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/bench/random_plant.hpp"
#include "tests/canopen_tools/workbench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::canopen_tools {
namespace {

constexpr const char* kEnvelope = " --travel -100..500 --speed 20 --torque 4.8 --time 120 --listen 0.1";

/// A bus in granted time with one drive on it; what the bench says of it.
class Lockstep : public Workbench {
 protected:
  /// One call of the bench on a drive of its own; $OUT is its directory.
  Ended bench(const std::string& words, const std::string& plant = "friction=0.02") {
    const std::string at = std::to_string(++calls_);
    const std::string socket = path("lockstep-" + at);
    const std::string url = "lockstep:unix:" + socket + "/can0";
    auto bus = std::make_unique<usercan::Process>(
        std::vector<std::string>{"can", "bus", "can0", "--listen", "unix:" + socket, "--lockstep", "2"});
    EXPECT_TRUE(bus->says("can0"));
    const usercan::Process drive({"drive", url, "--node", "5", "--plant", plant});
    EXPECT_TRUE(drive.says("node 5"));
    out_ = "run-" + at;
    std::string line = "bench " + words + " --listen 0.1 --out " + out_;
    line.replace(line.find("$DRIVE"), 6, url + " 5");
    Ended ended = tool(line);
    bus.reset();  // first: the drive waits for its time
    return ended;
  }
  json meta() const { return json::parse(desk_.text(out_ + "/meta.json"), nullptr, false); }
  std::string out_;
  int calls_ = 0;

  json identified(const mock::PlantConfig& plant, int number) {
    const std::string at = std::to_string(number);
    const std::string socket = path("lockstep" + at);
    const std::string url = "lockstep:unix:" + socket + "/can0";
    const usercan::Process bus({"can", "bus", "can0", "--listen", "unix:" + socket, "--lockstep", "2"});
    EXPECT_TRUE(bus.says("can0"));
    const usercan::Process drive({"drive", url, "--node", "5", "--plant", bench::plant_words(plant)});
    EXPECT_TRUE(drive.says("node 5"));
    return facts("bench identify " + url + " 5" + kEnvelope + " --out run" + at + " --i-may-move");
  }
};

void expect_within(const json& found, double truth, const char* what) {
  ASSERT_TRUE(found.is_number()) << what;
  EXPECT_NEAR(found.get<double>(), truth, 0.03 * std::abs(truth)) << what;
}

TEST_F(Lockstep, random_plants_in_other_processes_are_identified_within_three_per_cent) {
  std::mt19937_64 random(test::property_seed());
  for (int i = 0; i < 2; ++i) {  // half a minute each; tests/bench has ten
    const mock::PlantConfig p = bench::random_plant(random, i % 2 == 1);
    SCOPED_TRACE(bench::plant_words(p));
    const json found = identified(p, i);
    ASSERT_EQ(found["trip"], "none");
    EXPECT_EQ(found["off"], true);
    expect_within(found["inertia_kg_m2"], p.inertia_kg_m2 + p.load_inertia_kg_m2, "inertia");
    expect_within(found["friction"]["coulomb_nm"], p.coulomb_friction_nm, "Coulomb");
    expect_within(found["friction"]["viscous_nm_s_rad"], p.viscous_friction_nm_s, "viscous");
    ASSERT_EQ(found.contains("coupling"), p.stiffness_nm_rad > 0.0);
    if (p.stiffness_nm_rad == 0.0) continue;
    const double turn = 2.0 * std::numbers::pi;
    expect_within(found["coupling"]["antiresonance_hz"],
                  std::sqrt(p.stiffness_nm_rad / p.load_inertia_kg_m2) / turn, "antiresonance");
    expect_within(found["coupling"]["resonance_hz"],
                  std::sqrt(p.stiffness_nm_rad * (1.0 / p.load_inertia_kg_m2 + 1.0 / p.inertia_kg_m2)) / turn,
                  "resonance");
  }
}

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

TEST_F(Lockstep, a_jog_that_would_leave_its_envelope_gets_no_power) {
  const Ended ended = bench("jog $DRIVE 6" + std::string(kSmall));
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("--speed")) << ended.err;
  const std::string samples = desk_.text(out_ + "/samples.csv");
  EXPECT_EQ(samples.find(",0x1637"), std::string::npos) << "Operation enabled";
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
