#include "firmware/realtime/processor_state.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "firmware/realtime/kernel_file.h"

namespace stilt::realtime {
namespace {

namespace fs = std::filesystem;

/// The number in a file; nothing when there is none.
std::optional<long long> number_in(const fs::path& path) {
  std::ifstream stream(path);
  long long number = 0;
  if (!(stream >> number)) return std::nullopt;
  return number;
}

/// The rest of a line of /proc/PID/status behind its key.
std::string status_of(const fs::path& process, const std::string& key) {
  std::ifstream stream(process / "status");
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(key + ":")) return line.substr(line.find_first_not_of(" \t", key.size() + 1));
  }
  return {};
}

/// Real-time priority: field 40 of /proc/PID/stat. Field 2, the name in brackets, may hold blanks.
int priority_of(const fs::path& process) {
  constexpr int kFieldsFromTheName = 38;
  const std::string line = first_line(process / "stat");
  const std::size_t end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) return 0;
  std::istringstream fields(line.substr(end_of_name + 1));
  std::string field;
  for (int i = 0; i < kFieldsFromTheName && fields >> field; ++i) {
  }
  return std::atoi(field.c_str());
}

}  // namespace

std::optional<IdleState> deepest_idle_state(int core, const std::string& root) {
  const fs::path folder =
      root + "/sys/devices/system/cpu/cpu" + std::to_string(std::max(0, core)) + "/cpuidle";
  std::optional<IdleState> deepest;
  std::error_code missing;
  for (const auto& state : fs::directory_iterator(folder, missing)) {
    const auto exit_us = number_in(state.path() / "latency");
    if (!exit_us || number_in(state.path() / "disable").value_or(0) != 0) continue;
    if (deepest && deepest->exit_us >= static_cast<double>(*exit_us)) continue;
    deepest = IdleState{first_line(state.path() / "name"), static_cast<double>(*exit_us)};
  }
  return deepest;
}

std::optional<long long> thermal_throttle_count(const std::string& root) {
  std::optional<long long> sum;
  std::error_code missing;
  for (const auto& processor : fs::directory_iterator(root + "/sys/devices/system/cpu", missing)) {
    for (const char* of : {"core_throttle_count", "package_throttle_count"}) {
      const auto count = number_in(processor.path() / "thermal_throttle" / of);
      if (count) sum = sum.value_or(0) + *count;
    }
  }
  return sum;
}

std::vector<InterruptThread> interrupt_threads(const std::string& root) {
  std::vector<InterruptThread> threads;
  std::error_code missing;
  for (const auto& process : fs::directory_iterator(root + "/proc", missing)) {
    const int number = std::atoi(process.path().filename().c_str());
    const std::string name = number > 0 ? first_line(process.path() / "comm") : "";
    if (!name.starts_with("irq/") && !name.starts_with("napi/") && !name.starts_with("ksoftirqd/")) continue;
    threads.push_back(
        {name, number, priority_of(process.path()), status_of(process.path(), "Cpus_allowed_list")});
  }
  std::ranges::sort(threads, {}, &InterruptThread::process);
  return threads;
}

bool has_processor(const std::string& list, int core) {
  if (core < 0) return true;
  std::istringstream ranges(list);
  for (std::string range; std::getline(ranges, range, ',');) {
    const int first = std::atoi(range.c_str());
    const std::size_t dash = range.find('-');
    const int last = dash == std::string::npos ? first : std::atoi(range.c_str() + dash + 1);
    if (first <= core && core <= last) return true;
  }
  return false;
}

}  // namespace stilt::realtime
