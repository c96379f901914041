#include <unistd.h>

#include <cstdlib>
#include <cstring>

/// Prints one sentence when the processor lacks the instructions that the rest of the program is compiled
/// for. Ends with status 2 before anything else runs: otherwise the first of them ends the program with a
/// signal. This file alone is compiled for every x86-64 processor, so it uses nothing from the project's
/// headers.
namespace {

[[gnu::constructor(101)]] void check_processor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v3") != 0) return;
  const char* sentence =
      "this processor lacks AVX2 and FMA (x86-64-v3), which this program needs; processors from Intel "
      "Haswell (2013) and AMD Excavator (2015) on have them\n";
  static_cast<void>(!write(STDERR_FILENO, sentence, std::strlen(sentence)));
  _exit(2);
}

}  // namespace
