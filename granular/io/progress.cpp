#include "granular/io/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>

namespace granular {
namespace {

double readSteadyClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Progress::Progress(std::ostream& stream, Options chosen) : out(stream), options(std::move(chosen)) {
  if (!options.now) options.now = readSteadyClock;
  start = last = baseTime = options.now();
}

Progress::Progress() : Progress(std::cerr, {isatty(STDERR_FILENO) == 1, 0.5, 10, {}}) {}

void Progress::report(double done, const std::function<std::string()>& text) {
  const double now = options.now();
  if (!begun) {
    // A resumed run has much behind it that took no time here.
    begun = true;
    baseDone = done;
    baseTime = now;
  }
  if (now - last < (options.terminal ? options.terminalPeriod : options.logPeriod)) return;
  last = now;

  // The rest at the speed since the base, which follows half-way: early and late speeds differ in a filling vessel.
  std::string left = "";
  if (done > baseDone && now > baseTime) {
    const double speed = (done - baseDone) / (now - baseTime);
    left = fmt::format(", {} left", formatDuration((1 - std::min(done, 1.0)) / speed));
  }
  if (now - baseTime > 2 * std::max(30.0, (now - start) / 4)) {
    baseDone = (baseDone + done) / 2;
    baseTime = (baseTime + now) / 2;
  }
  const std::string line =
      fmt::format("{:3.0f} %  {}  {}{}", 100 * std::clamp(done, 0.0, 1.0), text(), formatDuration(now - start), left);
  if (!options.terminal) {
    out << line << std::endl;
    return;
  }
  out << '\r' << line << std::string(width > line.size() ? width - line.size() : 0, ' ') << std::flush;
  width = line.size();
}

void Progress::say(const std::string& message) {
  finish();
  out << message << std::endl;
}

void Progress::finish() {
  if (width == 0) return;
  out << std::endl;
  width = 0;
}

std::string formatDuration(double seconds) {
  if (!std::isfinite(seconds)) return "unknown time";
  const auto s = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

}  // namespace granular
