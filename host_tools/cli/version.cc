#include "host_tools/cli/version.h"

#include "firmware/version/commit.h"
#include "host_tools/simulation/closed_loop/simulated_controller.h"
#include "mpc_core/model/batch.h"

namespace stilt::cli {

namespace {

/// The SIMD instructions of the compiler's target, which "native" stands for.
constexpr const char* simd_family() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__) && defined(__FMA__)
  return "AVX2 with FMA";
#elif defined(__AVX__)
  return "AVX";
#elif defined(__SSE2__)
  return "SSE2";
#elif defined(__ARM_NEON)
  return "NEON";
#else
  return "no SIMD";
#endif
}

}  // namespace

std::string instruction_set() {
  return std::string(STILT_ISA) + ", " + simd_family() + ", " + std::to_string(model::kLanes) + " lanes";
}

std::string version_text() {
  return "stilt " STILT_VERSION "\ncommit            " + std::string(version::commit()) +
         "\ncompiler          GCC " __VERSION__ "\ninstruction set   " + instruction_set() +
         "\ncontroller object " + std::to_string(simulation::SimulatedController::bytes()) + " bytes";
}

}  // namespace stilt::cli
