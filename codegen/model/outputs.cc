#include "codegen/model/functions.h"

namespace stilt::codegen {

std::string element(const std::string& name, int row) { return name + "[" + std::to_string(row) + "]"; }

std::string element(const std::string& name, int row, int column) {
  return element(element(name, row), column);
}

void append(std::vector<Output>& outputs, const std::string& name, const Row& row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    outputs.push_back({.path = element(name, static_cast<int>(i)), .value = row[i]});
  }
}

void append(std::vector<Output>& outputs, const std::string& name, const Matrix& matrix) {
  for (std::size_t i = 0; i < matrix.size(); ++i)
    append(outputs, element(name, static_cast<int>(i)), matrix[i]);
}

}  // namespace stilt::codegen
