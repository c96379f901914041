#pragma once

#include <stdexcept>

namespace stilt::cli {

/// Bad usage or bad input; the message is one sentence: what, where, what would be right. Exit status 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stilt::cli
