#include "codegen/urdf/planar_tree.h"

#include <algorithm>

namespace stilt::codegen {

double PlanarTree::mass_kg() const {
  double sum = 0.0;
  for (const PlanarLink& link : links) sum += link.mass_kg;
  return sum;
}

std::vector<int> PlanarTree::path_to(int link) const {
  std::vector<int> path;
  for (int i = link; i >= 0; i = links[static_cast<std::size_t>(i)].parent) path.push_back(i);
  std::ranges::reverse(path);
  return path;
}

}  // namespace stilt::codegen
