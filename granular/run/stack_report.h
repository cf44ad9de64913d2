// What a tower leaves behind: a summary, JSON, and tables.
#pragma once

#include <string>

#include "granular/run/stack.h"

namespace granular {

/// "t = 1.2 s, kinetic energy ..."
std::string describeSample(const StackSample& sample);
/// Some lines for the user. engine: "granular" or "bullet".
std::string describeStack(const StackSettings& settings, const std::string& engine, const StackResult& result);
/// Settings and figures; SI units, stable keys.
std::string stackToJson(const StackSettings& settings, const std::string& engine, const StackResult& result);
/// One row per sample.
std::string samplesToCsv(const StackResult& result);
/// One row per cuboid: half-lengths, final place and orientation.
std::string posesToCsv(const StackSettings& settings, const StackResult& result);

}  // namespace granular
