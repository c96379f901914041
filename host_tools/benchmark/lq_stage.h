#pragma once

#include "mpc_core/lq/lq_problem.h"

namespace stilt::benchmark {

/// A stage's model in one piece.
struct LqStage : lq::LqFirstOrder, lq::LqSecondOrder {};

}  // namespace stilt::benchmark
