// Nodes and weights of the Gauss-Legendre rule.
#pragma once

#include <utility>

namespace granular {

/// Node k (descending, k < n) of the rule of n points on [-1, 1] and its weight.
std::pair<double, double> gaussLegendreNode(int n, int k);

}  // namespace granular
