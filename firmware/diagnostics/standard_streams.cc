#include "firmware/diagnostics/standard_streams.h"

#include <cstdio>
#include <iostream>

namespace stilt::diagnostics {

bool all_printed() { return std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0; }

}  // namespace stilt::diagnostics
