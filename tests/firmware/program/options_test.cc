#include "firmware/program/options.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "mpc_core/dispatch/dispatched_planner.h"
#include "tests/own_folder.h"

namespace stilt::program {
namespace {

std::expected<Options, std::string> read(std::vector<std::string> words) {
  words.insert(words.begin(), "stiltd");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  Options options;
  const auto right = read_options(static_cast<int>(pointers.size()), pointers.data(), "version", options);
  if (!right) return std::unexpected(right.error());
  return options;
}

std::string mistake(const std::vector<std::string>& words) {
  const auto options = read(words);
  return options ? "" : options.error();
}

TEST(Options, AMistakeOfTheCommandLineLeavesTaskAndJsonFileKnown) {
  char words[][20] = {"stiltd", "selftest", "--seconds", "soon", "--json", "file"};
  char* pointers[] = {words[0], words[1], words[2], words[3], words[4], words[5]};
  Options options;
  EXPECT_FALSE(read_options(6, pointers, "version", options));
  EXPECT_EQ(options.task, Task::self_test);
  EXPECT_EQ(options.json_file, "file");
}

TEST(Options, AnOptionAfterJsonIsNoFileOfARefusal) {
  char words[][20] = {"stiltd", "--json", "--duration", "soon"};
  char* pointers[] = {words[0], words[1], words[2], words[3]};
  Options options;
  EXPECT_FALSE(read_options(4, pointers, "version", options));
  EXPECT_EQ(options.json_file, "");
}

TEST(Options, WithoutAnyTheShippedRobotWaitsIdle) {
  const auto options = read({});
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(options->task, Task::control);
  EXPECT_FALSE(options->start);
  EXPECT_EQ(options->duration_s, 0.0);
  EXPECT_FALSE(options->lockstep);
  EXPECT_EQ(options->configuration.hardware.robot, "amber3m");
}

TEST(Options, ARobotBesideAConfigurationTakesThePlaceOfItsRobot) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "[hardware]\nrobot = \"rabbit\"\n";
  const auto as_named = read({"--config", file});
  ASSERT_TRUE(as_named) << as_named.error();
  EXPECT_EQ(as_named->configuration.hardware.robot, "rabbit");
  const auto replaced = read({"--config", file, "--robot", "amber3m"});
  ASSERT_TRUE(replaced) << replaced.error();
  EXPECT_EQ(replaced->configuration.hardware.robot, "amber3m");
  EXPECT_EQ(replaced->source, file + ", --robot amber3m");
  EXPECT_EQ(replaced->changed_keys, std::vector<std::string>{"hardware.robot"});
}

TEST(Options, BusesReplaceThoseOfTheConfigurationInTheirOrder) {
  const auto options = read({"--bus", "vcan0", "--bus", "loopback:right"});
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(configuration::bus_names(options->configuration.hardware),
            (std::vector<std::string>{"vcan0", "loopback:right"}));
  EXPECT_NE(mistake({"--bus", "can0"}).find("--bus: hip_R.bus = 1, but hardware.buses names 1 bus"),
            std::string::npos);
}

TEST(Options, StartSaysGaitAndSpeed) {
  const auto walk = read({"--start", "walk@-0.25", "--duration", "12.5", "--lockstep", "--json", "-"});
  ASSERT_TRUE(walk) << walk.error();
  EXPECT_EQ(walk->start->kind, gait::GaitKind::walk);
  EXPECT_EQ(walk->start->speed_m_s, -0.25);
  EXPECT_EQ(walk->duration_s, 12.5);
  EXPECT_TRUE(walk->lockstep);
  EXPECT_EQ(walk->json_file, "-");
  EXPECT_EQ(read({"--start", "stand"})->start->kind, gait::GaitKind::stand);
  EXPECT_EQ(read({"--start", "step"})->start->kind, gait::GaitKind::step);
  for (const char* wrong : {"walk", "walk@", "walk@fast", "walk@9", "walk@nan", "run@1", "@1", "stand@"}) {
    EXPECT_NE(mistake({"--start", wrong}).find("expected stand, step, or walk@SPEED"), std::string::npos)
        << wrong;
  }
}

TEST(Options, ASpeedOfAStandOrAStepIsRefused) {
  for (const std::string gait : {"stand", "step"}) {
    for (const std::string speed : {"0.3", "0", "-9"}) {
      EXPECT_EQ(mistake({"--start", gait + "@" + speed}), "--start " + gait + "@" + speed +
                                                              ": a speed belongs to a walk; take --start " +
                                                              gait + ", or a walk such as walk@0.3");
    }
  }
}

TEST(Options, AnEmptyValueIsRefusedAndNoDefaultTakenInItsPlace) {
  for (const char* option :
       {"--config", "--robot", "--preset", "--set", "--bus", "--start", "--json", "--black-box"}) {
    const std::string sentence = std::string(option) + ": its value is empty; give one, or leave " + option +
                                 " out; see stiltd --help";
    EXPECT_EQ(mistake({option, ""}), sentence);
    EXPECT_EQ(mistake({std::string(option) + "=", "--check-config"}), sentence);
  }
  for (const char* option : {"--config", "--out", "--answers", "--json"}) {
    EXPECT_NE(mistake({"calibrate", option, ""}).find(std::string("calibrate: ") + option + ": its value is"),
              std::string::npos)
        << mistake({"calibrate", option, ""});
  }
  EXPECT_NE(mistake({"--bus", "can0", "--bus", ""}).find("--bus: its value is empty"), std::string::npos);
  EXPECT_NE(mistake({"--duration", ""}), "") << "it would run until it is stopped";
  EXPECT_NE(mistake({"jog", "", "0.3"}).find("jog: joint: its value is empty"), std::string::npos);
}

TEST(Options, ASecondCommandIsRefused) {
  EXPECT_EQ(mistake({"scan", "jog", "hip_L", "0.3"}),
            "scan: jog is a second command; give one at a time; see stiltd scan --help");
  EXPECT_NE(mistake({"selftest", "--seconds", "2", "identify", "--torque-limit", "0.3"})
                .find("selftest: identify is a second command"),
            std::string::npos);
  EXPECT_NE(mistake({"scan", "scan"}).find("scan is a second command"), std::string::npos);
}

TEST(Options, AnOptionBeforeACommandCountsOrIsRefused) {
  const auto scan =
      read({"--lockstep", "--robot", "rabbit", "--set", "cost.terminal=3", "--json", "-", "scan"});
  ASSERT_TRUE(scan) << scan.error();
  EXPECT_EQ(scan->task, Task::scan);
  EXPECT_TRUE(scan->lockstep);
  EXPECT_EQ(scan->configuration.hardware.robot, "rabbit");
  EXPECT_EQ(scan->configuration.cost.terminal, 3.0);
  EXPECT_EQ(scan->json_file, "-");
  EXPECT_EQ(read({"--duration", "3", "watch"})->duration_s, 3.0);
  const auto identify = read({"--torque-limit", "0.2", "identify"});
  ASSERT_TRUE(identify) << identify.error();
  EXPECT_EQ(identify->identify_torque_share, 0.2);
  EXPECT_EQ(identify->torque_limit_share, 1.0);
  EXPECT_EQ(mistake({"--black-box", "bb.csv", "--duration", "1", "watch"}),
            "--black-box: is no option of watch; leave it out");
  EXPECT_EQ(mistake({"--check-config", "scan"}), "--check-config: is no option of scan; leave it out");
  EXPECT_EQ(mistake({"--print-config", "jog", "hip_L", "0.3"}),
            "--print-config: is no option of jog; leave it out");
  for (const char* command : {"scan", "calibrate", "selftest"}) {
    EXPECT_TRUE(mistake({"--start", "stand", command}).starts_with("--start: is no option of ")) << command;
    EXPECT_TRUE(mistake({"--torque-limit", "0.5", command}).starts_with("--torque-limit: ")) << command;
  }
  EXPECT_EQ(mistake({"--set", "cost.terminal=3", "scan", "--set", "cost.base_x=1"}),
            "--set: is before scan and behind it; give all of it behind");
}

TEST(Options, MistakesOfTheConfigurationAreAllReported) {
  const std::string text = mistake({"--set", "gait.swing_height_m=5", "--set", "supervisor.hot=1"});
  EXPECT_NE(text.find("--set: gait.swing_height_m = 5 is outside its range"), std::string::npos);
  EXPECT_NE(text.find("--set: unknown key supervisor.hot; did you mean supervisor.hot_C?"),
            std::string::npos);
}

TEST(Options, APresetChangesTheConfigurationBeforeTheGaitsAndWhatTheUserSets) {
  const auto paper = read({"--preset", "paper", "--set", "cost.terminal=3"});
  ASSERT_TRUE(paper) << paper.error();
  EXPECT_EQ(paper->configuration.discretisation.transition, ocp::Transition::identity);
  EXPECT_EQ(paper->configuration.gait.single_support_s, 0.4);
  EXPECT_EQ(paper->configuration.cost.terminal, 3.0);
  EXPECT_EQ(paper->source, "the shipped configuration of amber3m, preset paper, --set cost.terminal=3");
  const auto around_gaits = read({"--preset", "paper", "--set", "controller.reference=hzd"});
  ASSERT_TRUE(around_gaits) << around_gaits.error();
  EXPECT_EQ(around_gaits->configuration.discretisation.transition, ocp::Transition::identity);
  EXPECT_NEAR(around_gaits->configuration.gait.single_support_s, 0.3, 1e-6)
      << "step time of the shipped gaits";
  EXPECT_EQ(around_gaits->configuration.cost.terminal, 10.0);
}

TEST(Options, PlansAroundGaitsOfARobotWithoutShippedOnesAreRefused) {
  EXPECT_EQ(mistake({"--robot", "rabbit", "--set", "controller.reference=hzd"}),
            "controller.reference is hzd: no gaits of rabbit are shipped; plans follow shipped gaits alone "
            "here, so set controller.reference = \"heuristic\"");
}

TEST(Options, PlansAroundGaitsHaveTheirStepTimeWithinAMillisecond) {
  const auto step = [](const std::string& time_s) {
    return std::vector<std::string>{"--set", "controller.reference=hzd", "--set",
                                    "gait.single_support_s=" + time_s};
  };
  EXPECT_EQ(
      mistake(step("0.5")),
      "controller.reference is hzd: gait.single_support_s = 0.5 must be the step time of the gaits that "
      "plans follow, 0.3; stilt gait library --step-time 0.5 makes others, for stilt sim --gaits");
  for (const char* other : {"0.2", "0.298", "0.302"}) EXPECT_NE(mistake(step(other)), "") << other;
  for (const char* same : {"0.3", "0.2995", "0.3005"}) EXPECT_TRUE(read(step(same))) << same;
}

TEST(Options, AnAutomaticInstructionSetBecomesTheOneInUse) {
  const auto automatic = read({});
  ASSERT_TRUE(automatic) << automatic.error();
  EXPECT_EQ(automatic->configuration.sqp.instruction_set, dispatch::choose(model::InstructionSet::automatic));
  const auto chosen = read({"--set", "sqp.instruction_set=avx2"});
  ASSERT_TRUE(chosen) << chosen.error();
  EXPECT_EQ(chosen->configuration.sqp.instruction_set, model::InstructionSet::avx2);
  const auto printed = read({"--print-config"});
  ASSERT_TRUE(printed) << printed.error();
  EXPECT_EQ(printed->configuration.sqp.instruction_set, model::InstructionSet::automatic);
  EXPECT_NE(mistake({"--set", "sqp.instruction_set=mmx"}).find("avx512"), std::string::npos);
}

TEST(Options, AReportOnTheConfigurationTakesNoOptionOfARun) {
  EXPECT_EQ(mistake({"--check-config", "--json", "file"}),
            "--json: has no meaning with --check-config; leave it out");
  EXPECT_EQ(mistake({"--print-config", "--torque-limit", "0.4"}),
            "--torque-limit: has no meaning with --print-config; leave it out");
  EXPECT_EQ(mistake({"--print-config", "--check-config"}),
            "--check-config: has no meaning with --print-config; leave it out");
  EXPECT_TRUE(read({"--check-config", "--torque-limit", "0.6", "--start", "walk@0.3", "--bus", "vcan0",
                    "--bus", "vcan1", "--preset", "paper"}));
}

TEST(Options, InterruptsAreOfTheNamedInterfaces) {
  const auto named = read({"interrupts", "can0", "can3"});
  ASSERT_TRUE(named) << named.error();
  EXPECT_EQ(named->task, Task::interrupts);
  EXPECT_EQ(named->interrupt_buses, (std::vector<std::string>{"can0", "can3"}));
  EXPECT_TRUE(read({"interrupts"})->interrupt_buses.empty());
}

TEST(Options, AnUnknownPresetIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(mistake({"--preset", "nonsense"}),
            "--preset: there is no preset \"nonsense\"; known presets are paper");
}

TEST(Options, NumbersOutOfRangeAreRefused) {
  EXPECT_NE(mistake({"--duration", "-1"}), "");
  EXPECT_NE(mistake({"--duration", "nan"}), "");
  EXPECT_NE(mistake({"selftest", "--seconds", "0"}), "");
  EXPECT_NE(mistake({"--banana"}), "");
}

TEST(Options, TheSelfTestHasItsOwnOptions) {
  const auto options = read({"selftest", "--bus", "vcan0", "--bus", "vcan1", "--seconds", "2"});
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(options->task, Task::self_test);
  EXPECT_EQ(options->self_test_s, 2.0);
  EXPECT_EQ(configuration::bus_names(options->configuration.hardware).front(), "vcan0");
}

TEST(Options, ATorqueLimitBoundsSupervisorAndPlansAlike) {
  const auto limited = read({"--torque-limit", "0.3", "--start", "stand"});
  ASSERT_TRUE(limited) << limited.error();
  EXPECT_EQ(limited->configuration.supervisor.torque_limit_share, 0.3);
  EXPECT_EQ(limited->configuration.robot.torque_limit_scale, 0.3);
  EXPECT_FALSE(limited->configuration.gait.catch_falls);
  EXPECT_NE(limited->source.find("--torque-limit 0.3"), std::string::npos);
  const auto configured = read({"--set", "supervisor.torque_limit_share=0.3"});
  ASSERT_TRUE(configured) << configured.error();
  EXPECT_EQ(configured->configuration.robot.torque_limit_scale, 0.3);
  EXPECT_FALSE(configured->configuration.gait.catch_falls);
  const auto weaker_plans = read({"--set", "robot.torque_limit_scale=0.2", "--torque-limit", "0.3"});
  EXPECT_EQ(weaker_plans->configuration.robot.torque_limit_scale, 0.2);
  EXPECT_TRUE(read({"--torque-limit", "0.7"})->configuration.gait.catch_falls);
  for (const char* wrong : {"0", "1.5", "-0.3", "0.04"}) {
    EXPECT_EQ(mistake({"--torque-limit", wrong}), "--torque-limit: must be a share of the torque, 0.05 to 1");
  }
}

TEST(Options, WalkingIsRefusedBelowTheTorqueThatItNeeds) {
  for (const char* start : {"walk@0.3", "step"}) {
    EXPECT_TRUE(mistake({"--torque-limit", "0.5", "--start", start})
                    .starts_with("--start: stepping and walking need a torque limit of at least 0.6"));
    EXPECT_TRUE(read({"--torque-limit", "0.6", "--start", start}));
    EXPECT_FALSE(read({"--set", "supervisor.torque_limit_share=0.3", "--start", start}));
    EXPECT_FALSE(read({"--set", "robot.torque_limit_scale=0.5", "--start", start}));
    EXPECT_TRUE(read({"--set", "robot.torque_limit_scale=0.6", "--start", start}));
  }
  const auto stands = read({"--set", "robot.torque_limit_scale=0.5", "--start", "stand"});
  ASSERT_TRUE(stands) << stands.error();
  EXPECT_EQ(stands->configuration.supervisor.plan_torque_share, 0.5) << "an operator's walk is refused, too";
  EXPECT_FALSE(stands->configuration.gait.catch_falls);
}

TEST(Options, ARefusedWalkNamesTheKeyThatIsTooSmall) {
  const auto ends = [](std::vector<std::string> words, const std::string& end) {
    words.insert(words.end(), {"--start", "walk@0.3"});
    return mistake(words).ends_with(", and it is " + end);
  };
  const std::string share = "supervisor.torque_limit_share", scale = "robot.torque_limit_scale";
  EXPECT_TRUE(ends({"--torque-limit", "0.5"}, "0.5; take --start stand, or a larger --torque-limit"));
  EXPECT_TRUE(ends({"--torque-limit", "1", "--set", share + "=0.4"},
                   "0.4; take --start stand, or a larger supervisor.torque_limit_share"));
  EXPECT_TRUE(ends({"--torque-limit", "0.5", "--set", share + "=0.4"},
                   "0.2; take --start stand, or a larger supervisor.torque_limit_share"));
  EXPECT_TRUE(ends({"--torque-limit", "0.5", "--set", share + "=0.6"},
                   "0.3; take --start stand, or a larger --torque-limit"));
  EXPECT_TRUE(ends({"--torque-limit", "0.7", "--set", scale + "=0.4"},
                   "0.4; take --start stand, or a larger robot.torque_limit_scale"));
}

TEST(Options, AWalkBeyondTheSpeedLimitIsRefused) {
  for (const std::string speed : {"1.6", "-0.81"}) {
    const std::string start = "walk@" + speed;
    EXPECT_EQ(mistake({"--check-config", "--start", start}),
              "--start: " + speed + " m/s is beyond telemetry.speed_limit_m_s, 0.8 m/s either way");
    EXPECT_TRUE(read({"--set", "telemetry.speed_limit_m_s=1.7", "--start", start}));
  }
  for (const char* start : {"walk@0.8", "walk@-0.8"}) EXPECT_TRUE(read({"--start", start}));
}

TEST(Options, TheCommandsBeforeTheControllerHaveTheirOwnTasks) {
  EXPECT_EQ(read({"scan"})->task, Task::scan);
  const auto watch = read({"watch", "--duration", "3"});
  ASSERT_TRUE(watch) << watch.error();
  EXPECT_EQ(watch->task, Task::watch);
  EXPECT_EQ(watch->duration_s, 3.0);
  const auto jog = read({"jog", "knee_R", "-0.25", "--answers", "file"});
  ASSERT_TRUE(jog) << jog.error();
  EXPECT_EQ(jog->task, Task::jog);
  EXPECT_EQ(jog->joint, 3u);
  EXPECT_EQ(jog->jog_angle_rad, -0.25);
  EXPECT_EQ(jog->answers_file, "file");
  const auto calibrate = read({"calibrate", "--at", "marks", "--out", "robot.toml"});
  ASSERT_TRUE(calibrate) << calibrate.error();
  EXPECT_EQ(calibrate->task, Task::calibrate);
  EXPECT_EQ(calibrate->reference, commissioning::Reference::marks);
  EXPECT_EQ(calibrate->out_file, "robot.toml");
  const auto identify = read({"identify", "--torque-limit", "0.2"});
  ASSERT_TRUE(identify) << identify.error();
  EXPECT_EQ(identify->task, Task::identify);
  EXPECT_EQ(identify->identify_torque_share, 0.2);
  EXPECT_EQ(identify->torque_limit_share, 1.0);
}

TEST(Options, CalibrateAndIdentifyRefuseWhatTheyDoNotKnow) {
  EXPECT_NE(mistake({"calibrate", "--at", "walls"}), "");
  EXPECT_EQ(mistake({"identify", "--torque-limit", "2"}),
            "--torque-limit: must be a share of the torque, 0.05 to 1");
}

TEST(Options, AJogOfNoJointOrTooFarIsRefused) {
  EXPECT_EQ(mistake({"jog", "ankle", "0.2"}),
            "jog: \"ankle\" is no joint; right are hip_L, knee_L, hip_R and knee_R");
  for (const char* angle : {"0.6", "-0.6", "0.01", "0"}) {
    EXPECT_EQ(mistake({"jog", "hip_L", angle}), "jog: the angle must be 0.08 to 0.5 rad, either way");
  }
  EXPECT_EQ(mistake({"jog", "hip_L", "nan"}),
            "jog: angle: nan is no number; give one, such as 0.5; see stiltd jog --help");
  EXPECT_NE(mistake({"jog", "hip_L"}), "");
}

}  // namespace
}  // namespace stilt::program
