#pragma once

#include <stdexcept>

namespace stilt::codegen {

/// A URDF that cannot be used. what() is one sentence: where, what, and what would be right.
class UrdfError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stilt::codegen
