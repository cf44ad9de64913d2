// How far a run has come and how long it will take: one line that renews itself on a terminal, a line now and then
// elsewhere. Written to the error stream, so that the output of scripts stays clean.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

namespace granular {

class Progress {
 public:
  struct Options {
    bool terminal = false;        ///< the stream is a terminal
    double terminalPeriod = 0.5;  ///< s between renewals
    double logPeriod = 10;        ///< s between lines elsewhere
    std::function<double()> now;  ///< wall clock, s; empty: the steady clock
  };
  Progress(std::ostream& stream, Options options);
  /// To std::cerr, as it is connected.
  Progress();

  /// done: share of the work, 0 to 1, never less than before; text: what goes on. Writes only when it is time.
  /// Cheap enough for every few steps; text is called only then.
  void report(double done, const std::function<std::string()>& text);
  /// A message of its own line, at once.
  void say(const std::string& message);
  /// Ends the renewed line.
  void finish();

  /// Wall time so far, s.
  double elapsed() const { return options.now() - start; }

 private:
  std::ostream& out;
  Options options;
  double start = 0, last = 0;
  std::size_t width = 0;  ///< of the renewed line
  // Speed over the recent past: share and time at its beginning.
  double baseDone = 0, baseTime = 0;
  bool begun = false;
};

/// "3 s", "2 min 05 s", "1 h 12 min".
std::string formatDuration(double seconds);

}  // namespace granular
