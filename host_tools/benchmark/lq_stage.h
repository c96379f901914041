#pragma once

#include "mpc_core/lq/lq_problem.h"

namespace stilt::benchmark {

/// The complete model of one stage.
struct LqStage : lq::LqFirstOrder, lq::LqSecondOrder {};

}  // namespace stilt::benchmark
