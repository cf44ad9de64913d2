// What a packing leaves behind: analysis, tables, result.json, frames and surfaces.
#pragma once

#include <filesystem>

#include "granular/analysis/bed_analysis.h"
#include "granular/io/result.h"
#include "granular/run/packing_run.h"

namespace granular {

/// The summary for people, in lines.
std::string formatSummary(const RunResult& result, const PackingRun& run);

/// Measures the bed and writes everything the scene asks for into the folder, which exists. Returns what result.json
/// holds.
RunResult writeReport(const PackingRun& run, RunEnd end, int threads, const std::filesystem::path& out);

}  // namespace granular
