#pragma once

#include <stdexcept>

namespace stilt::cli {

/// Bad usage or bad input; exit status 2. The message is one sentence: what, where, and what would be right.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stilt::cli
