// Every tolerance of the project, with its unit and its reason.
#pragma once

namespace granular::tolerance {

/// Relative to the pair's size: two depths closer than this are a tie, and either normal is right. Double precision
/// leaves about 1e-15 of the size in a support difference; a few hundred operations may pile up.
inline constexpr double tie = 1e-12;

/// Relative to the pair's size: largest gap between the upper and the lower bound of a certified overlap.
inline constexpr double certificate = 1e-9;

}  // namespace granular::tolerance
