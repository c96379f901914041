#include "host_tools/cli/examples.h"

#include <array>

#include "firmware/program/examples.h"

namespace stilt::cli {
namespace {

// clang-format off
constexpr std::array kExamples = {
    "stilt sim --speed 0.8 --report walk.html",
    "stilt sim --gait stand --then step@3 --then walk:0.5@6 --duration 12",
    "stilt sim --push 60@5+1 --set gait.single_support_s=0.35",
    "stilt robot --bus loopback:left --bus loopback:right --publish",
    "stilt gait synthesize --speed 0.5 --out gait.toml",
    "stilt gait check gait.toml",
    "stilt gait complete outputs.toml --out gait.toml",
    "stilt gait library --from 0.1 --to 0.5 --step 0.1 --out gaits",
    "stilt gait show gait.toml --report gait.html",
    "stilt experiment frequency --quick --out rates",
    "stilt experiment disturbance --quick --out pushes",
    "stilt experiment horizon --quick --out horizons",
    "stilt experiment speeds --quick --out speeds",
    "stilt experiment limits --quick --out limits",
    "stilt experiment robustness --quick --out robots",
    "stilt experiment paired --quick --out pairs",
    "stilt experiment friction --quick --out friction",
    "stilt experiment figures --quick --out figures",
    "stilt monitor",
    "stilt monitor --bind 0.0.0.0 --no-browser",
    "stilt monitor --terminal",
    "stilt bench --horizon 1.0 --iterations 10 --no-early-stop",
    "stilt record --out walk.mcap",
    "stilt replay walk.mcap",
    "stilt replay walk.mcap --monitor",
    "stilt log csv walk.mcap --out walk",
    "stilt report walk.mcap --out walk.html",
    "stilt report before.mcap after.mcap --shift 0.5",
    "stilt config migrate robot.toml",
    "stilt model eval --robot rabbit < states.jsonl",
};
// clang-format on

}  // namespace

void add_examples(CLI::App& program) { program::add_examples(program, kExamples); }

}  // namespace stilt::cli
