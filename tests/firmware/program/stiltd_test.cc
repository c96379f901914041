#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/firmware/program/stiltd_answer.h"
#include "tests/own_folder.h"

/// The program as a user runs it, where it needs no robot.
namespace stilt::program {
namespace {

using testing_support::answer;
using testing_support::Answer;
using testing_support::has;
using testing_support::stiltd;

/// Buses of this run alone: stiltd locks them for the whole machine.
const std::string kAbsentBus = "loopback:absent-left." + std::to_string(::getpid());
const std::string kAbsentBuses =
    "--bus " + kAbsentBus + " --bus loopback:absent-right." + std::to_string(::getpid());

TEST(Stiltd, SaysItsVersionCommitAndTheSizeOfTheController) {
  const Answer run = stiltd("--version");
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(
      std::regex_search(run.text, std::regex("\ncommit +([0-9a-f]{12,}(-dirty[.][0-9TZ]+)?|unknown)\n")))
      << run.text;
  EXPECT_TRUE(std::regex_search(run.text, std::regex("\ncontroller object [0-9]+\\.[0-9]{2} MB\n")))
      << run.text;
}

TEST(Stiltd, EveryCommandShowsExamplesOfItself) {
  for (const std::string command :
       {"", " scan", " watch", " jog", " zero", " calibrate", " identify", " selftest", " interrupts"}) {
    const Answer run = stiltd(command + " --help");
    EXPECT_EQ(run.status, 0) << command;
    EXPECT_TRUE(has(run, "Examples:\n  stiltd" + command + " ")) << command << run.text;
  }
}

TEST(Stiltd, InterruptsOfAConfiguredInterfaceThatIsNotThereAreAMistake) {
  const Answer missing = stiltd("interrupts --set hardware.buses=" + kAbsentBus + ",nosuchcan0");
  EXPECT_EQ(missing.status, 2) << missing.text;
  EXPECT_TRUE(has(missing, "stiltd: interrupts: nosuchcan0: there is no such interface or no adapter"))
      << missing.text;
  const Answer none = stiltd("interrupts " + kAbsentBuses);
  EXPECT_EQ(none.status, 0) << none.text;
}

TEST(Stiltd, RefusesABusThatIsNotThereInOneSentence) {
  const tests::OwnFolder folder;
  const Answer run = stiltd(kAbsentBuses + " --lockstep --set telemetry.token_file=" + folder.file("token"));
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(has(run, "stiltd: bus " + kAbsentBus + ": no program listens there")) << run.text;
}

const std::vector<std::string> kCommands = {"scan",      "watch",    "jog hip_L 0.3", "zero hip_L",
                                            "calibrate", "identify", "selftest"};

/// The reason in the JSON of a command that is refused, of standard output alone.
std::string refused_json(const std::string& arguments) {
  const Answer run = answer(STILTD " " + arguments + " --json - 2>/dev/null </dev/null");
  EXPECT_EQ(run.status, 2) << arguments;
  const auto json = nlohmann::json::parse(run.text, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << arguments << ": " << run.text;
  return json.is_object() ? json.value("error", "") : "";
}

TEST(Stiltd, BytesThatAreNoTextAreReplacedInTheJson) {
  for (const std::string arguments :
       {"--config '/nowhere/\xff.toml'", "jog '\xff' 0.3", "selftest --config '/nowhere/\xff.toml'"}) {
    EXPECT_NE(refused_json(arguments).find("\xEF\xBF\xBD"), std::string::npos) << refused_json(arguments);
  }
}

TEST(Stiltd, ACommandThatIsRefusedHasTheReasonInItsJson) {
  for (const std::string& command : kCommands) {
    const std::string network = command == "watch"      ? " --set telemetry.enabled=false "
                                : command == "selftest" ? " --lockstep "
                                                        : " ";
    const std::string error = refused_json(command + network + kAbsentBuses);
    EXPECT_TRUE(error.starts_with("bus " + kAbsentBus + ": no program listens there")) << command << error;
  }
}

TEST(Stiltd, ACommandThatIsRefusedBeforeItOpensABusHasTheReasonInItsJson) {
  const tests::OwnFolder folder;
  const std::string slow = " --set hardware.bit_rate_bit_s=250000 " + kAbsentBuses;
  for (const std::string command : {"jog hip_L 0.3", "identify", "selftest --lockstep", "--lockstep"}) {
    EXPECT_EQ(refused_json(command + slow), "buses, drivers or joints cannot do this, see above") << command;
  }
  EXPECT_TRUE(refused_json("jog hip_L 0.3 --answers /dev/null " + kAbsentBuses).starts_with("--answers "));
  for (const std::string command : {"calibrate", "identify"}) {
    const std::string nowhere = command + " --out /nowhere/file " + kAbsentBuses;
    EXPECT_TRUE(refused_json(nowhere).starts_with("--out /nowhere/file: cannot be written")) << command;
    std::ofstream(folder.file("out.toml")) << "[hip_L\n";
    const std::string mistaken = command + " --out " + folder.file("out.toml") + " " + kAbsentBuses;
    EXPECT_NE(refused_json(mistaken).find("out.toml:1:"), std::string::npos) << command;
  }
  const Answer lost = stiltd("scan --json /nowhere/file " + kAbsentBuses);
  EXPECT_EQ(std::ranges::count(lost.text, '\n'), 1) << "the file that cannot be written, once: " << lost.text;
}

TEST(Stiltd, AControllerThatIsRefusedHasTheReasonInItsJson) {
  const std::string silent = "--lockstep --set telemetry.enabled=false ";
  EXPECT_TRUE(refused_json(silent + kAbsentBuses).starts_with("bus " + kAbsentBus + ": no program listens"));
  EXPECT_TRUE(refused_json(silent + "--black-box /nowhere/file " + kAbsentBuses)
                  .starts_with("--black-box /nowhere/file: cannot be written"));
  EXPECT_FALSE(refused_json("--lockstep --set telemetry.interface=none0 " + kAbsentBuses).empty());
}

TEST(Stiltd, AMistakeOfTheCommandLineOrTheConfigurationIsInTheJson) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "[hip_L]\nidd = 1\n";
  for (const std::string command : {"", "scan", "calibrate", "selftest"}) {
    EXPECT_NE(refused_json(command + " --config " + file).find(":2:"), std::string::npos) << command;
  }
  EXPECT_NE(refused_json("--set telemetry.peers=300.1.1.1").find("\"300.1.1.1\" is neither"),
            std::string::npos);
  EXPECT_NE(refused_json("--set telemetry.peers='a\"b'").find("telemetry.peers must be UTF-8 without quotes"),
            std::string::npos);
  EXPECT_NE(refused_json("jog hip_X 0.3").find("\"hip_X\" is no joint"), std::string::npos);
  EXPECT_NE(refused_json("jog hip_L 0.6").find("the angle must be"), std::string::npos);
  EXPECT_NE(refused_json("identify --torque-limit 2").find("--torque-limit"), std::string::npos);
  EXPECT_NE(refused_json("scan --unheard").find("--unheard"), std::string::npos);
  const std::string result = folder.file("result.json");
  std::ofstream(result) << R"({"good": true})";
  EXPECT_EQ(stiltd("jog --json=" + result).status, 2);
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(result));
  EXPECT_EQ(json.at("good"), false) << "an older result does not stay";
  EXPECT_FALSE(json.value("error", "").empty());
}

TEST(Stiltd, ASelfTestThatIsRefusedHasTheFieldsOfOneThatFails) {
  const Answer run = answer(STILTD " selftest --lockstep --json - " + kAbsentBuses + " 2>/dev/null");
  const auto json = nlohmann::json::parse(run.text, nullptr, false);
  ASSERT_TRUE(json.is_object()) << run.text;
  EXPECT_EQ(json.value("passed", true), false);
  EXPECT_EQ(json.value("failure", ""), json.value("error", "none"));
}

TEST(Stiltd, ThatDoesNotStartReplacesNoToken) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("token");
  std::ofstream(file) << "the token of another run\n";
  EXPECT_EQ(stiltd(kAbsentBuses + " --set telemetry.token_file=" + file).status, 2);
  std::string token;
  std::getline(std::ifstream(file), token);
  EXPECT_EQ(token, "the token of another run");
}

TEST(Stiltd, RefusesTheTokenFileOfARunThatGoesOn) {
  const tests::OwnFolder folder;
  const int lock = open(folder.file("token.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  const Answer run = stiltd(kAbsentBuses + " --set telemetry.token_file=" + folder.file("token"));
  close(lock);
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(has(run, "stiltd runs already with the token file " + folder.file("token"))) << run.text;
  EXPECT_FALSE(has(run, "loopback:absent")) << "no bus is opened: " << run.text;
}

TEST(Stiltd, RefusesAMachineThatCannotKeepTimeWhenAskedTo) {
  const Answer run = stiltd(kAbsentBuses +
                            " --set telemetry.enabled=false --set runtime.require_realtime_always=true "
                            "--set runtime.torque_priority=0 --set runtime.planner_priority=0");
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(has(run, "runtime.require_realtime is true")) << run.text;
  EXPECT_TRUE(has(run, "the torque loop is set to no priority")) << run.text;
}

TEST(Stiltd, LooksBeforeTheRunWhetherItsFilesCanBeWritten) {
  for (const char* option : {"--json", "--black-box"}) {
    const Answer run = stiltd(kAbsentBuses + " " + option + " /nowhere/file");
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(
        has(run, std::string(option) + " /nowhere/file: cannot be written (No such file or directory)"))
        << run.text;
    EXPECT_FALSE(has(run, "loopback")) << "before it opens a bus";
  }
}

TEST(Stiltd, WritesItsResultsOverNoFileThatItReads) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  const std::string text = "[telemetry]\nenabled = false\n";
  for (const std::string& words :
       {"--config FILE --json FILE " + kAbsentBuses, "--config FILE --black-box FILE " + kAbsentBuses,
        std::string("--config FILE --json FILE --nonsense"),
        std::string("--config=FILE --json=FILE --nonsense"),
        "jog hip_L 0.3 --answers FILE --json FILE " + kAbsentBuses,
        "identify --out FILE --json FILE " + kAbsentBuses, "--json FILE --black-box FILE " + kAbsentBuses}) {
    std::ofstream(file) << text;
    const Answer run = stiltd(std::regex_replace(words, std::regex("FILE"), file));
    EXPECT_EQ(run.status, 2) << words;
    EXPECT_TRUE(has(run, file + ": is ") || has(run, "--nonsense")) << words << run.text;
    const std::string left(std::istreambuf_iterator<char>(std::ifstream(file).rdbuf()), {});
    EXPECT_EQ(left, text) << words;
  }
}

TEST(Stiltd, WritesItsResultsOverNoFileOfItsRobot) {
  const tests::OwnFolder folder;
  const std::string urdf = folder.file("own.urdf"), beside = folder.file("own.toml");
  const std::string robot = "--robot " + urdf + " ", config = "--config " + folder.file("wiring.toml") + " ";
  std::filesystem::copy_file(SHIPPED_URDF, urdf);
  std::ofstream(beside) << "[telemetry]\nenabled = false\n";
  std::ofstream(folder.file("wiring.toml")) << "[hardware]\nrobot = \"own.urdf\"\n";
  const auto text_of = [](const std::string& file) {
    return std::string(std::istreambuf_iterator<char>(std::ifstream(file).rdbuf()), {});
  };
  const std::string urdf_before = text_of(urdf), beside_before = text_of(beside);
  for (const std::string& words :
       {robot + kAbsentBuses + " --json " + urdf, robot + kAbsentBuses + " --json " + beside,
        robot + kAbsentBuses + " --black-box " + beside, config + kAbsentBuses + " --json " + urdf,
        robot + "--start walk --json " + urdf, robot + "--nonsense --json " + beside,
        config + "--start walk --json " + urdf, config + "--set cost.terminal=x --json " + urdf}) {
    EXPECT_EQ(stiltd(words).status, 2) << words;
    EXPECT_EQ(text_of(urdf), urdf_before) << words;
    EXPECT_EQ(text_of(beside), beside_before) << words;
  }
  const std::string empty = folder.file("empty.json");
  std::ofstream(empty).flush();
  EXPECT_EQ(stiltd("--start walk --json " + empty).status, 2);
  EXPECT_TRUE(text_of(empty).starts_with("{")) << "an empty file has nothing to lose";
}

TEST(Stiltd, SaysWhatAConfigurationWasReadFromAndForWhichRobot) {
  const Answer rabbit = stiltd(
      "--check-config --set hardware.robot=rabbit --set hip_driver.torque_range_Nm=160 "
      "--set hip_driver.reply_torque_range_Nm=160 --set knee_driver.torque_range_Nm=160 "
      "--set knee_driver.reply_torque_range_Nm=160 --set reference.base_height_m=0.735");
  EXPECT_TRUE(has(rabbit, "the shipped configuration of amber3m, --set hardware.robot=rabbit, "))
      << rabbit.text;
  EXPECT_TRUE(has(rabbit, ": valid\nrobot rabbit\n")) << rabbit.text;
  const tests::OwnFolder folder;
  std::ofstream(folder.file("empty.toml")) << "# nothing\n";
  const Answer empty = stiltd("--check-config --config " + folder.file("empty.toml"));
  EXPECT_TRUE(has(empty, "empty.toml (names no key: every value is the default): valid")) << empty.text;
  const Answer slow = stiltd("--check-config --set hardware.bit_rate_bit_s=250000");
  EXPECT_EQ(slow.status, 2);
  EXPECT_TRUE(has(slow, "each key is valid, and buses, drivers or joints cannot do it")) << slow.text;
  const Answer strong = stiltd("--check-config --set hardware.robot=rabbit");
  EXPECT_EQ(strong.status, 2);
  EXPECT_TRUE(has(strong, "hip_L: commands a torque of up to 150 Nm at the shaft")) << strong.text;
}

TEST(Stiltd, SaysThatItsOutputIsLost) {
  for (const std::string command :
       {"--print-config", "--check-config", "--version", "--help", "scan --help"}) {
    for (const char* output : {" 2>&1 >/dev/full", " 2>&1 >&-"}) {
      const Answer run = answer(STILTD " " + command + output);
      EXPECT_EQ(run.status, 2) << command << output;
      EXPECT_EQ(run.text, "stiltd: standard output cannot be written, so what was printed is not complete\n")
          << command << output;
    }
  }
}

TEST(Stiltd, RefusesAFolderWhereAFileBelongs) {
  const tests::OwnFolder folder;
  const std::string urdf = folder.file("robot.urdf");
  std::filesystem::create_directory(urdf);
  for (const std::string& words : {"--robot " + urdf, "--set hardware.robot=" + urdf, "--config " + urdf,
                                   "jog hip_L 0.3 --answers " + urdf + " " + kAbsentBuses}) {
    const Answer run = stiltd(words + (words.starts_with("jog") ? "" : " --check-config"));
    EXPECT_EQ(run.status, 2) << words;
    EXPECT_TRUE(has(run, urdf + ": cannot be read (Is a directory); ")) << words << run.text;
    EXPECT_EQ(std::ranges::count(run.text, '\n'), 1) << words << run.text;
  }
}

TEST(Stiltd, RefusesAnEmptyFileOfAnswersBeforeItOpensABus) {
  const Answer run = stiltd("jog hip_L 0.3 --answers /dev/null " + kAbsentBuses);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.text, "stiltd: --answers /dev/null: is empty; name a file with an answer a line\n");
}

TEST(Stiltd, SaysWhatWasProbablyMeant) {
  const Answer run = stiltd("--lock-step");
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(has(run, "stiltd: --lock-step is no option; did you mean --lockstep?; see stiltd --help"))
      << run.text;
}

TEST(Stiltd, RefusesWrongWords) {
  EXPECT_EQ(stiltd("--start fly@1").status, 2);
  EXPECT_EQ(stiltd("--start stand@0.3").status, 2);
  EXPECT_EQ(stiltd("--config /nowhere.toml").status, 2);
  EXPECT_EQ(stiltd("--nonsense").status, 2);
}

}  // namespace
}  // namespace stilt::program
